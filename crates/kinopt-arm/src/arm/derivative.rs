//! Derivative of an arm's solution with respect to its target.

use nalgebra::DMatrix;

use super::QueryError;
use super::arm::Arm;
use kinopt_kinematics::spatial::Placement;
use kinopt_solver::ik::{Differentiability, SolutionDerivative};

/// Derivative of an arm's solution with respect to its target.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ArmDerivative {
    /// One row per free joint (radians or metres), base to tip, and six columns.
    ///
    /// The columns are translations along (metres) and rotations about (radians) the target's own axes.
    pub by_target: DMatrix<f64>,
    /// Differentiability of the derivative: check it before using `by_target`.
    pub differentiability: Differentiability,
}

impl ArmDerivative {
    fn nonexistent(joints: usize) -> Self {
        Self {
            by_target: DMatrix::zeros(joints, 6),
            differentiability: Differentiability::DoesNotExist(
                kinopt_solver::ik::NoDerivative::NotFinite,
            ),
        }
    }
}

/// Derivative of the solution `q` with respect to its target, both validated.
pub(super) fn derivative(
    arm: &Arm,
    target: &Placement<f64>,
    q: &[f64],
) -> Result<ArmDerivative, QueryError> {
    arm.with_workspace(|workspace| {
        let (map, question) = (&arm.serial.map, &mut workspace.question);
        map.scatter(q, &mut workspace.q);
        question.set_target(target);
        let buffers = &mut workspace.derivative;
        let derivative = SolutionDerivative::new(question.instance(), &workspace.q, buffers);
        let joints = q.len();
        // The input was checked above.
        let Ok(mut derivative) = derivative else {
            return ArmDerivative::nonexistent(joints);
        };
        let differentiability = derivative.differentiability().clone();
        let Ok(all_coordinates) = derivative.by_target(0) else {
            return ArmDerivative::nonexistent(joints);
        };
        // The chain has no ball joint, so velocities are rates of coordinates.
        ArmDerivative {
            by_target: all_coordinates.select_rows(map.leaders()),
            differentiability,
        }
    })
}
