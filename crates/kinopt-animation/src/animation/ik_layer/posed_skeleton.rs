//! Joint positions of a skeleton from a pose's translations and scales.

use glam::{DQuat, DVec3};

use crate::animation::Pose;
use crate::animation::pose::{Mirror, Stretch};
use kinopt_kinematics::skeleton::{BoneId, Skeleton};

/// Bone of a pose in the model.
#[derive(Clone, Copy, Debug)]
pub(super) struct PosedBone {
    pub(super) rotation: DQuat,
    pub(super) tail: DVec3,
    pub(super) tip: DVec3,
    stretch: Stretch,
    /// Mirror of the bone's children.
    mirror: Mirror,
}

/// Placements of bones, and the skeleton with joints at their positions in the pose.
#[derive(Clone, Debug)]
pub(super) struct PosedSkeleton {
    skeleton: Skeleton,
    /// Placements by bone; only requested bones are updated.
    bones: Vec<PosedBone>,
    /// True for bones with a requested descendant.
    is_ancestor: Vec<bool>,
}

impl PosedSkeleton {
    /// Placements of some bones of a skeleton and their ancestors.
    pub(super) fn new(skeleton: &Skeleton, bones: &[BoneId]) -> Self {
        let identity = PosedBone {
            rotation: DQuat::IDENTITY,
            tail: DVec3::ZERO,
            tip: DVec3::ZERO,
            stretch: Stretch::NONE,
            mirror: Mirror::NONE,
        };
        let mut is_ancestor = vec![false; skeleton.bones().len()];
        for bone in bones {
            let parent = skeleton.bones().get(bone.index()).and_then(|b| b.parent);
            if let Some(is_ancestor) = parent.and_then(|parent| is_ancestor.get_mut(parent.index()))
            {
                *is_ancestor = true;
            }
        }
        Self {
            skeleton: skeleton.clone(),
            bones: vec![identity; skeleton.bones().len()],
            is_ancestor,
        }
    }

    /// The skeleton with the joints of these bones at their positions in the pose.
    ///
    /// A joint is at M t on its parent, with its own translation t and the parent's [`Stretch`] M. The tip of a bone of
    /// length ℓ is at M (ℓ, 0, 0), with M of the bone itself.
    pub(super) fn update(&mut self, pose: &Pose, bones: &[BoneId]) -> &Skeleton {
        for &bone in bones {
            let index = bone.index();
            let Some(rest_bone) = self.skeleton.bones().get(index) else {
                continue;
            };
            let (length, parent) = (rest_bone.length, rest_bone.parent);
            let local = pose.local_of(bone);
            let parent_bone = parent.and_then(|parent| self.bones.get(parent.index()).copied());
            let (stretch, mirror) = parent_bone
                .map_or((Stretch::NONE, Mirror::NONE), |parent_bone| {
                    (parent_bone.stretch, parent_bone.mirror)
                });
            let offset = stretch.apply(local.translation.as_dvec3());
            let local_rotation = local.rotation.as_dquat().normalize();
            let mirrored_rotation = mirror.rotation(local_rotation);
            let rotation = parent_bone.map_or(mirrored_rotation, |parent_bone| {
                (parent_bone.rotation * mirrored_rotation).normalize()
            });
            let tail = parent_bone.map_or(offset, |parent_bone| {
                parent_bone.tail + parent_bone.rotation * offset
            });
            let stretch = stretch.below(mirror, local_rotation, local.scale);
            let along = stretch.apply(DVec3::new(length, 0.0, 0.0));
            if let Some(posed) = self.bones.get_mut(index) {
                *posed = PosedBone {
                    rotation,
                    tail,
                    tip: tail + rotation * along,
                    stretch,
                    mirror: mirror.below(local.scale),
                };
            }
            self.skeleton
                .move_bone(bone, offset.to_array().into(), along.to_array().into());
        }
        &self.skeleton
    }

    /// Returns true if a bone of the last pose shears its requested descendants when they rotate.
    pub(super) fn has_shear(&self) -> bool {
        let mut ancestors = self.bones.iter().zip(&self.is_ancestor);
        ancestors.any(|(bone, is_ancestor)| *is_ancestor && !bone.stretch.is_even())
    }

    /// Placement of a bone in the last pose; `None` for a bone of another skeleton.
    pub(super) fn bone(&self, bone: BoneId) -> Option<&PosedBone> {
        self.bones.get(bone.index())
    }

    pub(super) fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }
}
