//! The truth about a configuration, as the core's solution.

use super::query::Arm;
use super::workspace::{Errors, Workspace};
use crate::ik::{RowsReport, Solution};
use crate::lanes::Outcome;
use crate::scalar::elementary;
use crate::solver::{Counts, Termination};
use crate::task::Quantity;

/// How a question was answered.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reply {
    pub(super) errors: Errors,
    pub(super) termination: Termination,
    pub(super) iterations: usize,
    pub(super) attempts: usize,
    /// The attempt whose way led to a target that is reached.
    pub(super) winner: Option<u32>,
}

impl Reply {
    pub(super) fn of(outcome: &Outcome) -> Self {
        Self {
            errors: Errors {
                position: outcome.position_error,
                orientation: outcome.orientation_error,
                reached: outcome.reached,
            },
            termination: if outcome.reached {
                Termination::Reached
            } else {
                Termination::Stalled
            },
            iterations: outcome.iterations as usize,
            attempts: outcome.attempts as usize,
            winner: outcome.winner,
        }
    }
}

impl Arm {
    /// Fills everything but `q` and the limits in.
    pub(super) fn report(&self, reply: &Reply, solution: &mut Solution) {
        let Errors {
            position,
            orientation,
            reached: _,
        } = reply.errors;
        let options = &self.options;
        let metres = RowsReport::of_goal(Quantity::Metres, position, options.position_tolerance);
        let turned = options.orientation_tolerance;
        let radians = RowsReport::of_goal(Quantity::Radians, orientation, turned);
        let metres = options.goal.has_position().then_some(metres);
        let radians = options.goal.has_orientation().then_some(radians);
        solution.tell_errors(&self.names, metres.into_iter().chain(radians));
        solution.agreeing = 0;
        solution.termination = reply.termination;
        solution.cost = self.cost(position, orientation);
        solution.projected_gradient = None;
        solution.iterations = reply.iterations;
        solution.attempts = reply.attempts;
        solution.counts = Counts {
            residuals: reply.iterations,
            jacobians: reply.iterations,
            gradients: 0,
        };
    }

    /// Half the squared errors, a radian weighing as much as so many metres.
    pub(super) fn cost(&self, position: f64, orientation: f64) -> f64 {
        // Goals that leave room are solved in chords.
        let turned = match self.options.goal.is_full_pose() {
            true => orientation,
            false => 2.0 * elementary::sin(0.5 * orientation),
        };
        let turned = turned * self.options.metres_per_radian;
        0.5 * (position * position + turned * turned)
    }

    /// Fills everything in from the workspace's configuration, naming the limits that block it.
    pub(super) fn report_workspace(
        &self,
        reply: &Reply,
        workspace: &mut Workspace,
        solution: &mut Solution,
    ) {
        solution.q.clear();
        solution.q.extend_from_slice(&workspace.x);
        self.report(reply, solution);
        if !solution.reached {
            let negligible = workspace.take_slope();
            let (x, gradient) = (&workspace.x, &workspace.gradient);
            solution.tell_limits(workspace.question.ask(), x, gradient, negligible);
            solution.projected_gradient = Some(workspace.projected_gradient(x));
            if self.options.goal.is_exact_in_position() {
                let (place, tolerance) = (workspace.target(), self.options.position_tolerance);
                solution.find_place_beyond(
                    &workspace.question.problem,
                    place.translation,
                    tolerance,
                );
            }
        }
    }
}
