//! Joint positions of a skeleton from a pose's translations and scales.

use glam::{DQuat, DVec3};

use crate::animation::Pose;
use crate::animation::pose::{Mirror, Stretch};
use crate::skeleton::{BoneId, Skeleton};

/// Bone of a pose in the model.
#[derive(Clone, Copy, Debug)]
pub(super) struct FootPlant {
    pub(super) rotation: DQuat,
    pub(super) tail: DVec3,
    pub(super) tip: DVec3,
    stretch: Stretch,
    /// Mirror of the bone's children.
    mirror: Mirror,
}

/// Placements of bones, and the skeleton with joints at their positions in the pose.
#[derive(Clone, Debug)]
pub(super) struct Stances {
    skeleton: Skeleton,
    /// Placements by bone; only requested bones are updated.
    stances: Vec<FootPlant>,
    /// True for bones with a requested descendant.
    carries: Vec<bool>,
}

impl Stances {
    /// Placements of some bones of a skeleton and their ancestors.
    pub(super) fn new(skeleton: &Skeleton, bones: &[BoneId]) -> Self {
        let nowhere = FootPlant {
            rotation: DQuat::IDENTITY,
            tail: DVec3::ZERO,
            tip: DVec3::ZERO,
            stretch: Stretch::NONE,
            mirror: Mirror::NONE,
        };
        let mut carries = vec![false; skeleton.bones().len()];
        for bone in bones {
            let parent = skeleton.bones().get(bone.index()).and_then(|b| b.parent);
            if let Some(carries) = parent.and_then(|parent| carries.get_mut(parent.index())) {
                *carries = true;
            }
        }
        Self {
            skeleton: skeleton.clone(),
            stances: vec![nowhere; skeleton.bones().len()],
            carries,
        }
    }

    /// The skeleton with the joints of these bones at their positions in the pose.
    ///
    /// A joint is at M t on its parent, with its own translation t and the parent's [`Stretch`] M. The tip of a bone of
    /// length ℓ is at M (ℓ, 0, 0), with M of the bone itself.
    pub(super) fn take(&mut self, pose: &Pose, bones: &[BoneId]) -> &Skeleton {
        for &bone in bones {
            let index = bone.index();
            let Some(own) = self.skeleton.bones().get(index) else {
                continue;
            };
            let (length, parent) = (own.length, own.parent);
            let local = pose.local_of(bone);
            let above = parent.and_then(|parent| self.stances.get(parent.index()).copied());
            let (stretch, mirror) = above.map_or((Stretch::NONE, Mirror::NONE), |above| {
                (above.stretch, above.mirror)
            });
            let offset = stretch.apply(local.translation.as_dvec3());
            let own = local.rotation.as_dquat().normalize();
            let turn = mirror.rotation(own);
            let rotation = above.map_or(turn, |above| (above.rotation * turn).normalize());
            let tail = above.map_or(offset, |above| above.tail + above.rotation * offset);
            let stretch = stretch.below(mirror, own, local.scale);
            let along = stretch.apply(DVec3::new(length, 0.0, 0.0));
            if let Some(stance) = self.stances.get_mut(index) {
                *stance = FootPlant {
                    rotation,
                    tail,
                    tip: tail + rotation * along,
                    stretch,
                    mirror: mirror.below(local.scale),
                };
            }
            self.skeleton
                .stand(bone, offset.to_array().into(), along.to_array().into());
        }
        &self.skeleton
    }

    /// Returns true if a bone of the last pose shears its requested descendants when they rotate.
    pub(super) fn shear(&self) -> bool {
        let mut carriers = self.stances.iter().zip(&self.carries);
        carriers.any(|(stance, carries)| *carries && !stance.stretch.is_even())
    }

    /// Placement of a bone in the last pose; `None` for a bone of another skeleton.
    pub(super) fn of(&self, bone: BoneId) -> Option<&FootPlant> {
        self.stances.get(bone.index())
    }

    pub(super) fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }
}
