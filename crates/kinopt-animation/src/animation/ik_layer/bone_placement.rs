//! Placements of single bones of a pose.

use glam::{Affine3A, Quat};

use crate::animation::pose::Stretch;
use crate::animation::{Armature, Mirror, Pose};
use kinopt_kinematics::skeleton::BoneId;

/// Placement of a bone in the model or in an ancestor.
#[derive(Clone, Copy)]
pub(super) struct BonePlacement {
    pub(super) affine: Affine3A,
    /// Rotation without scales; in reflected axes below mirrored bones.
    pub(super) rotation: Quat,
    /// Mirror of the bone's children.
    pub(super) mirror: Mirror,
    /// True if the bone or an ancestor has an uneven scale.
    pub(super) uneven: bool,
}

impl BonePlacement {
    /// Placement of a bone in its parent.
    pub(super) fn local(pose: &Pose, bone: BoneId) -> Self {
        let local = pose.local_of(bone);
        Self {
            affine: local.to_affine(),
            rotation: local.rotation,
            mirror: Mirror::NONE.below(local.scale),
            uneven: !Stretch::is_even_scale(local.scale),
        }
    }

    /// Placement of a bone in the coordinates of an ancestor, or in the model without one.
    pub(super) fn within(
        armature: &Armature,
        pose: &Pose,
        bone: Option<BoneId>,
        ancestor: Option<BoneId>,
    ) -> Self {
        let identity = Self {
            affine: Affine3A::IDENTITY,
            rotation: Quat::IDENTITY,
            mirror: Mirror::NONE,
            uneven: false,
        };
        let below = armature
            .bone_and_ancestors(bone)
            .take_while(|bone| Some(*bone) != ancestor);
        below.fold(identity, |product, bone| Self::local(pose, bone) * product)
    }
}

impl std::ops::Mul for BonePlacement {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            affine: self.affine * other.affine,
            rotation: self.rotation * self.mirror.single(other.rotation),
            mirror: self.mirror.and(other.mirror),
            uneven: self.uneven || other.uneven,
        }
    }
}

/// Writes the normalised local rotation of a bone.
pub(super) fn set_rotation(pose: &mut Pose, bone: BoneId, rotation: Quat) {
    if let Some(local) = pose.rotations.get_mut(bone.index()) {
        *local = rotation.normalize();
    }
}
