//! What the end of a limb should do.

use glam::{Quat, Vec3A};

/// What the end of a limb should do this frame.
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
    /// Where the end should be, in model coordinates.
    pub target: Vec3A,
    /// The point towards which the elbow or knee goes, in model coordinates; `None` keeps the side
    /// that the pose has.
    pub pole: Option<Vec3A>,
    /// How far the limb turns about the way from its root to the target besides, in radians,
    /// counter-clockwise as seen from the target. A number that is not finite counts as 0.
    pub twist: f32,
    /// From 0, the pose as it is, to 1, the end at the target: the end goes this share of the way.
    /// Taken into [0, 1]; NaN counts as 0.
    pub weight: f32,
    /// How the bone at the end is turned, for a limb [to a bone](super::Limb::to_bone); a limb that
    /// ends in a point has none to turn.
    pub end: EndRotation,
}

/// How the bone at the end of a limb is turned: the hand, the foot. Weights go from 0, as the lower
/// bone takes it along, to 1, the rotation named, by the shortest arc; they are taken into [0, 1], NaN
/// counts as 0, and they are apart from the weight of the position.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum EndRotation {
    /// The lower bone takes it along.
    #[default]
    Follow,
    /// As it was in the model before the limb moved.
    Hold {
        /// How much.
        weight: f32,
    },
    /// As asked.
    Goal {
        /// In model coordinates, of any length; one that is not finite or zero changes nothing.
        rotation: Quat,
        /// How much.
        weight: f32,
    },
}

impl LimbGoal {
    /// The end at a point in model coordinates, with weight 1, and nothing else asked.
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
