//! What digests of animation, skin and files share: figures by additions, products and roots alone, and what of them is digested.
#![allow(clippy::unwrap_used)]

use std::fmt::{Debug, Display};

use glam::{Affine3A, Quat, Vec3A, Vec4};
use kinopt::animation::{Armature, ArmatureBone, Clip, Cursor, LocalTransform, Playback, Pose};
use kinopt::mesh::TriangleMesh;
use kinopt::skeleton::BoneId;
use support::random::Random;

use crate::digest::{Digest, Value, check};

/// As [`check`], for what goes through glam, whose code for other architectures sums in another order.
pub(crate) fn check_single(found: &[(&str, Value)]) {
    if cfg!(target_arch = "x86_64") {
        check(found);
    }
}

impl Digest {
    /// What is only data.
    pub(crate) fn debug(&mut self, data: impl Debug) {
        self.bytes(format!("{data:?}\n"));
    }

    /// What a public value is as a file.
    pub(crate) fn json(&mut self, value: &impl serde::Serialize) {
        self.bytes(serde_json::to_string(value).unwrap());
    }

    /// The words of a refusal.
    #[track_caller]
    pub(crate) fn refused<T, E: Display>(&mut self, result: Result<T, E>) {
        let error = result.err().unwrap();
        self.text(error.to_string());
    }

    pub(crate) fn quaternion(&mut self, q: Quat) {
        self.singles(q.to_array());
    }

    pub(crate) fn vector(&mut self, v: impl Into<[f32; 3]>) {
        self.singles(v.into());
    }

    pub(crate) fn affine(&mut self, affine: &Affine3A) {
        self.singles(affine.to_cols_array());
    }

    pub(crate) fn affines(&mut self, affines: &[Affine3A]) {
        affines.iter().for_each(|own| self.affine(own));
    }

    pub(crate) fn pose(&mut self, pose: &Pose) {
        pose.translations().iter().for_each(|&v| self.vector(v));
        pose.rotations().iter().for_each(|&q| self.quaternion(q));
        pose.scales().iter().for_each(|&v| self.vector(v));
        self.singles(pose.morph_weights().iter().copied());
    }

    /// A clip's name, span, events, channels and poses.
    pub(crate) fn clip(&mut self, armature: &Armature, clip: &Clip) {
        self.text(clip.name());
        self.singles(clip.span());
        self.doubles([clip.duration()]);
        self.word(clip.is_empty().into());
        self.debug(clip.events());
        self.json(&clip.channels(armature).unwrap());
        self.json(&clip.morph_channels(armature).unwrap());
        let (mut pose, mut cursor) = (armature.rest().clone(), Cursor::new());
        for step in 0..5 {
            let elapsed = clip.duration() * f64::from(step) / 4.0;
            clip.sample(elapsed, Playback::Hold, &mut cursor, &mut pose)
                .unwrap();
            self.pose(&pose);
        }
    }
}

pub(crate) fn number(random: &mut Random, size: f64) -> f32 {
    random.within(-size, size) as f32
}

pub(crate) fn vector(random: &mut Random, size: f64) -> Vec3A {
    Vec3A::from([(); 3].map(|()| number(random, size)))
}

/// A unit quaternion.
pub(crate) fn rotation(random: &mut Random) -> Quat {
    let v = Vec4::from([(); 4].map(|()| number(random, 1.0)));
    Quat::from_vec4(v.normalize())
}

/// A turn by a share of what [`rotation`] turns by, or so.
pub(crate) fn turn(random: &mut Random, size: f64) -> Quat {
    let v = vector(random, size);
    Quat::from_vec4(Vec4::from((v, 1.0)).normalize())
}

pub(crate) fn local(random: &mut Random) -> LocalTransform {
    LocalTransform {
        translation: vector(random, 1.0),
        rotation: rotation(random),
        scale: Vec3A::ONE + vector(random, 0.3),
    }
}

/// A tree of bones with two morph targets.
pub(crate) fn armature(bones: usize, random: &mut Random) -> Armature {
    let list = (0..bones).map(|k| ArmatureBone {
        name: format!("bone {k}"),
        parent: (k > 0).then(|| random.below(k)),
        rest: local(random),
    });
    let targets = vec!["smile".to_owned(), "frown".to_owned()];
    Armature::new(list.collect(), targets).unwrap()
}

/// Any pose of an armature.
pub(crate) fn pose(armature: &Armature, random: &mut Random) -> Pose {
    let mut pose = armature.rest().clone();
    for bone in armature.bone_ids() {
        pose.set_local(bone, local(random)).unwrap();
    }
    for weight in pose.morph_weights_mut() {
        *weight = random.unit() as f32;
    }
    pose
}

pub(crate) fn bone(armature: &Armature, index: usize) -> BoneId {
    armature.bone_at(index).unwrap()
}

pub(crate) fn bone_named(armature: &Armature, name: &str) -> BoneId {
    armature.bone(name).unwrap()
}

/// Texts with one piece changed at a time, all of them: read as one, or refused in words.
pub(crate) fn changed<T, E: Display>(
    digest: &mut Digest,
    text: &str,
    changes: &[(&str, &str)],
    read: impl Fn(&str) -> Result<T, E>,
    add: impl Fn(&mut Digest, &T),
) {
    for (from, to) in changes {
        assert!(text.contains(from), "{from}");
        match read(&text.replacen(from, to, 1)) {
            Ok(found) => add(digest, &found),
            Err(error) => digest.text(error.to_string()),
        }
    }
}

pub(crate) fn mesh(digest: &mut Digest, mesh: &TriangleMesh) {
    digest.word(mesh.positions().len() as u64);
    let vectors = mesh.positions().iter().chain(mesh.normals());
    digest.singles(vectors.flat_map(|v| v.to_array()));
    digest.debug(mesh.triangles());
}
