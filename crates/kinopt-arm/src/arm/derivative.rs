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

impl Arm {
    /// Derivative of the solution `q` with respect to its target, which may be unreached.
    ///
    /// For a redundant arm it is the [shortest](Differentiability::ShortestOfMany) of many. A joint held by a limit stays
    /// there.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// # use kinopt::arm::Arm;
    /// # use kinopt::robot::Robot;
    /// let robot = Robot::read("models/universal_ur5e.urdf")?;
    /// let arm = Arm::builder(&robot, "base", "flange").build()?;
    /// let target = arm.base_from_tool(&[0.4, -1.2, 1.1, -0.8, 1.2, 0.5])?;
    /// let solution = arm.solve(target, &[0.3, -1.1, 1.0, -0.9, 1.1, 0.4])?;
    /// let derivative = arm.derivative(target, &solution.q)?;
    /// assert!(derivative.differentiability.is_unique());
    /// assert_eq!(derivative.by_target.shape(), (6, 6));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error for a configuration of the wrong length or not finite, or a target that is not a rigid motion.
    pub fn derivative(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
        q: &[f64],
    ) -> Result<ArmDerivative, QueryError> {
        let target = base_from_tool.into();
        self.check_length("q", q.len(), self.joint_count())?;
        self.check_query(0, &target, q)?;
        self.with_workspace(|workspace| {
            let (map, question) = (&self.serial.map, &mut workspace.question);
            map.scatter(q, &mut workspace.q);
            question.set_target(&target);
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
