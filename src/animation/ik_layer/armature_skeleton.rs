//! An armature as a skeleton, so that the optimiser can pose characters from files of animation.

use std::collections::BTreeSet;

use glam::{DAffine3, DMat3, DQuat};

use super::pose_angles::has_bones;
use super::stance::Stances;
use crate::SizeMismatch;
use crate::animation::{Armature, Mirror, Pose};
use crate::model::Limits;
use crate::skeleton::{ANGLES_PER_BONE, Bone, BoneId, Skeleton, SkeletonError};
use crate::spatial::{Matrix3, Placement, Vector3};

impl Skeleton {
    /// The same skeleton with its joints and tips where a pose of its armature has them, by the pose's own translations and
    /// scales. The angles keep their meaning and the rest pose its placements.
    ///
    /// # Errors
    /// The pose has fewer bones.
    pub fn standing_in(&self, pose: &Pose) -> Result<Self, SizeMismatch> {
        has_bones(pose, self.bones().len())?;
        let bones: Vec<BoneId> = self.bone_ids().collect();
        let mut stances = Stances::new(self, &bones);
        Ok(stances.take(pose, &bones).clone())
    }
}

impl Armature {
    /// The skeleton with the same bones and ids, at rest where the armature is: what
    /// [`ReachLayer`](super::ReachLayer) and problems are stated on, while
    /// [`EulerPoseMap`](super::EulerPoseMap) takes its angles to this armature's poses. An armature does
    /// not say where bones end, so tips are where their bones stand: the tip of a hand is the wrist.
    /// `limits` gives the ranges of a bone's first twist, bend and second twist about the bone's own
    /// x, z and x, in radians.
    ///
    /// Scales of the rest pose are part of the bones' lengths: every joint is where the rest pose has it in the model. The
    /// axes of a bone are the product of the rotations down to it. Below a mirrored bone those are reflected, so that the
    /// skeleton turns as the mirrored armature does. Below an [unevenly scaled](Self::scale_notes) bone the armature shears
    /// and the skeleton does not: their joints part as bones turn. [`ReachLayer`](super::ReachLayer) and
    /// [`ClipIk`](crate::motion::clip_ik::ClipIk) solve for the joints of the armature, and a
    /// [`Drag`](crate::ik::Drag) does whose joints [`move`](crate::ik::Drag::move_joints) after each frame.
    ///
    /// # Errors
    /// A [`SkeletonError`] naming the bone whose limits are no interval.
    pub fn skeleton(
        &self,
        name: impl Into<String>,
        limits: impl Fn(BoneId) -> [Limits; ANGLES_PER_BONE],
    ) -> Result<Skeleton, SkeletonError> {
        let mut placed: Vec<(DAffine3, DQuat, Mirror)> = Vec::with_capacity(self.bones());
        let mut bones = Vec::with_capacity(self.bones());
        for (index, name) in self.names().iter().enumerate() {
            let bone = BoneId::new(index);
            let local = self.rest().local_of(bone);
            let parent = self.parent(bone);
            let (above, turned, mirror) = parent
                .and_then(|parent| placed.get(parent.index()).copied())
                .unwrap_or((DAffine3::IDENTITY, DQuat::IDENTITY, Mirror::NONE));
            let own = local.rotation.as_dquat().normalize();
            let model_from_bone = above
                * DAffine3::from_scale_rotation_translation(
                    local.scale.as_dvec3(),
                    own,
                    local.translation.as_dvec3(),
                );
            let rotation = (turned * mirror.rotation(own)).normalize();
            placed.push((model_from_bone, rotation, mirror.below(local.scale)));
            let columns = DMat3::from_quat(rotation)
                .to_cols_array_2d()
                .map(Vector3::from);
            let origin = model_from_bone.translation.to_array();
            bones.push(Bone {
                name: name.clone(),
                parent,
                length: 0.0,
                model_from_rest: Placement::new(
                    Matrix3::from_columns(columns[0], columns[1], columns[2]),
                    Vector3::from(origin),
                ),
                limits: limits(bone),
            });
        }
        Skeleton::new(name, bones)
    }

    /// As [`skeleton`](Self::skeleton), the bones of `turning` free to turn any way and the others still: of a scene those of
    /// [its skins](crate::io::gltf::Scene::turning_bones), of a capture those
    /// [with channels](crate::io::bvh::MotionCapture::turning_bones).
    ///
    /// # Errors
    /// As there.
    pub fn turning_skeleton(
        &self,
        name: impl Into<String>,
        turning: &BTreeSet<BoneId>,
    ) -> Result<Skeleton, SkeletonError> {
        self.skeleton(name, |bone| match turning.contains(&bone) {
            true => [Limits::UNBOUNDED; ANGLES_PER_BONE],
            false => [Limits::new(0.0, 0.0); ANGLES_PER_BONE],
        })
    }
}
