//! Where a pose's own translations and scales put the joints of a skeleton.

use glam::{DQuat, DVec3};

use super::reach_error::ReachError;
use crate::animation::Pose;
use crate::animation::pose::scales_evenly;
use crate::skeleton::{BoneId, Skeleton};

/// A bone in the model, as a pose has it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stance {
    pub(super) rotation: DQuat,
    pub(super) tail: DVec3,
    pub(super) tip: DVec3,
    /// The product of its scale and those above it.
    scale: f64,
}

/// The stances of bones, and the skeleton whose joints stand as the pose has them.
#[derive(Clone, Debug)]
pub(super) struct Stances {
    skeleton: Skeleton,
    /// By bone; only those asked for are kept up.
    stances: Vec<Stance>,
    /// Whether another one asked for hangs on a bone.
    carries: Vec<bool>,
}

impl Stances {
    /// For some bones of a skeleton, with all that they hang on.
    pub(super) fn new(skeleton: &Skeleton, bones: &[BoneId]) -> Self {
        let nowhere = Stance {
            rotation: DQuat::IDENTITY,
            tail: DVec3::ZERO,
            tip: DVec3::ZERO,
            scale: 1.0,
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

    /// The skeleton with the joints of these bones where the pose has them. A joint stands on its
    /// parent by s t, with t its own translation and s the product of the scales above it; a tip of
    /// length ℓ by s ℓ, with the bone's own scale in s.
    ///
    /// # Errors
    /// A bone whose scale would shear what hangs on it.
    pub(super) fn take(&mut self, pose: &Pose, bones: &[BoneId]) -> Result<&Skeleton, ReachError> {
        for &bone in bones {
            let index = bone.index();
            let Some(own) = self.skeleton.bones().get(index) else {
                continue;
            };
            let (length, parent) = (own.length, own.parent);
            let local = pose.local_of(bone);
            let even = scales_evenly(local.scale);
            if self.carries.get(index).is_some_and(|carries| *carries) && !even {
                let bone = own.name.clone();
                return Err(ReachError::Sheared { bone });
            }
            let above = parent.and_then(|parent| self.stances.get(parent.index()).copied());
            let size = above.map_or(1.0, |above| above.scale);
            let offset = local.translation.as_dvec3() * size;
            let turn = local.rotation.as_dquat().normalize();
            let rotation = above.map_or(turn, |above| (above.rotation * turn).normalize());
            let tail = above.map_or(offset, |above| above.tail + above.rotation * offset);
            // Along x is all that a tip needs of a scale that is not even.
            let scale = size * f64::from(local.scale.x);
            let along = DVec3::new(scale * length, 0.0, 0.0);
            if let Some(stance) = self.stances.get_mut(index) {
                *stance = Stance {
                    rotation,
                    tail,
                    tip: tail + rotation * along,
                    scale,
                };
            }
            self.skeleton
                .stand(bone, offset.to_array().into(), along.to_array().into());
        }
        Ok(&self.skeleton)
    }

    /// A bone's stance as of the last pose; `None` for a bone of another skeleton.
    pub(super) fn of(&self, bone: BoneId) -> Option<&Stance> {
        self.stances.get(bone.index())
    }

    pub(super) fn skeleton(&self) -> &Skeleton {
        &self.skeleton
    }
}
