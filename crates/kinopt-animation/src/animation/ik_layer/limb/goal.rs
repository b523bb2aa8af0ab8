//! Goals of limbs.

use glam::{Quat, Vec3A};

/// Goal of a limb's end for one frame.
///
/// ```
/// # use glam::Vec3A;
/// # use kinopt::animation::{EndRotation, LimbGoal};
/// // A foot on a step that stays as flat as the clip has it.
/// let step = LimbGoal {
///     end: EndRotation::Hold { weight: 1.0 },
///     ..LimbGoal::at(Vec3A::new(0.1, 0.3, 0.2))
/// };
/// assert_eq!((step.weight, step.pole), (1.0, None));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimbGoal {
    /// Target of the end, in model coordinates.
    pub target: Vec3A,
    /// Pole: point towards which the elbow or knee bends, in model coordinates. `None` keeps the bend direction of the
    /// pose.
    pub pole: Option<Vec3A>,
    /// Additional rotation about the line from root to target, radians, counter-clockwise as seen from the target. A
    /// number that is not finite counts as 0.
    pub twist: f32,
    /// Fraction of the motion to the target: 0 leaves the pose, 1 puts the end at the target. Clamped to [0, 1]; NaN
    /// counts as 0.
    pub weight: f32,
    /// Rotation of the end bone of a limb [to a bone](super::Limb::to_bone); ignored for a limb that ends in a point.
    pub end: EndRotation,
}

/// Rotation of the bone at the end of a limb: hand or foot. Weight 0 moves it with the lower bone, weight 1 gives the
/// specified rotation, by the shortest arc. Weights are clamped to [0, 1], NaN counts as 0, and they are independent of
/// the position weight.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum EndRotation {
    /// Moves with the lower bone.
    #[default]
    Follow,
    /// Keeps the rotation in the model from before the solve.
    Hold {
        /// Weight within [0, 1].
        weight: f32,
    },
    /// Takes a given rotation.
    Goal {
        /// Rotation in model coordinates, of any length; ignored if zero or not finite.
        rotation: Quat,
        /// Weight within [0, 1].
        weight: f32,
    },
}

impl LimbGoal {
    /// Goal at a point in model coordinates, with weight 1 and defaults otherwise.
    #[must_use]
    pub fn at(target: impl Into<Vec3A>) -> Self {
        let target = target.into();
        Self {
            target,
            pole: None,
            twist: 0.0,
            weight: 1.0,
            end: EndRotation::Follow,
        }
    }
}
