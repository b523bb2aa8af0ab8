//! Joint limit avoidance.

use super::{Description, Inputs, LocalJacobian, Quantity, Residual, Role, RowBlock};
use kinopt_kinematics::model::{JointId, Model};
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::Placement;

/// r_j = (q_j − middle_j) / half range_j: 0 at the middle of the range, ±1 at a limit.
///
/// One row for each joint with two finite limits. A soft task by default. Source: Liégeois 1977, "Automatic supervisory
/// control of the configuration and behavior of multibody mechanisms".
#[derive(Clone, Debug, PartialEq)]
pub struct LimitCentring {
    joints: Vec<JointId>,
    middle_and_half_range: Vec<(f64, f64)>,
}

impl LimitCentring {
    /// A task for every moving joint of `model` with a finite range above zero.
    #[must_use]
    pub fn new(model: &Model) -> Self {
        let (joints, middle_and_half_range) = model
            .moving_joints()
            .iter()
            .zip(model.limits())
            // A ball joint's components have no range.
            .filter(|(_, limits)| {
                let range = limits.upper - limits.lower;
                range.is_finite() && range > 0.0
            })
            .map(|(&joint, limits)| {
                let half_range = (limits.upper - limits.lower) / 2.0;
                (joint, (limits.lower + half_range, half_range))
            })
            .unzip();
        Self {
            joints,
            middle_and_half_range,
        }
    }
}

impl Residual for LimitCentring {
    const ROLE: Role = Role::Preference;

    fn inputs(&self) -> Inputs {
        Inputs::joints(self.joints.clone())
    }

    fn rows(&self) -> Vec<RowBlock> {
        vec![RowBlock::new(Quantity::Ratio, self.joints.len())]
    }

    fn evaluate<S: Scalar>(&self, _frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        let ranges = &self.middle_and_half_range;
        for ((row, &value), &(middle, half_range)) in residual.iter_mut().zip(joints).zip(ranges) {
            *row = (value - S::constant(middle)) * S::constant(1.0 / half_range);
        }
    }

    fn differentiate(&self, _: &[Placement<f64>], _: &[f64], jacobian: &mut LocalJacobian) -> bool {
        jacobian.set_diagonal(
            self.middle_and_half_range
                .iter()
                .map(|(_, half_range)| 1.0 / half_range),
        );
        true
    }

    fn description(&self) -> Description {
        Description::new("limit centring")
    }
}
