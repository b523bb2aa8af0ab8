//! Loop closure in `kinopt fk`: passive joints follow from the given ones.

use kinopt::ik::{LoopClosure, LoopGap};
use kinopt::model::JointId;
use kinopt::problem::ProblemError;
use serde::Serialize;

use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::output;

/// Closure error of a loop.
#[derive(Serialize)]
pub(crate) struct LoopDocument {
    pub(crate) name: String,
    /// Distance in metres.
    pub(crate) gap: f64,
    /// Angle in radians.
    pub(crate) angle: f64,
    pub(crate) closed: bool,
}

impl From<&LoopGap> for LoopDocument {
    fn from(gap: &LoopGap) -> Self {
        Self {
            name: gap.name.clone(),
            gap: gap.gap,
            angle: gap.angle,
            closed: gap.is_closed(),
        }
    }
}

impl LoadedModel {
    /// Moves a robot's passive joints so that its loops close. Returns the closure errors.
    ///
    /// Without passive joints the configuration stays as given.
    ///
    /// # Errors
    /// Loops that the passive joints cannot close with the other joints at their values.
    pub(crate) fn close_loops(&self, q: &mut [f64]) -> Outcome<Vec<LoopDocument>> {
        let Some(robot) = self
            .robot
            .as_ref()
            .filter(|_| !self.model.loops().is_empty())
        else {
            return Ok(Vec::new());
        };
        let with_file = |error: ProblemError| failure!("{}: {error}", self.file);
        let closure = match robot.loop_closure() {
            Err(ProblemError::NoPassiveJoints { .. }) => {
                let moves = |id: &JointId| self.model.moves_a_loop(*id);
                let joints: Vec<JointId> = self.model.joint_ids().filter(moves).collect();
                LoopClosure::new(robot.parameters(), &joints).map_err(with_file)?
            }
            closure => {
                let closure = closure.map_err(with_file)?;
                closure.close(q).map_err(with_file)?;
                closure
            }
        };
        let gaps = closure.gaps(q).map_err(with_file)?;
        let open = gaps.iter().filter(|gap| !gap.is_closed());
        for gap in open {
            output::message(&format!(
                "note: {}: {gap} at the given values; --passive names joints that close it",
                self.file
            ));
        }
        Ok(gaps.iter().map(LoopDocument::from).collect())
    }
}
