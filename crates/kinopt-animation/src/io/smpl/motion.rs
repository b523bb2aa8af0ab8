//! Armature and clip of a motion of the SMPL family.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::{DQuat, DVec3, Quat, Vec3A};

use super::arrays::check_length;
use super::default_skeleton::{DEFAULT_HEIGHT, default_rest};
use super::joints::Family;
use super::{BodyModel, SmplArrays, SmplError, SmplNote};
use crate::animation::{Armature, ArmatureBone, Clip, ClipError, LocalTransform};
use crate::io::bvh::{BvhChannel, MotionCapture};
use kinopt_kinematics::scalar::elementary;

/// Source of rest joints for arrays without joints.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum RestJoints {
    /// Default skeleton of 1.7 m, with a note.
    #[default]
    Default,
    /// Default skeleton of a height in metres, with a note.
    Height(f64),
    /// A body model, with the shape parameters of the motion.
    BodyModel(BodyModel),
}

/// Motion of the SMPL family as armature and clip, in metres.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct SmplMotion {
    /// Bone for each joint, with the names of the family.
    pub armature: Armature,
    /// Rotations of all joints and translations of the root.
    pub clip: Clip,
    /// Number of frames.
    pub frames: usize,
    /// Frames per second.
    pub frame_rate: f64,
    /// Notes for review.
    pub notes: Vec<SmplNote>,
}

impl SmplMotion {
    /// Creates armature and clip from arrays. `name` names the clip.
    ///
    /// # Errors
    /// Returns an error for arrays of other lengths, numbers that are not finite, and a body model of another family.
    pub fn new(
        name: &str,
        arrays: &SmplArrays,
        rest_joints: &RestJoints,
    ) -> Result<Self, SmplError> {
        let family = arrays.check()?;
        let joints = family.joints();
        let rotations = joint_rotations(&arrays.poses);
        let mut notes = Vec::new();
        let rest = match &arrays.joints {
            Some(positions) => given_rest(positions, arrays.frames(), &joints, &rotations)?,
            None => source_rest(family, &arrays.betas, rest_joints, &mut notes)?,
        };
        let upright = upright_rotation(&rotations, joints.len());
        let bones = joints.iter().enumerate().map(|(joint, (name, parent))| {
            let offset = parent.map_or(rest[joint], |parent| rest[joint] - rest[parent]);
            let (rotation, translation) = match parent {
                None => (upright, upright * offset),
                Some(_) => (DQuat::IDENTITY, offset),
            };
            ArmatureBone {
                name: name.clone(),
                parent: *parent,
                rest: local(rotation, translation),
            }
        });
        let armature = Armature::new(bones.collect(), Vec::new())?;
        let poses = rotations.chunks_exact(joints.len());
        let roots = arrays.translations.chunks_exact(3);
        let poses = poses.zip(roots).map(|(rotations, root)| {
            let mut pose = armature.rest().clone();
            for (bone, rotation) in armature.bone_ids().zip(rotations) {
                let mut transform = pose.local_of(bone);
                transform.rotation = single(*rotation);
                if armature.parent(bone).is_none() {
                    let root = rest[0] + DVec3::from_slice(root);
                    transform.translation = single_vector(root);
                }
                pose.set_local(bone, transform)?;
            }
            Ok(pose)
        });
        let poses: Vec<_> = poses.collect::<Result<_, ClipError>>()?;
        let times = (0..poses.len()).map(|frame| (frame as f64 / arrays.frame_rate) as f32);
        let times: Vec<f32> = times.collect();
        Ok(Self {
            clip: Clip::through_poses(name, &armature, &times, &poses)?,
            armature,
            frames: poses.len(),
            frame_rate: arrays.frame_rate,
            notes,
        })
    }
}

impl From<SmplMotion> for MotionCapture {
    /// Content of a BVH file with this motion: rotations in the order z, x, y, and positions of the root. Notes are left
    /// out.
    fn from(motion: SmplMotion) -> Self {
        use BvhChannel::{Xposition, Xrotation, Yposition, Yrotation, Zposition, Zrotation};
        let rotations = vec![Zrotation, Xrotation, Yrotation];
        let root = vec![
            Xposition, Yposition, Zposition, Zrotation, Xrotation, Yrotation,
        ];
        let bones = motion.armature.bone_ids();
        let channels = bones.map(|bone| match motion.armature.parent(bone) {
            None => root.clone(),
            Some(_) => rotations.clone(),
        });
        Self {
            channels: channels.collect(),
            armature: motion.armature,
            clip: motion.clip,
            frames: motion.frames,
            frame_time: 1.0 / motion.frame_rate,
            notes: Vec::new(),
        }
    }
}

/// Rotations of axis-angle vectors.
fn joint_rotations(poses: &[f64]) -> Vec<DQuat> {
    let vectors = poses.chunks_exact(3).map(DVec3::from_slice);
    let rotations = vectors.map(|vector| {
        let angle = vector.length();
        let (sine, cosine) = elementary::sin_cos(0.5 * angle);
        // The limit of sin(a / 2) / a at 0 is 1/2.
        let factor = if angle > 1e-12 { sine / angle } else { 0.5 };
        let [x, y, z] = (vector * factor).to_array();
        DQuat::from_xyzw(x, y, z, cosine).normalize()
    });
    rotations.collect()
}

/// Rest joints from positions of the file: at rest, or posed.
fn given_rest(
    positions: &[f64],
    frames: usize,
    joints: &[(String, Option<usize>)],
    rotations: &[DQuat],
) -> Result<Vec<DVec3>, SmplError> {
    let count = joints.len();
    let positions: Vec<DVec3> = positions.chunks_exact(3).map(DVec3::from_slice).collect();
    if positions.len() == count {
        return Ok(positions);
    }
    check_length("jtr", positions.len(), frames * count)?;
    // A posed joint is its parent plus the rotated offset, so the first frame determines all offsets.
    let mut world: Vec<DQuat> = Vec::with_capacity(count);
    let mut rest: Vec<DVec3> = Vec::with_capacity(count);
    for (joint, (_, parent)) in joints.iter().enumerate() {
        match parent {
            None => {
                world.push(rotations[joint]);
                rest.push(DVec3::ZERO);
            }
            Some(parent) => {
                let offset = positions[joint] - positions[*parent];
                rest.push(rest[*parent] + world[*parent].conjugate() * offset);
                world.push(world[*parent] * rotations[joint]);
            }
        }
    }
    Ok(rest)
}

/// Rest joints of a source other than the file.
fn source_rest(
    family: Family,
    betas: &[f64],
    source: &RestJoints,
    notes: &mut Vec<SmplNote>,
) -> Result<Vec<DVec3>, SmplError> {
    let height = match source {
        RestJoints::BodyModel(model) => {
            let expected = family.joints().len();
            if model.joints() != expected {
                return Err(SmplError::OtherBodyModel {
                    given: model.joints(),
                    expected,
                    family: family.name(),
                });
            }
            if betas.len() > model.components() {
                notes.push(SmplNote::UnusedBetas {
                    used: model.components(),
                    given: betas.len(),
                });
            }
            return Ok(model.rest(betas).into_iter().map(DVec3::from).collect());
        }
        RestJoints::Height(height) => *height,
        RestJoints::Default => DEFAULT_HEIGHT,
    };
    if !(0.1..=10.0).contains(&height) {
        return Err(SmplError::BadHeight(height));
    }
    notes.push(SmplNote::DefaultSkeleton { height });
    let rest = default_rest(family, height).into_iter();
    Ok(rest.map(DVec3::from).collect())
}

/// Rotation of the T-pose, which has y up, to the upward axis of a motion: the axis nearest to that of the root in the
/// mean over all frames.
fn upright_rotation(rotations: &[DQuat], joints: usize) -> DQuat {
    let roots = rotations.iter().step_by(joints);
    let up: DVec3 = roots.map(|rotation| *rotation * DVec3::Y).sum();
    match up.z.abs() > up.y.abs() {
        // 90° about x.
        true => DQuat::from_xyzw(FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2),
        false => DQuat::IDENTITY,
    }
}

fn local(rotation: DQuat, translation: DVec3) -> LocalTransform {
    LocalTransform {
        rotation: single(rotation),
        translation: single_vector(translation),
        ..LocalTransform::IDENTITY
    }
}

fn single(rotation: DQuat) -> Quat {
    rotation.as_quat().normalize()
}

fn single_vector(vector: DVec3) -> Vec3A {
    vector.as_vec3().into()
}
