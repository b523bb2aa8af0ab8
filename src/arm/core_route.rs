//! The way of chains that the lane engine cannot express: the core's solver on the same problem.

use std::f64::consts::TAU;
use std::time::Instant;

use super::query::Arm;
use super::report::Reply;
use super::workspace::Workspace;
use crate::ik::Restarts;
use crate::lanes::{Outcome, reduced};
use crate::model::JointKind;
use crate::random::RandomStream;
use crate::solver::{Stopping, Termination};

/// Attempts that stop at the same miss before a target counts as out of reach, where no number of
/// attempts is asked for: after six, five
/// reachable poses in 4 000 of two chains with followers were missed, after ten none.
const AGREEING: usize = 10;
/// Steps of all attempts together where nothing else is asked for: the longest of those 4 000 took 802.
const STEPS: usize = 1500;

impl Arm {
    /// The core's search from the workspace's start, into the workspace's x.
    pub(super) fn search_by_core(
        &self,
        workspace: &mut Workspace,
        start: &[f64],
        deadline: Option<Instant>,
    ) -> Reply {
        let mut stopping = Stopping::default();
        if let Some(deadline) = deadline {
            let left = deadline.saturating_duration_since(Instant::now());
            stopping = stopping.with_time_limit(left);
        }
        let options = &self.options;
        let (steps, agreeing) = match (options.iterations, options.attempts_asked) {
            (Some(steps), true) => (steps as usize, usize::MAX),
            (Some(steps), false) => (steps as usize, AGREEING),
            (None, true) => (usize::MAX, usize::MAX),
            (None, false) => (STEPS, AGREEING),
        };
        let restarts = Restarts::default()
            .with_attempts(options.attempts as usize)
            .with_steps(steps)
            .with_agreeing(agreeing)
            .with_seed(options.seed);
        let solver = workspace
            .solver
            .clone()
            .with_stopping(stopping)
            .with_restarts(restarts);
        self.serial.map.expand(&workspace.start, &mut workspace.q);
        let answer = solver.solve(&workspace.problem, &workspace.q, &mut workspace.core);
        // The start is finite and of the right length, which is all a solver can object to.
        let (iterations, attempts, termination) = match answer {
            Ok(solution) => {
                self.serial.map.reduce(&solution.q, &mut workspace.x);
                (solution.iterations, solution.attempts, solution.termination)
            }
            Err(_) => {
                workspace.x.copy_from_slice(&workspace.start);
                (0, 0, Termination::NonFinite)
            }
        };
        self.unwrap_towards(start, workspace);
        Reply {
            errors: workspace.judge_x(),
            termination,
            iterations,
            attempts,
            winner: u32::try_from(attempts.saturating_sub(1)).ok(),
        }
    }

    /// Attempts `first`, `first + 1`, … of the core's solver, one an outcome, appended to the
    /// configurations found.
    pub(super) fn attempts_by_core(
        &self,
        workspace: &mut Workspace,
        start: &[f64],
        first: u32,
        count: u32,
        deadline: Option<Instant>,
    ) {
        for attempt in first..first + count {
            workspace.x.copy_from_slice(&workspace.start);
            if attempt > 0 {
                let mut random = RandomStream::new(self.options.seed, u64::from(attempt));
                for (i, value) in workspace.x.iter_mut().enumerate() {
                    let (low, high) = workspace.problem.sampling_range(i, workspace.start[i]);
                    *value = low + (high - low) * random.unit();
                }
            }
            let (_, iterations) = workspace.settle(deadline);
            self.unwrap_towards(start, workspace);
            let errors = workspace.judge_x();
            workspace.found.extend_from_slice(&workspace.x);
            workspace.outcomes.push(Outcome {
                reached: errors.reached,
                position_error: errors.position,
                orientation_error: errors.orientation,
                iterations: u32::try_from(iterations).unwrap_or(u32::MAX),
                attempts: 1,
                winner: errors.reached.then_some(attempt),
            });
        }
    }

    /// Adds whole turns to the workspace's x where joints can make them and nothing follows them.
    fn unwrap_towards(&self, start: &[f64], workspace: &mut Workspace) {
        let (model, map) = (&self.serial.model, &self.serial.map);
        for (i, value) in workspace.x.iter_mut().enumerate() {
            let joint = &model.joints()[model.moving_joints()[map.leaders()[i]].index()];
            let (lower, upper) = (workspace.lower[i], workspace.upper[i]);
            let slides = joint.kind == JointKind::Prismatic;
            if slides || self.serial.followed[i] || upper - lower < TAU {
                continue;
            }
            let (lowest, highest) = ((lower - *value) / TAU, (upper - *value) / TAU);
            let turns = ((reduced(start[i]) - *value) / TAU).round();
            let turned = *value + turns.min(highest.floor()).max(lowest.ceil()) * TAU;
            if lower <= turned && turned <= upper {
                *value = turned;
            }
        }
    }
}
