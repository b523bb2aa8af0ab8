//! Skeletons as targets of retargeting: the bones of a rig, a scene or a capture, on a free base.

use std::collections::BTreeSet;
use std::f64::consts::FRAC_1_SQRT_2;

use glam::{Affine3A, DQuat, DVec3};

use super::anatomy::{JointTree, recognise};
use super::up_detection::upright;
use super::{BodyPart, RetargetError, UpAxis};
use kinopt_animation::animation::{Armature, Clip, EulerPoseMap, Pose};
use kinopt_kinematics::skeleton::{BoneId, Skeleton};
use kinopt_kinematics::spatial::{Placement, Vector3};
use kinopt_robot::robot::{BaseJoint, Robot};

/// Length of the free base in a configuration: x, y, z and a quaternion w, x, y, z.
const BASE_LEN: usize = 7;

/// Skeleton on a free base as a [`Robot`] with z up, and the conversion to poses of its file.
///
/// ```
/// # std::env::set_current_dir("../..")?;
/// use kinopt::animation::Armature;
/// use kinopt::io::rig::Rig;
/// use kinopt::motion::retarget::{FigureTarget, UpAxis};
///
/// let rig = Rig::read("models/humanoid/humanoid.json")?;
/// let figure = FigureTarget::new(&rig.skeleton, UpAxis::Z)?;
/// // 1 m sideways, in the rest pose.
/// let mut q = figure.robot().model().neutral();
/// q[1] = 1.0;
/// let armature = Armature::of_skeleton(&rig.skeleton);
/// let hips = rig.skeleton.bone_ids().next().ok_or("no bones")?;
/// let pose = &figure.poses(&armature, armature.rest(), &q)?[0];
/// let moved = armature.model_from_bone(pose, hips)?.translation;
/// let stood = armature.model_from_bone(armature.rest(), hips)?.translation;
/// assert!((moved.y - stood.y - 1.0).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct FigureTarget {
    robot: Robot,
    /// Skeleton with z up.
    upright: Skeleton,
    angles: EulerPoseMap,
    up: UpAxis,
    names: Vec<String>,
    /// Topmost movable bones, which move with the base.
    topmost: Vec<BoneId>,
}

impl FigureTarget {
    /// Creates a target from a skeleton in whose file `up` is the upward axis.
    ///
    /// # Errors
    /// Returns an error if a bone has the name of a base joint, or if the skeleton is invalid.
    pub fn new(skeleton: &Skeleton, up: UpAxis) -> Result<Self, RetargetError> {
        let placed = match up {
            UpAxis::Y => skeleton.placed(Placement::new(up.turned_to_z(), Vector3::zero()))?,
            UpAxis::Z => skeleton.clone(),
        };
        let robot = Robot::new(placed.model().clone(), Vec::new())?;
        let turning: Vec<bool> = skeleton
            .bones()
            .iter()
            .map(|bone| bone.limits.iter().any(|limits| limits.upper > limits.lower))
            .collect();
        let parent_of = |bone: BoneId| skeleton.bones()[bone.index()].parent;
        let is_topmost = |bone: &BoneId| {
            let mut above = std::iter::successors(parent_of(*bone), |parent| parent_of(*parent));
            turning[bone.index()] && !above.any(|ancestor| turning[ancestor.index()])
        };
        Ok(Self {
            robot: robot.with_base_joint(BaseJoint::FREE)?,
            upright: placed,
            angles: EulerPoseMap::new(skeleton),
            up,
            names: skeleton
                .bones()
                .iter()
                .map(|bone| bone.name.clone())
                .collect(),
            topmost: skeleton.bone_ids().filter(is_topmost).collect(),
        })
    }

    /// Returns the upward axis of a file: that from the ankles to the pelvis at rest.
    #[must_use]
    pub fn up_axis(skeleton: &Skeleton) -> Option<UpAxis> {
        let (tree, _) = JointTree::of_character(skeleton.model())?;
        let parts = recognise(&tree, &tree.positions).parts;
        let at = |part: BodyPart| parts.get(&part).map(|joint| tree.positions[*joint]);
        let ankles = 0.5 * (at(BodyPart::LeftAnkle)? + at(BodyPart::RightAnkle)?);
        upright(Vector3::from((at(BodyPart::Pelvis)? - ankles).to_array()))
    }

    /// Creates a target from the bones of an armature. Bones in `turning` can rotate, all other bones are fixed.
    ///
    /// For a scene, pass [those of its skins](kinopt_animation::io::gltf::Scene::turning_bones).
    ///
    /// # Errors
    /// Returns the errors of [`new`](Self::new), and an error for a bone with children and non-uniform scale.
    pub fn of_armature(
        armature: &Armature,
        turning: &BTreeSet<BoneId>,
        up: UpAxis,
    ) -> Result<Self, RetargetError> {
        Self::new(&armature.turning_skeleton("figure", turning)?, up)
    }

    /// Skeleton as a robot on a free base with z up, the target of a [`Retargeting`](super::Retargeting).
    #[must_use]
    pub fn robot(&self) -> &Robot {
        &self.robot
    }

    /// Skeleton with z up.
    pub(super) fn upright(&self) -> &Skeleton {
        &self.upright
    }

    /// Upward axis of the file.
    #[must_use]
    pub fn up(&self) -> UpAxis {
        self.up
    }

    /// Returns poses of an armature in the axes of its file, one per configuration of the [robot](Self::robot).
    ///
    /// The first bones of the armature must be those of the skeleton. Bones that cannot rotate keep their transforms in
    /// the given pose.
    ///
    /// # Errors
    /// Returns an error if the armature or pose has other bones, or if a bone would need shear.
    pub fn poses(
        &self,
        armature: &Armature,
        reference: &Pose,
        q: &[f64],
    ) -> Result<Vec<Pose>, RetargetError> {
        let names = armature.names();
        let other = (0..self.names.len()).find(|&bone| names.get(bone) != self.names.get(bone));
        if let Some(bone) = other {
            return Err(RetargetError::OtherBone {
                given: names.get(bone).cloned().unwrap_or_default(),
                bone: self.names[bone].clone(),
            });
        }
        let width = self.robot.model().configuration_len();
        let frames = q.chunks_exact(width).map(|q| {
            let mut pose = reference.clone();
            let (base, angles) = q.split_at(BASE_LEN);
            self.angles.pose_of(angles, &mut pose)?;
            let moved = self.moved(base);
            for &bone in &self.topmost {
                let placement = armature.model_from_bone(&pose, bone)?;
                armature.set_model_from_bone(&mut pose, bone, moved * placement)?;
            }
            Ok(pose)
        });
        frames.collect()
    }

    /// Returns a clip of an armature from configurations at a rate in samples per second. Other bones are at rest.
    ///
    /// # Errors
    /// Returns the errors of [`poses`](Self::poses), and an error for no samples or an invalid rate.
    pub fn clip(
        &self,
        name: impl Into<String>,
        armature: &Armature,
        q: &[f64],
        frame_rate: f64,
    ) -> Result<Clip, RetargetError> {
        let poses = self.poses(armature, armature.rest(), q)?;
        let times = (0..poses.len()).map(|frame| (frame as f64 / frame_rate) as f32);
        let times: Vec<f32> = times.collect();
        Ok(Clip::through_poses(name, armature, &times, &poses)?)
    }

    /// Returns the motion of the base in the axes of the file.
    fn moved(&self, base: &[f64]) -> Affine3A {
        let &[x, y, z, w, i, j, k] = base else {
            return Affine3A::IDENTITY;
        };
        let (rotation, translation) = (DQuat::from_xyzw(i, j, k, w), DVec3::new(x, y, z));
        let file_from_upright = match self.up {
            UpAxis::Y => DQuat::from_xyzw(-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2),
            UpAxis::Z => DQuat::IDENTITY,
        };
        let rotation = file_from_upright * rotation * file_from_upright.inverse();
        let translation = file_from_upright * translation;
        Affine3A::from_rotation_translation(rotation.as_quat().normalize(), translation.as_vec3())
    }
}
