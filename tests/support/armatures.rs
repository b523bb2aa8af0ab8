//! Random armatures and poses for animation tests.

use glam::{Affine3A, Quat, Vec3, Vec3A};
use kinopt::animation::{Armature, ArmatureBone, LocalTransform, Pose};

use super::random::Random;

pub fn vector(random: &mut Random, size: f64) -> Vec3A {
    Vec3A::from(random.vector(size).map(|x| x as f32).data.0[0])
}

pub fn rotation(random: &mut Random, size: f64) -> Quat {
    Quat::from_scaled_axis(Vec3::from(vector(random, size)))
}

pub fn local(random: &mut Random) -> LocalTransform {
    LocalTransform {
        translation: vector(random, 1.0),
        rotation: rotation(random, 1.5),
        scale: Vec3A::ONE + vector(random, 0.3),
    }
}

/// Bone with an identity rest rotation and scale, at a position relative to its parent.
pub fn bone(name: &str, parent: Option<usize>, at: impl Into<Vec3A>) -> ArmatureBone {
    ArmatureBone {
        name: name.into(),
        parent,
        rest: LocalTransform {
            translation: at.into(),
            ..LocalTransform::IDENTITY
        },
    }
}

/// Random tree of bones named `bone 0`, `bone 1` and so on, with the morph targets `smile` and `frown`.
pub fn armature(bones: usize, random: &mut Random) -> Armature {
    let list = (0..bones).map(|k| ArmatureBone {
        name: format!("bone {k}"),
        parent: (k > 0).then(|| random.below(k)),
        rest: local(random),
    });
    let targets = vec!["smile".to_owned(), "frown".to_owned()];
    Armature::new(list.collect(), targets).unwrap()
}

/// Random pose of an armature.
pub fn pose(armature: &Armature, random: &mut Random) -> Pose {
    let mut pose = armature.rest().clone();
    for index in 0..armature.bones() {
        pose.set_local(armature.bone_at(index).unwrap(), local(random))
            .unwrap();
    }
    for weight in pose.morph_weights_mut() {
        *weight = random.unit() as f32;
    }
    pose
}

/// Angle between two rotations, radians.
pub fn apart(a: Quat, b: Quat) -> f32 {
    let rotation_between = a.as_dquat().normalize().conjugate() * b.as_dquat().normalize();
    (2.0 * rotation_between.xyz().length().min(1.0).asin()) as f32
}

/// Largest difference between two poses, over lengths in metres and angles in radians.
pub fn difference(a: &Pose, b: &Pose) -> f32 {
    let vectors = |a: &[Vec3A], b: &[Vec3A]| {
        let pairs = a.iter().zip(b);
        pairs.map(|(a, b)| (*a - *b).length()).fold(0.0, f32::max)
    };
    let turns = a.rotations().iter().zip(b.rotations());
    let turns = turns.map(|(a, b)| apart(*a, *b)).fold(0.0, f32::max);
    let weights = a.morph_weights().iter().zip(b.morph_weights());
    let weights = weights.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    vectors(a.translations(), b.translations())
        .max(vectors(a.scales(), b.scales()))
        .max(turns)
        .max(weights)
}

/// Model transforms as products of matrices along each bone's ancestors, in double precision.
pub fn model_by_ancestors(armature: &Armature, pose: &Pose) -> Vec<Affine3A> {
    let each = (0..armature.bones()).map(|index| {
        let mut next = armature.bone_at(index);
        let mut product = glam::DAffine3::IDENTITY;
        while let Some(bone) = next {
            let local = pose.local(bone).unwrap();
            let parent_from_bone = glam::DAffine3::from_scale_rotation_translation(
                local.scale.as_dvec3(),
                local.rotation.as_dquat().normalize(),
                local.translation.as_dvec3(),
            );
            product = parent_from_bone * product;
            next = armature.parent(bone);
        }
        let m = product.matrix3;
        let columns = [m.x_axis, m.y_axis, m.z_axis].map(|c| c.as_vec3a());
        let [x, y, z] = columns;
        Affine3A {
            matrix3: glam::Mat3A::from_cols(x, y, z),
            translation: product.translation.as_vec3a(),
        }
    });
    each.collect()
}

/// Model transforms of the bones of a pose.
pub fn model_transforms(armature: &Armature, pose: &Pose) -> Vec<Affine3A> {
    let mut model_from_bone = vec![Affine3A::IDENTITY; armature.bones()];
    armature.local_to_model(pose, &mut model_from_bone).unwrap();
    model_from_bone
}
