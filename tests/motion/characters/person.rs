//! People of a shared skeleton under many names, with motions, for retargeting to characters.
//!
//! `skeleton_names.json` has one human skeleton and the names of its joints in twelve conventions. It was written for
//! this project from the public documentation of each tool, under the licence of the project.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3, Quat, Vec3A};
use kinopt::animation::{Armature, ArmatureBone, Clip, Cursor, LocalTransform, Playback, Pose};
use kinopt::motion::Trajectory;
use kinopt::motion::retarget::{
    BodyMap, Capture, FigureTarget, RetargetOptions, RetargetReport, Retargeting, UpAxis,
};
use serde::Deserialize;
use support::random::Random;
use support::retargeted::mean_target_error;

/// Frames per second of all motions.
pub(crate) const RATE: f64 = 30.0;
/// Number of frames of the motions.
pub(crate) const FRAMES: usize = 90;

#[derive(Deserialize)]
pub(crate) struct SkeletonNames {
    parts: BTreeMap<String, Part>,
    pub(crate) conventions: BTreeMap<String, BTreeMap<String, String>>,
}

#[derive(Deserialize)]
struct Part {
    parent: Option<String>,
    offset_metres: [f64; 3],
}

pub(crate) fn skeleton_names() -> SkeletonNames {
    serde_json::from_str(include_str!("skeleton_names.json")).unwrap()
}

/// Bone of a person: with y up, facing +z.
#[derive(Clone, Debug)]
pub(crate) struct PersonBone {
    pub(crate) name: String,
    /// Part of the shared skeleton whose rotation the bone has.
    pub(crate) part: String,
    pub(crate) parent: Option<usize>,
    /// Rest placement in the world.
    pub(crate) position: DVec3,
    pub(crate) rotation: DQuat,
}

/// Bones of a person at rest, parents first.
#[derive(Clone, Debug)]
pub(crate) struct Person {
    pub(crate) bones: Vec<PersonBone>,
}

impl Person {
    /// The shared skeleton in a T-pose, with the names of a convention.
    pub(crate) fn named(convention: &str) -> Self {
        let file = skeleton_names();
        let names = &file.conventions[convention];
        let mut bones: Vec<PersonBone> = Vec::new();
        let mut pending: Vec<&String> = file.parts.keys().collect();
        while !pending.is_empty() {
            pending.retain(|key| {
                let part = &file.parts[*key];
                let offset = DVec3::from_array(part.offset_metres);
                // A convention without a joint continues at the joint above.
                let mut above = part.parent.clone();
                let mut offset = offset;
                while let Some(name) = above.clone().filter(|name| !names.contains_key(name)) {
                    offset += DVec3::from_array(file.parts[&name].offset_metres);
                    above = file.parts[&name].parent.clone();
                }
                let Some(name) = names.get(*key) else {
                    return false;
                };
                let parent = above
                    .as_ref()
                    .map(|above| bones.iter().position(|bone| bone.part == *above));
                let parent = match parent {
                    Some(None) => return true,
                    Some(index) => index,
                    None => None,
                };
                let origin = parent.map_or(DVec3::ZERO, |parent| bones[parent].position);
                bones.push(PersonBone {
                    name: name.clone(),
                    part: (*key).clone(),
                    parent,
                    position: origin + offset,
                    rotation: DQuat::IDENTITY,
                });
                false
            });
        }
        Self { bones }
    }

    pub(crate) fn index(&self, part: &str) -> usize {
        self.bones
            .iter()
            .position(|bone| bone.part == part)
            .unwrap()
    }

    /// All lengths multiplied.
    pub(crate) fn scaled(mut self, scale: f64) -> Self {
        for bone in &mut self.bones {
            bone.position *= scale;
        }
        self
    }

    /// The same joints, with bones rolled and rotated at random in the rest pose.
    pub(crate) fn rolled(mut self, random: &mut Random) -> Self {
        for bone in &mut self.bones {
            let mut number = || random.within(-1.0, 1.0);
            let q = DQuat::from_xyzw(number(), number(), number(), number());
            bone.rotation = q.normalize();
        }
        self
    }

    /// Rotates a part and all bones below it at rest, about its joint.
    pub(crate) fn with_rest_turned(mut self, part: &str, axis: DVec3, degrees: f64) -> Self {
        let root = self.index(part);
        let origin = self.bones[root].position;
        let turn = DQuat::from_axis_angle(axis, degrees.to_radians());
        for bone in self.below(root) {
            let bone = &mut self.bones[bone];
            bone.position = origin + turn * (bone.position - origin);
            bone.rotation = turn * bone.rotation;
        }
        self
    }

    /// Arms lowered to an A-pose.
    pub(crate) fn in_a_pose(self, degrees: f64) -> Self {
        let left = self.with_rest_turned("Lua", DVec3::NEG_Z, degrees);
        left.with_rest_turned("Rua", DVec3::Z, degrees)
    }

    /// The segment from a part's parent to the part multiplied.
    pub(crate) fn with_segment(mut self, part: &str, factor: f64) -> Self {
        let index = self.index(part);
        let parent = self.bones[index].parent.unwrap();
        let shift = (self.bones[index].position - self.bones[parent].position) * (factor - 1.0);
        for bone in self.below(index) {
            self.bones[bone].position += shift;
        }
        self
    }

    /// Both legs moved relative to the pelvis.
    pub(crate) fn with_legs_moved(mut self, offset: DVec3) -> Self {
        for hip in ["Lth", "Rth"] {
            for bone in self.below(self.index(hip)) {
                self.bones[bone].position += offset;
            }
        }
        self
    }

    fn below(&self, root: usize) -> Vec<usize> {
        let is_below = |bone: usize| {
            let parent = |bone: &usize| self.bones[*bone].parent;
            std::iter::successors(Some(bone), parent).any(|above| above == root)
        };
        (0..self.bones.len())
            .filter(|bone| is_below(*bone))
            .collect()
    }

    /// Replaces the bones between hips and chest by a number of bones of equal lengths.
    pub(crate) fn with_spine(self, count: usize) -> Self {
        let (hips, chest) = (self.index("hips"), self.index("chest"));
        let (from, to) = (self.bones[hips].position, self.bones[chest].position);
        let is_old = |part: &str| part == "spine1" || part == "spine2";
        let mut bones: Vec<PersonBone> = Vec::new();
        let mut index_of = BTreeMap::new();
        for bone in &self.bones {
            if is_old(&bone.part) {
                continue;
            }
            let mut bone = bone.clone();
            if bone.part == "chest" {
                for k in 0..count {
                    let fraction = (k as f64 + 1.0) / (count as f64 + 1.0);
                    let parent = if k == 0 {
                        index_of["hips"]
                    } else {
                        bones.len() - 1
                    };
                    bones.push(PersonBone {
                        name: format!("trunk_{:02}", k + 1),
                        part: "spine".to_owned(),
                        parent: Some(parent),
                        position: from.lerp(to, fraction),
                        rotation: DQuat::IDENTITY,
                    });
                }
                bone.parent = Some(if count == 0 {
                    index_of["hips"]
                } else {
                    bones.len() - 1
                });
            } else if let Some(parent) = bone.parent {
                bone.parent = Some(index_of[self.bones[parent].part.as_str()]);
            }
            index_of.insert(
                self.bones[self.index(&bone.part)].part.as_str(),
                bones.len(),
            );
            bones.push(bone);
        }
        Self { bones }
    }

    /// Adds a bone between two bones of a limb, or a leaf on the limb.
    pub(crate) fn with_twist_bone(
        mut self,
        name: &str,
        limb: &str,
        end: &str,
        in_line: bool,
    ) -> Self {
        let (from, to) = (self.index(limb), self.index(end));
        let position = self.bones[from].position.lerp(self.bones[to].position, 0.5);
        let bone = PersonBone {
            name: name.to_owned(),
            part: limb.to_owned() + " twist",
            parent: Some(from),
            position,
            rotation: self.bones[from].rotation,
        };
        // Bones come after their parents.
        self.bones.insert(to, bone);
        for other in &mut self.bones {
            if let Some(parent) = other.parent.as_mut().filter(|parent| **parent >= to) {
                *parent += 1;
            }
        }
        if in_line {
            self.bones[to + 1].parent = Some(to);
        }
        self
    }

    pub(crate) fn armature(&self) -> Armature {
        let bones = self.bones.iter().map(|bone| {
            let (above, origin) = match bone.parent {
                Some(parent) => (self.bones[parent].rotation, self.bones[parent].position),
                None => (DQuat::IDENTITY, DVec3::ZERO),
            };
            let translation = (above.conjugate() * (bone.position - origin)).as_vec3a();
            ArmatureBone {
                name: bone.name.clone(),
                parent: bone.parent,
                rest: LocalTransform {
                    translation,
                    rotation: (above.conjugate() * bone.rotation).as_quat().normalize(),
                    scale: Vec3A::ONE,
                },
            }
        });
        Armature::new(bones.collect(), Vec::new()).unwrap()
    }

    /// Clip in which each part has a rotation in the world relative to the rest pose, and the hips move.
    pub(crate) fn clip(
        &self,
        motion: &dyn Fn(&str, usize) -> DQuat,
        root: &dyn Fn(usize) -> DVec3,
    ) -> Clip {
        let armature = self.armature();
        let poses = (0..FRAMES).map(|frame| {
            let mut pose = armature.rest().clone();
            let world: Vec<DQuat> = self
                .bones
                .iter()
                .map(|bone| motion(&bone.part, frame) * bone.rotation)
                .collect();
            for (index, bone) in self.bones.iter().enumerate() {
                let above = bone.parent.map_or(DQuat::IDENTITY, |parent| world[parent]);
                let local: Quat = (above.conjugate() * world[index]).as_quat().normalize();
                let id = armature.bone_at(index).unwrap();
                pose.set_rotation(id, local).unwrap();
            }
            let hips = armature.bone_at(0).unwrap();
            let place = self.bones[0].position + root(frame);
            pose.set_translation(hips, place.as_vec3a()).unwrap();
            pose
        });
        let poses: Vec<Pose> = poses.collect();
        let times: Vec<f32> = (0..FRAMES)
            .map(|frame| (frame as f64 / RATE) as f32)
            .collect();
        Clip::through_poses("motion", &armature, &times, &poses).unwrap()
    }
}

/// A motion of the whole body: rotations in the world relative to the rest pose.
pub(crate) fn dance(part: &str, frame: usize) -> DQuat {
    let t = frame as f64 / RATE;
    let about = |axis: DVec3, degrees: f64| DQuat::from_axis_angle(axis, degrees.to_radians());
    let hips = about(DVec3::Y, 25.0 * (1.3 * t).sin()) * about(DVec3::X, 6.0 * (2.0 * t).cos());
    let bend = |share: f64| {
        about(DVec3::Y, share * 30.0 * (1.7 * t).sin())
            * about(DVec3::X, share * 25.0 * (1.1 * t).cos())
    };
    let swing = |side: f64| about(DVec3::X, -25.0 * (2.0 * t + side).sin() - 20.0);
    let arm = |side: f64| {
        let raise = about(DVec3::Z, side * (40.0 * (1.5 * t + side).sin() - 30.0));
        about(DVec3::Y, side * 30.0 * (0.9 * t).cos()) * raise
    };
    let chest = hips * bend(1.0);
    match part {
        "hips" => hips,
        "spine1" => hips * bend(1.0 / 3.0),
        "spine2" => hips * bend(2.0 / 3.0),
        "chest" | "Lcl" | "Rcl" => chest,
        "neck" => chest * about(DVec3::Y, 10.0 * t.sin()),
        "head" => chest * about(DVec3::Y, 25.0 * t.sin()),
        "Lua" => chest * arm(1.0),
        "Rua" => chest * arm(-1.0),
        "Lfa" | "Lh" => chest * arm(1.0) * about(DVec3::NEG_Y, 45.0 + 40.0 * (1.9 * t).sin()),
        "Rfa" | "Rh" => chest * arm(-1.0) * about(DVec3::Y, 45.0 + 40.0 * (2.1 * t).sin()),
        "Lth" => hips * swing(0.0),
        "Rth" => hips * swing(2.0),
        "Lsh" => hips * swing(0.0) * about(DVec3::X, 35.0 + 20.0 * (2.0 * t).sin()),
        "Rsh" => hips * swing(2.0) * about(DVec3::X, 35.0 + 20.0 * (2.0 * t).cos()),
        _ => hips,
    }
}

/// Hips of the dance.
pub(crate) fn dance_root(frame: usize) -> DVec3 {
    let t = frame as f64 / RATE;
    DVec3::new(
        0.3 * (0.7 * t).sin(),
        0.03 * (2.0 * t).sin() - 0.08,
        0.4 * t,
    )
}

/// A motion onto a person.
pub(crate) struct Retargeted {
    pub(crate) motion: Trajectory<RetargetReport>,
    /// Mean distance of the driven points from their targets, in the unit of the person.
    pub(crate) target_error: f64,
    /// World placements by frame and bone, with y up.
    pub(crate) placed: Vec<Vec<(DQuat, DVec3)>>,
}

pub(crate) fn figure_of(person: &Person) -> FigureTarget {
    let armature = person.armature();
    let turning = armature.bone_ids().collect();
    FigureTarget::of_armature(&armature, &turning, UpAxis::Y).unwrap()
}

/// Retargets a clip of one person to another.
pub(crate) fn retarget(
    source: &Person,
    clip: &Clip,
    target: &Person,
    solve: impl Fn(&Retargeting<'_>) -> Trajectory<RetargetReport>,
) -> Retargeted {
    let capture = Capture::of_clip(&source.armature(), clip, RATE).unwrap();
    retarget_capture(&capture, target, solve)
}

pub(crate) fn retarget_capture(
    capture: &Capture,
    target: &Person,
    solve: impl Fn(&Retargeting<'_>) -> Trajectory<RetargetReport>,
) -> Retargeted {
    let figure = figure_of(target);
    let map = BodyMap::guess(capture, figure.robot().model()).unwrap().map;
    let options = RetargetOptions::default().with_up(UpAxis::Y);
    let fitted = Retargeting::onto_character(&figure, &map, capture, options).unwrap();
    let motion = solve(&fitted);
    let armature = target.armature();
    let clip = figure.clip("out", &armature, &motion.q, RATE).unwrap();
    let placed = placements(&armature, &clip);
    let target_error = mean_target_error(&fitted, &motion);
    Retargeted {
        motion,
        target_error,
        placed,
    }
}

/// World placements of a clip by frame and bone, by products of local transforms.
pub(crate) fn placements(armature: &Armature, clip: &Clip) -> Vec<Vec<(DQuat, DVec3)>> {
    let mut pose = armature.rest().clone();
    let mut cursor = Cursor::new();
    let frames = (clip.duration() * RATE + 0.5).floor() as usize + 1;
    (0..frames)
        .map(|frame| {
            let time = clip.start() + frame as f64 / RATE;
            clip.sample(time, Playback::Hold, &mut cursor, &mut pose)
                .unwrap();
            let mut placed: Vec<(DQuat, DVec3)> = Vec::new();
            for bone in armature.bone_ids() {
                let local = pose.local(bone).unwrap();
                let (rotation, position) = match armature.parent(bone) {
                    Some(parent) => placed[parent.index()],
                    None => (DQuat::IDENTITY, DVec3::ZERO),
                };
                placed.push((
                    (rotation * local.rotation.as_dquat()).normalize(),
                    position + rotation * local.translation.as_dvec3(),
                ));
            }
            placed
        })
        .collect()
}

/// Segments whose directions are compared, by the parts at their ends.
pub(crate) const SEGMENTS: [(&str, &str); 12] = [
    ("hips", "chest"),
    ("chest", "neck"),
    ("neck", "head"),
    ("Lua", "Lfa"),
    ("Lfa", "Lh"),
    ("Rua", "Rfa"),
    ("Rfa", "Rh"),
    ("Lth", "Lsh"),
    ("Lsh", "Lf"),
    ("Rth", "Rsh"),
    ("Rsh", "Rf"),
    ("Lf", "Lt"),
];

/// Mean and largest angle in degrees between the directions of each segment of two people.
pub(crate) fn direction_errors(
    (source, from): (&Person, &[Vec<(DQuat, DVec3)>]),
    (target, to): (&Person, &[Vec<(DQuat, DVec3)>]),
) -> Vec<(&'static str, f64, f64)> {
    assert_eq!(from.len(), to.len());
    SEGMENTS
        .iter()
        .map(|(start, end)| {
            let direction = |person: &Person, placed: &[(DQuat, DVec3)]| {
                placed[person.index(end)].1 - placed[person.index(start)].1
            };
            let angles = from.iter().zip(to).map(|(from, to)| {
                let (a, b) = (direction(source, from), direction(target, to));
                a.cross(b).length().atan2(a.dot(b)).to_degrees()
            });
            let angles: Vec<f64> = angles.collect();
            let mean = angles.iter().sum::<f64>() / angles.len() as f64;
            (*end, mean, angles.iter().copied().fold(0.0, f64::max))
        })
        .collect()
}

/// Largest angle in degrees between the rotations of two motions, with the bone.
pub(crate) fn largest_rotation_error(
    from: &[Vec<(DQuat, DVec3)>],
    to: &[Vec<(DQuat, DVec3)>],
) -> (f64, usize) {
    let mut largest = (0.0, 0);
    for (from, to) in from.iter().zip(to) {
        for (bone, ((a, _), (b, _))) in from.iter().zip(to).enumerate() {
            let difference = (a.conjugate() * *b).normalize();
            let angle = 2.0 * difference.xyz().length().atan2(difference.w.abs());
            if angle.to_degrees() > largest.0 {
                largest = (angle.to_degrees(), bone);
            }
        }
    }
    largest
}
