//! The bones of a skeleton on ball joints instead of three hinges each.

use super::{BoneId, Cones, Posing, Skeleton, SkeletonError};
use crate::kinematics::KinematicsError;
use crate::model::{
    FrameId, JointId, LengthUnit, Limits, Model, ParameterMapBuilder, UnknownName, quaternion_at,
};
use crate::skeleton::{BonePlacements, Holds};
use crate::spatial::{Placement, Quaternion, Vector3};

/// How the topmost bones that turn stand in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SkeletonRoot {
    /// They turn where they stand at rest.
    Fixed,
    /// They move any way: x, y, z from where they stand at rest within `room` (the rig's unit, along the model's axes)
    /// and a unit quaternion, which is how they are turned from rest in the model's axes.
    Free {
        /// How far they may go.
        room: [Limits; 3],
    },
}

impl SkeletonRoot {
    /// Any way and anywhere.
    pub const FREE: Self = Self::Free {
        room: [Limits::UNBOUNDED; 3],
    };
}

/// A skeleton whose bones turn on ball joints within cones: one unit quaternion a bone.
///
/// A configuration has w, x, y, z for each bone that turns, in their order: how it is turned from rest in its own
/// axes, so that all (1, 0, 0, 0) is the rest pose. A [free](SkeletonRoot::Free) root's begins with x, y, z. Bones whose
/// three limits are locked at one value each do not turn; other limits of the skeleton do not count, the cones do.
///
/// The model's frames have the names and ids of the skeleton's, its joints those of the bones; of a free root they
/// are `NAME/x`, `NAME/y`, `NAME/z` and `NAME/rotation`.
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
    /// By bone; `None` for those that do not turn.
    joints: Vec<Option<JointId>>,
    /// The topmost bones that turn, of a free root.
    free: Vec<BoneId>,
}

/// What carries a bone, and where the bone's frame stands in that.
type Carried = (Option<JointId>, Placement<f64>);

impl BallSkeleton {
    /// Puts every bone that turns on a ball joint, within its cone if it has one.
    ///
    /// A cone without an axis of its own is about the bone: from its tail to its tip, or where it has no length to the
    /// middle of its children's tails, else on from its parent's tail.
    ///
    /// # Errors
    /// A cone of a bone that there is not, that does not turn or that is a free root; a cone that leaves nothing or whose
    /// axis has no direction; a free root's room that is none; names that clash.
    pub fn new(
        skeleton: Skeleton,
        cones: &Cones,
        root: SkeletonRoot,
    ) -> Result<Self, SkeletonError> {
        for name in cones.keys() {
            skeleton.bone(name)?;
        }
        let bones = skeleton.bones();
        let mut builder = Model::builder(skeleton.model().name());
        builder.length_unit(LengthUnit::Own);
        let mut carried: Vec<Carried> = Vec::with_capacity(bones.len());
        let (mut joints, mut free) = (Vec::with_capacity(bones.len()), Vec::new());
        let mut frames = skeleton.model().frames().chunks_exact(2);
        for (index, bone) in bones.iter().enumerate() {
            let (below, below_from_bone) = match bone.parent.map(BoneId::index) {
                Some(parent) => {
                    let placed = bones[parent].model_from_rest.inverse() * bone.model_from_rest;
                    let (below, below_from_parent) = carried[parent];
                    (below, below_from_parent * placed)
                }
                None => (None, bone.model_from_rest),
            };
            let turns = !bone.limits.iter().all(Limits::is_locked);
            let cone = cones.get(&bone.name);
            let name = || bone.name.clone();
            let (joint, joint_from_bone) = match (turns, root) {
                (false, _) if cone.is_some() => {
                    return Err(SkeletonError::ConeOfStillBone { bone: name() });
                }
                (false, _) => (None, below_from_bone),
                (true, SkeletonRoot::Free { .. }) if below.is_none() && cone.is_some() => {
                    return Err(SkeletonError::ConeOfFreeBone { bone: name() });
                }
                (true, SkeletonRoot::Free { room }) if below.is_none() => {
                    let at = Placement::translation(below_from_bone.translation);
                    let turned = Placement::new(below_from_bone.rotation, Vector3::zero());
                    free.push(BoneId::new(index));
                    (Some(builder.free(name(), None, at, room)), turned)
                }
                (true, _) => {
                    let axis = cone.and_then(|cone| cone.axis);
                    let axis = axis.unwrap_or_else(|| along(&skeleton, index));
                    let limits = cone.map(|cone| cone.limits);
                    let joint = builder.ball(name(), below, below_from_bone, axis, limits);
                    (Some(joint), Placement::identity())
                }
            };
            let on = (joint.or(below), joint_from_bone);
            if let Some([tail, tip]) = frames.next() {
                let at_tip = Placement::translation(Vector3::new(bone.length, 0.0, 0.0));
                builder.frame(tail.name.clone(), on.0, on.1);
                builder.frame(tip.name.clone(), on.0, on.1 * at_tip);
            }
            carried.push(on);
            joints.push(joint);
        }
        Ok(Self {
            model: builder.build()?,
            skeleton,
            joints,
            free,
        })
    }

    getters! {
        /// The bones at rest; its own model has them on hinges.
        pub fn skeleton(&self) -> &Skeleton = &self.skeleton;
        /// The model with a ball a bone; it is what problems are stated on.
        pub fn model(&self) -> &Model = &self.model;
        /// The model frame at a bone's tail, with the bone's axes.
        pub fn tail(&self, bone: BoneId) -> FrameId = self.skeleton.tail(bone);
        /// The model frame at a bone's tip, with the bone's axes.
        pub fn tip(&self, bone: BoneId) -> FrameId = self.skeleton.tip(bone);
        /// Whether a bone is the first that turns on a free root.
        pub fn is_free(&self, bone: BoneId) -> bool = self.free.contains(&bone);
    }

    /// Looks a bone up by name.
    ///
    /// # Errors
    /// An unknown name; the error lists the valid ones.
    pub fn bone(&self, name: &str) -> Result<BoneId, UnknownName> {
        self.skeleton.bone(name)
    }

    /// The ball that a bone turns on, a free root's too; `None` for one that does not turn.
    #[must_use]
    pub fn joint(&self, bone: BoneId) -> Option<JointId> {
        self.joints.get(bone.index()).copied().flatten()
    }

    /// What moves a bone: its ball, of a free root its slides along x, y and z before it; empty for one that does not
    /// turn.
    #[must_use]
    pub fn joints(&self, bone: BoneId) -> Vec<JointId> {
        let ball = self.joint(bone).map(JointId::index);
        let slides = if self.is_free(bone) { 3 } else { 0 };
        let own = ball.map(|ball| (ball - slides..=ball).map(JointId::new));
        own.into_iter().flatten().collect()
    }

    /// Memory for posing the bones again and again.
    #[must_use]
    pub fn posing(&self) -> Posing {
        Posing::of_model(&self.model, self.skeleton.bone_ids().map(|b| self.tail(b)))
    }

    /// Where the bones stand in a configuration; [`posing`](Self::posing) does the same without allocating each
    /// time.
    ///
    /// # Errors
    /// Another number of numbers, one that is not finite, a quaternion of length zero.
    pub fn pose(&self, q: &[f64]) -> Result<BonePlacements, KinematicsError> {
        let mut posing = self.posing();
        posing.pose(q).cloned()
    }

    /// On top of what a map says, holds the bones that [`Holds`] says do not turn as `q` has them, but for those of
    /// a free root, which goes where the ends that are held let it.
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
        for joint in holds.trunk.iter().filter_map(|&bone| self.joint(bone)) {
            let at = self.model.coordinate(joint);
            let own = at.and_then(|at| q.get(at..)?.first_chunk::<4>());
            map = map.with_locked_ball(joint, own.copied().unwrap_or([1.0, 0.0, 0.0, 0.0]));
        }
        map
    }

    /// The rotation of a bone from rest and, of a free root, where it went, both as `q` has them.
    pub(crate) fn turned(
        &self,
        bone: BoneId,
        q: &[f64],
    ) -> Option<(Quaternion<f64>, Vector3<f64>)> {
        let at = self.model.coordinate(self.joint(bone)?)?;
        let rotation = quaternion_at(q.get(at..)?)?;
        let went = match self.is_free(bone) {
            true => Vector3::from(*q.get(at.checked_sub(3)?..)?.first_chunk::<3>()?),
            false => Vector3::zero(),
        };
        Some((rotation, went))
    }
}

/// Along a bone, in its own axes.
fn along(skeleton: &Skeleton, index: usize) -> Vector3<f64> {
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
    let onwards = (count > 0.0).then(|| sum * (1.0 / count) - tail);
    let parent = bone.parent.map(|parent| &bones[parent.index()]);
    let before = parent.map(|parent| tail - parent.rest_tail());
    let small = 1e-9 * skeleton.size();
    let directions = [onwards, before].into_iter().flatten();
    let mut long = directions.filter(|direction| direction.norm() > small);
    long.next().map_or(x, |way| rotation.transpose_mul(way))
}
