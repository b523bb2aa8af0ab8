//! How a solution moves with its target.

use nalgebra::DMatrix;

use super::QueryError;
use super::arm::Arm;
use crate::ik::{Existence, SolutionDerivative};
use crate::spatial::Placement;

/// The derivative of an arm's solution by its target.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ArmDerivative {
    /// A row for each free joint (radians or metres), base to tip, and six columns: for moving the target along
    /// (metres) and turning it about (radians) its own axes.
    pub by_target: DMatrix<f64>,
    /// Whether it exists: look here before it is trusted.
    pub existence: Existence,
}

impl Arm {
    /// The derivative by its target of the solution `q` that the arm has for it, reached or not.
    ///
    /// Where the arm has more joints than the goal asks for, it is the
    /// [shortest](Existence::ShortestOfMany) of many. A joint on a limit that holds it stays there.
    ///
    /// ```
    /// # use kinopt::arm::Arm;
    /// # use kinopt::robot::Robot;
    /// let robot = Robot::read("models/universal_ur5e.urdf")?;
    /// let arm = Arm::builder(&robot, "base", "flange").build()?;
    /// let target = arm.base_from_tool(&[0.4, -1.2, 1.1, -0.8, 1.2, 0.5])?;
    /// let solution = arm.solve(target, &[0.3, -1.1, 1.0, -0.9, 1.1, 0.4])?;
    /// let derivative = arm.derivative(target, &solution.q)?;
    /// assert!(derivative.existence.is_unique());
    /// assert_eq!(derivative.by_target.shape(), (6, 6));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// A configuration of the wrong length or not finite; a target that is not a rigid motion.
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
            question.aim(&target);
            let memory = &mut workspace.derivative;
            let derivative = SolutionDerivative::new(question.ask(), &workspace.q, memory);
            let joints = q.len();
            // What could be wrong with it was looked at.
            let Ok(mut derivative) = derivative else {
                return ArmDerivative::nowhere(joints);
            };
            let existence = derivative.existence().clone();
            let Ok(all) = derivative.by_target(0) else {
                return ArmDerivative::nowhere(joints);
            };
            // No ball is on the way, so that velocities are coordinates' rates.
            ArmDerivative {
                by_target: all.select_rows(map.leaders()),
                existence,
            }
        })
    }
}

impl ArmDerivative {
    fn nowhere(joints: usize) -> Self {
        Self {
            by_target: DMatrix::zeros(joints, 6),
            existence: Existence::DoesNotExist(crate::ik::NoDerivative::NotFinite),
        }
    }
}
