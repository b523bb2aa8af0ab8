//! Closure of a robot's loops by its passive joints.

use super::Robot;
use kinopt_kinematics::model::JointId;
use kinopt_solver::ik::LoopClosure;
use kinopt_solver::problem::ProblemError;

impl Robot {
    /// Creates the closure of the robot's loops by those of its [passive joints](Self::passive_joints) that move a loop.
    ///
    /// # Errors
    /// Returns an error if the robot has loops but no passive joints that move them.
    pub fn loop_closure(&self) -> Result<LoopClosure<'_>, ProblemError> {
        let model = self.model();
        let passive = self.passive_joints().iter().copied();
        let dependent: Vec<JointId> = passive.filter(|id| model.moves_a_loop(*id)).collect();
        LoopClosure::new(self.parameters(), &dependent)
    }
}
