//! Skeletons with one ball joint per bone instead of three revolute joints.

use super::{BoneId, Cones, Hinge, Posing, Skeleton};
use crate::kinematics::KinematicsError;
use crate::model::ModelError;
use crate::model::{
    FrameId, JointId, LengthUnit, Limits, Model, ParameterMapBuilder, UnknownName, quaternion_at,
};
use crate::skeleton::{BonePlacements, Holds};
use crate::spatial::{Placement, Quaternion, Vector3};

/// Motion of the topmost movable bones in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SkeletonRoot {
    /// The bones rotate about their positions at rest.
    Fixed,
    /// The bones move with six degrees of freedom. x, y and z are offsets from the position at rest within `bounds` (the
    /// rig's unit, along the model's axes). A unit quaternion is the rotation from rest in the model's axes.
    Free {
        /// Bounds of the offsets, in the rig's unit.
        bounds: [Limits; 3],
    },
}

impl SkeletonRoot {
    /// Six degrees of freedom without bounds.
    pub const FREE: Self = Self::Free {
        bounds: [Limits::UNBOUNDED; 3],
    };
}

/// A skeleton whose bones rotate on ball joints within cones: one unit quaternion per bone.
///
/// A configuration has w, x, y, z for each bone on a ball joint, in their order: the rotation from rest in the bone's axes. All
/// (1, 0, 0, 0) is the rest pose. The numbers of a [free](SkeletonRoot::Free) root start with x, y, z.
///
/// Bones whose three limits are each locked at one value have no joint. A bone with a [hinge](super::Hinge) has a
/// revolute joint: one number, its angle in radians. Other limits of the skeleton are ignored; the cones replace them.
///
/// Frames of the model have the names and ids of the skeleton's frames, joints the names of the bones. The joints of a
/// free root are `NAME/x`, `NAME/y`, `NAME/z` and `NAME/rotation`.
///
/// ```
/// use kinopt::model::{BallLimits, Limits};
/// use kinopt::skeleton::{BallSkeleton, BoneCone, Cones, SkeletonRoot};
/// # use kinopt::Skeleton;
/// # use kinopt::skeleton::Bone;
/// # use kinopt::spatial::{Placement, Vector3};
/// # let mut builder = Skeleton::builder("arm");
/// # let bone = |name: &str, parent, along: f64| Bone {
/// #     name: name.to_owned(), parent, length: 0.3, limits: [Limits::UNBOUNDED; 3],
/// #     model_from_rest: Placement::translation(Vector3::new(along, 0.0, 0.0)),
/// # };
/// # let upper = builder.add(bone("upper", None, 0.0));
/// # builder.add(bone("fore", Some(upper), 0.3));
/// # let skeleton = builder.build()?;
/// let wide = BallLimits::cone(80f64.to_radians(), Limits::new(-1.0, 1.0));
/// let cones = Cones::from([("upper".to_owned(), BoneCone::new(wide))]);
/// let figure = BallSkeleton::new(skeleton, &cones, SkeletonRoot::Fixed)?;
/// assert_eq!(figure.model().configuration_len(), 2 * 4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct BallSkeleton {
    skeleton: Skeleton,
    model: Model,
    /// Ball joint or hinge by bone; `None` for bones without a joint.
    joints: Vec<Option<JointId>>,
    /// The topmost movable bones of a free root.
    free: Vec<BoneId>,
}

/// The joint that carries a bone, and the pose of the bone's frame in it.
type Attachment = (Option<JointId>, Placement<f64>);

impl BallSkeleton {
    /// Creates a ball joint for every movable bone, within its cone if it has one.
    ///
    /// The default axis of a cone is that of the bone, from its tail to its tip. For a bone of length 0 it points to
    /// the mean of its children's tails, or else away from its parent's tail.
    ///
    /// # Errors
    /// A cone of a bone that does not exist, has no joint or is a free root. Also a cone without any rotation or with a
    /// zero axis, invalid bounds of a free root, or name clashes.
    pub fn new(skeleton: Skeleton, cones: &Cones, root: SkeletonRoot) -> Result<Self, ModelError> {
        for name in cones.keys() {
            skeleton.bone(name)?;
        }
        let bones = skeleton.bones();
        let mut builder = Model::builder(skeleton.model().name());
        builder.length_unit(LengthUnit::Own);
        let mut attachments: Vec<Attachment> = Vec::with_capacity(bones.len());
        let (mut joints, mut free) = (Vec::with_capacity(bones.len()), Vec::new());
        let mut frames = skeleton.model().frames().chunks_exact(2);
        for (index, bone) in bones.iter().enumerate() {
            let (parent_joint, parent_from_bone) = match bone.parent.map(BoneId::index) {
                Some(parent) => {
                    let placed = bones[parent].model_from_rest.inverse() * bone.model_from_rest;
                    let (parent_joint, joint_from_parent) = attachments[parent];
                    (parent_joint, joint_from_parent * placed)
                }
                None => (None, bone.model_from_rest),
            };
            let is_movable = !bone.limits.iter().all(Limits::is_locked);
            let cone = cones.get(&bone.name);
            let name = || bone.name.clone();
            let hinge = skeleton.hinge(BoneId::new(index));
            if hinge.is_some() && cone.is_some() {
                let problem = "the bone has a cone as well".to_owned();
                return Err(ModelError::BadHinge {
                    bone: name(),
                    problem,
                });
            }
            let (joint, joint_from_bone) = match (is_movable, root) {
                (false, _) if cone.is_some() => {
                    return Err(ModelError::ConeOfStillBone { bone: name() });
                }
                (false, _) => (None, parent_from_bone),
                (true, SkeletonRoot::Free { .. }) if parent_joint.is_none() && cone.is_some() => {
                    return Err(ModelError::ConeOfFreeBone { bone: name() });
                }
                (true, SkeletonRoot::Free { bounds }) if parent_joint.is_none() => {
                    let origin = Placement::translation(parent_from_bone.translation);
                    let rotation = Placement::new(parent_from_bone.rotation, Vector3::zero());
                    free.push(BoneId::new(index));
                    (Some(builder.free(name(), None, origin, bounds)), rotation)
                }
                (true, _) => {
                    let joint = match hinge {
                        Some(Hinge { axis, limits }) => {
                            builder.revolute(name(), parent_joint, parent_from_bone, axis, limits)
                        }
                        None => {
                            let axis = cone.and_then(|cone| cone.axis);
                            let axis = axis.unwrap_or_else(|| bone_direction(&skeleton, index));
                            let limits = cone.map(|cone| cone.limits);
                            builder.ball(name(), parent_joint, parent_from_bone, axis, limits)
                        }
                    };
                    (Some(joint), Placement::identity())
                }
            };
            let attachment = (joint.or(parent_joint), joint_from_bone);
            if let Some([tail, tip]) = frames.next() {
                let at_tip = Placement::translation(Vector3::new(bone.length, 0.0, 0.0));
                builder.frame(tail.name.clone(), attachment.0, attachment.1);
                builder.frame(tip.name.clone(), attachment.0, attachment.1 * at_tip);
            }
            attachments.push(attachment);
            joints.push(joint);
        }
        Ok(Self {
            model: builder.build()?,
            skeleton,
            joints,
            free,
        })
    }

    /// The skeleton; its model has revolute joints.
    #[must_use]
    pub fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }

    /// The model with ball joints, for problems.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The model frame at a bone's tail, with the bone's axes.
    #[must_use]
    pub fn tail(&self, bone: BoneId) -> FrameId {
        self.skeleton.tail(bone)
    }

    /// The model frame at a bone's tip, with the bone's axes.
    #[must_use]
    pub fn tip(&self, bone: BoneId) -> FrameId {
        self.skeleton.tip(bone)
    }

    /// Reports whether a bone is a topmost movable bone of a free root.
    #[must_use]
    pub fn is_free(&self, bone: BoneId) -> bool {
        self.free.contains(&bone)
    }

    /// Looks up a bone by name.
    ///
    /// # Errors
    /// An unknown name. The error lists the valid ones.
    pub fn bone(&self, name: &str) -> Result<BoneId, UnknownName> {
        self.skeleton.bone(name)
    }

    /// The ball joint of a bone, including those of a free root, or its hinge; `None` for a bone without a joint.
    #[must_use]
    pub fn joint(&self, bone: BoneId) -> Option<JointId> {
        self.joints.get(bone.index()).copied().flatten()
    }

    /// The joints of a bone: its ball joint or hinge, for a free root after its three prismatic joints. Empty for a bone without
    /// a joint.
    #[must_use]
    pub fn joints(&self, bone: BoneId) -> Vec<JointId> {
        let ball = self.joint(bone).map(JointId::index);
        let prismatic_joints = if self.is_free(bone) { 3 } else { 0 };
        let joints = ball.map(|ball| (ball - prismatic_joints..=ball).map(JointId::new));
        joints.into_iter().flatten().collect()
    }

    /// A workspace for posing the bones repeatedly.
    #[must_use]
    pub fn posing(&self) -> Posing {
        Posing::of_model(&self.model, self.skeleton.bone_ids().map(|b| self.tail(b)))
    }

    /// Poses of the bones at a configuration. [`posing`](Self::posing) avoids the allocations.
    ///
    /// # Errors
    /// A different length, a number that is not finite, or a zero quaternion.
    pub fn pose(&self, q: &[f64]) -> Result<BonePlacements, KinematicsError> {
        let mut posing = self.posing();
        posing.pose(q).cloned()
    }

    /// Locks the root chain of [`Holds`] at `q` in a parameter map. A free root is not locked: the fixed ends determine
    /// its pose.
    #[must_use]
    pub fn hold<'m>(
        &self,
        mut map: ParameterMapBuilder<'m>,
        holds: &Holds,
        q: &[f64],
    ) -> ParameterMapBuilder<'m> {
        map = map.checked(q);
        if !self.free.is_empty() {
            return map;
        }
        for &bone in &holds.trunk {
            let Some(joint) = self.joint(bone) else {
                continue;
            };
            let coordinate = self.model.coordinate(joint);
            if self.hinge(bone).is_some() {
                let angle = coordinate.and_then(|coordinate| q.get(coordinate));
                map = map.with_locked(joint, angle.copied().unwrap_or(0.0));
                continue;
            }
            let quaternion =
                coordinate.and_then(|coordinate| q.get(coordinate..)?.first_chunk::<4>());
            map = map.with_locked_ball(joint, quaternion.copied().unwrap_or([1.0, 0.0, 0.0, 0.0]));
        }
        map
    }

    /// The hinge of a bone; `None` for a bone on a ball joint. A free root is not hinged.
    #[must_use]
    pub fn hinge(&self, bone: BoneId) -> Option<Hinge> {
        let hinge = self.skeleton.hinge(bone);
        hinge.filter(|_| !self.is_free(bone))
    }

    /// Rotation of a bone from rest at `q`, and the offset of a free root (zero for other bones).
    #[doc(hidden)]
    pub fn rotation_and_offset(
        &self,
        bone: BoneId,
        q: &[f64],
    ) -> Option<(Quaternion<f64>, Vector3<f64>)> {
        let coordinate = self.model.coordinate(self.joint(bone)?)?;
        if let Some(hinge) = self.hinge(bone) {
            return Some((hinge.rotation(*q.get(coordinate)?), Vector3::zero()));
        }
        let rotation = quaternion_at(q.get(coordinate..)?)?;
        let offset = match self.is_free(bone) {
            true => Vector3::from(*q.get(coordinate.checked_sub(3)?..)?.first_chunk::<3>()?),
            false => Vector3::zero(),
        };
        Some((rotation, offset))
    }
}

/// Direction along a bone, in its axes.
fn bone_direction(skeleton: &Skeleton, index: usize) -> Vector3<f64> {
    let bones = skeleton.bones();
    let bone = &bones[index];
    let [x, ..] = Vector3::UNITS;
    if bone.length > 0.0 {
        return x;
    }
    let (tail, rotation) = (bone.rest_tail(), bone.model_from_rest.rotation);
    let id = BoneId::new(index);
    let children = bones.iter().filter(|child| child.parent == Some(id));
    let (sum, count) = children.fold((Vector3::zero(), 0.0), |(sum, count), child| {
        (sum + child.rest_tail(), count + 1.0)
    });
    let to_children = (count > 0.0).then(|| sum * (1.0 / count) - tail);
    let parent = bone.parent.map(|parent| &bones[parent.index()]);
    let from_parent = parent.map(|parent| tail - parent.rest_tail());
    let min_length = 1e-9 * skeleton.size();
    let directions = [to_children, from_parent].into_iter().flatten();
    let mut candidates = directions.filter(|direction| direction.norm() > min_length);
    candidates
        .next()
        .map_or(x, |direction| rotation.transpose_mul(direction))
}
