//! The way of chains that the lane engine cannot express: the core's solver on the same problem.

use std::f64::consts::TAU;
use std::time::Instant;

use super::query::Arm;
use super::report::Reply;
use super::seed_table::SeedTable;
use super::workspace::{Errors, Workspace};
use crate::ik::Restarts;
use crate::lanes::{Outcome, reduced};
use crate::model::JointKind;
use crate::random::RandomStream;
use crate::solver::{Stopping, Termination};

/// Attempts from the start and beside it before seeds are looked up.
const OWN: usize = 2;
/// Seeds that a question tries, and the steps without halving the cost after which one is given up.
/// Of 11 600 reachable poses of random chains with followers random attempts alone missed 24; with
/// seeds before them, of 240 000, 64 missed two and 128 none.
const SEEDS: usize = 128;
const PATIENCE: usize = 10;
/// Attempts that stop at the same miss before a target counts as out of reach, where no number of
/// attempts is asked for.
const AGREEING: usize = 10;
/// Steps of all random attempts together where nothing else is asked for.
const STEPS: usize = 2500;

impl Arm {
    /// The core's search from the workspace's start, into the workspace's x: the start's own attempts,
    /// then the seeds whose tool stands nearest to the target, then random ones.
    pub(super) fn search_by_core(
        &self,
        workspace: &mut Workspace,
        start: &[f64],
        deadline: Option<Instant>,
    ) -> Reply {
        let attempts = self.attempts_at(&workspace.target()) as usize;
        let mut reply = self.restarts_by_core(workspace, start, attempts.min(OWN), deadline);
        // Where moves are bounded, seeds from all over the limits are far outside.
        let everywhere = self.options.max_move.is_none();
        for seeded in [true, false] {
            let late = deadline.is_some_and(|at| Instant::now() >= at);
            let left = attempts.saturating_sub(reply.attempts);
            if reply.errors.reached || late || left == 0 || seeded && !everywhere {
                continue;
            }
            workspace.best.copy_from_slice(&workspace.x);
            let more = match seeded {
                true => self.seeds_by_core(workspace, start, left.min(SEEDS), deadline),
                false => self.restarts_by_core(workspace, start, left, deadline),
            };
            let lower =
                more.errors.reached || self.cost_of(more.errors) < self.cost_of(reply.errors);
            let spent = (reply.iterations, reply.attempts);
            if lower {
                let winner = more.winner.unwrap_or(0) as usize + spent.1;
                reply = more;
                reply.winner = u32::try_from(winner).ok();
            } else {
                workspace.x.copy_from_slice(&workspace.best);
                (reply.iterations, reply.attempts) = (more.iterations, more.attempts);
            }
            reply.iterations += spent.0;
            reply.attempts += spent.1;
        }
        reply
    }

    /// An attempt from each of the nearest seeds, until one reaches; the best is in x.
    fn seeds_by_core(
        &self,
        workspace: &mut Workspace,
        start: &[f64],
        most: usize,
        deadline: Option<Instant>,
    ) -> Reply {
        self.look_up_seeds(workspace, most);
        let rows = std::mem::take(&mut workspace.rows);
        let mut best: Option<Reply> = None;
        let (mut iterations, mut attempts) = (0, 0);
        for &(_, row) in &rows {
            if let Some(table) = self.seeds.get() {
                workspace.x.copy_from_slice(table.seed(row));
            }
            let (termination, steps) = workspace.settle_within(Some(PATIENCE), deadline);
            self.unwrap_towards(start, workspace);
            let reply = Reply {
                errors: workspace.judge_x(),
                termination,
                iterations: 0,
                attempts: 0,
                winner: Some(attempts),
            };
            iterations += steps;
            attempts += 1;
            let lower = |best: &Reply| self.cost_of(reply.errors) < self.cost_of(best.errors);
            if reply.errors.reached || best.as_ref().is_none_or(lower) {
                workspace.trial.copy_from_slice(&workspace.x);
                best = Some(reply);
            }
            let late = deadline.is_some_and(|at| Instant::now() >= at);
            if reply.errors.reached || late {
                break;
            }
        }
        workspace.rows = rows;
        let Workspace { x, trial, .. } = workspace;
        x.copy_from_slice(trial);
        let best = best.unwrap_or(Reply {
            errors: Errors {
                position: f64::INFINITY,
                orientation: f64::INFINITY,
                reached: false,
            },
            termination: Termination::NonFinite,
            iterations: 0,
            attempts: 0,
            winner: None,
        });
        Reply {
            iterations,
            attempts: attempts as usize,
            ..best
        }
    }

    /// Writes the rows of the seeds nearest to the target into the workspace's.
    fn look_up_seeds(&self, workspace: &mut Workspace, most: usize) {
        let table = self
            .seeds
            .get_or_init(|| SeedTable::new(&self.serial, workspace));
        let goal = &self.options.goal;
        let weights = (
            f64::from(u8::from(goal.has_position())),
            match goal.has_orientation() {
                true => self.options.metres_per_radian,
                false => 0.0,
            },
        );
        let target = workspace.target();
        table.nearest(&target, weights, most, &mut workspace.rows);
    }

    /// Attempts from the workspace's start, beside it and anywhere, into the workspace's x.
    fn restarts_by_core(
        &self,
        workspace: &mut Workspace,
        start: &[f64],
        attempts: usize,
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
            .with_attempts(attempts)
            .with_steps(steps)
            .with_agreeing(agreeing)
            .with_seed(options.seed);
        let solver = workspace
            .solver
            .clone()
            .with_stopping(stopping)
            .with_restarts(restarts);
        self.serial.map.expand(&workspace.start, &mut workspace.q);
        let answer = solver.solve(workspace.question.ask(), &workspace.q, &mut workspace.core);
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
        self.look_up_seeds(workspace, SEEDS.min((first + count) as usize));
        for attempt in first..first + count {
            workspace.x.copy_from_slice(&workspace.start);
            // Every other one from a seed, as far as they go.
            let row = match attempt > 0 && attempt % 2 == 0 {
                true => workspace.rows.get(attempt as usize / 2 - 1),
                false => None,
            };
            if let (Some((_, row)), Some(table)) = (row, self.seeds.get()) {
                workspace.x.copy_from_slice(table.seed(*row));
            } else if attempt > 0 {
                let mut random = RandomStream::new(self.options.seed, u64::from(attempt));
                for (i, value) in workspace.x.iter_mut().enumerate() {
                    let (low, high) = workspace
                        .question
                        .ask()
                        .sampling_range(i, workspace.start[i]);
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
            let (lower, upper) = (workspace.question.lower[i], workspace.question.upper[i]);
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
