//! Weights and dead bands of the six components of a pose.

use kinopt_kinematics::bad_option::{BadOption, NOT_NEGATIVE};
use kinopt_solver::task::PoseBounds;

/// Weights and dead bands of a pose's components, in the target's axes.
///
/// Position component k is the tip's offset along axis k of the target frame, in metres. Orientation component k is
/// that of 2 sin(θ/2) n, for the rotation by θ about n from the target's orientation to the tip's. For small errors it
/// is the angle about axis k, in radians.
///
/// A weight of zero frees the component: with orientation weights `[1, 1, 0]` a tool may rotate about its z axis. A
/// half width is the largest error of a component at no cost.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AxisGoal {
    /// Weights of the position's components; zero frees a component.
    pub position_weights: [f64; 3],
    /// Weights of the orientation's components; zero frees a component.
    pub orientation_weights: [f64; 3],
    /// Half widths of the position's dead bands, metres.
    pub position_half_widths: [f64; 3],
    /// Half widths of the orientation's dead bands, radians.
    pub orientation_half_widths: [f64; 3],
}

impl From<PoseBounds> for AxisGoal {
    /// Free components have weight 0, all others 1.
    fn from(goal: PoseBounds) -> Self {
        let [px, py, pz, rx, ry, rz] = goal.bands();
        let weights =
            |bands: [f64; 3]| bands.map(|band| f64::from(u8::from(band != f64::INFINITY)));
        let widths = |bands: [f64; 3]| bands.map(|band| if band.is_finite() { band } else { 0.0 });
        let (position, turn) = ([px, py, pz], [rx, ry, rz]);
        Self {
            position_weights: weights(position),
            orientation_weights: weights(turn),
            position_half_widths: widths(position),
            orientation_half_widths: widths(turn),
        }
    }
}

impl AxisGoal {
    /// The full pose: every component has weight 1 and no dead band.
    #[must_use]
    pub fn full_pose() -> Self {
        Self {
            position_weights: [1.0; 3],
            orientation_weights: [1.0; 3],
            position_half_widths: [0.0; 3],
            orientation_half_widths: [0.0; 3],
        }
    }

    /// Position only.
    #[must_use]
    pub fn position_only() -> Self {
        Self {
            orientation_weights: [0.0; 3],
            ..Self::full_pose()
        }
    }

    /// Returns true for the full pose, which has a faster kernel.
    #[must_use]
    pub fn is_full_pose(&self) -> bool {
        *self == Self::full_pose()
    }

    /// Checks that all numbers are finite and not negative.
    pub(crate) fn check(&self) -> Result<(), BadOption> {
        let numbers = [
            self.position_weights,
            self.orientation_weights,
            self.position_half_widths,
            self.orientation_half_widths,
        ];
        let mut numbers = numbers.into_iter().flatten();
        numbers.try_for_each(|number| BadOption::check("axes", number, NOT_NEGATIVE))
    }
}
