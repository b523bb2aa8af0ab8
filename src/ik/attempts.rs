//! Attempts one after the other: which one runs next, and which one counts.

use std::time::Instant;

use super::Workspace;
use super::restarts::{Restarts, Trial};
use crate::problem::{Evaluation, Problem, Scratch};
use crate::solver::{Counts, Method, Observer, Outcome, Stopping, Termination, minimise_until};

/// Costs within this share of each other count as the same miss.
const SAME_COST: f64 = 1e-6;

/// The caller's own attempt stays where another is better by no more than this share of the cost: what
/// one did not ask for should not happen for a hair's breadth.
const NEARLY_SAME: f64 = 1e-3;

/// What the attempts together came to; where, is in the workspace.
pub(super) struct Found {
    /// How the attempt that counts ended.
    pub(super) outcome: Outcome,
    pub(super) cost: f64,
    pub(super) iterations: usize,
    pub(super) attempts: usize,
    pub(super) counts: Counts,
}

impl Found {
    fn nothing() -> Self {
        Self {
            outcome: Outcome {
                termination: Termination::NonFinite,
                iterations: 0,
                projected_gradient: None,
            },
            cost: f64::INFINITY,
            iterations: 0,
            attempts: 0,
            counts: Counts::default(),
        }
    }
}

/// All attempts at one problem; each is a search of its own.
pub(super) struct Attempts<'a> {
    pub(super) problem: &'a Problem,
    pub(super) method: &'a dyn Method,
    pub(super) stopping: Stopping,
    pub(super) restarts: Restarts,
}

impl Attempts<'_> {
    /// Runs the trials from the workspace's start until one reaches the goals, several agree that
    /// none can, or they run out.
    pub(super) fn run(
        &self,
        workspace: &mut Workspace,
        scratch: &mut Scratch,
        observer: &mut dyn Observer,
    ) -> Found {
        let Workspace {
            memory,
            start,
            attempt,
            wander,
            first_x,
            best_x,
            best_residual,
            ..
        } = workspace;
        let deadline = self.stopping.deadline();
        let mut found = Found::nothing();
        let mut agreeing = 0;
        // With preferences the minimum is the goal, and a stall is on the way to it.
        let patient = self.problem.has_preferences();
        let enough = self.restarts.enough(patient);
        let (mut over, mut first_is_best, mut first_may_win) = (false, true, false);
        for trial in self.restarts.trials(patient) {
            if over && !trial.finishes() {
                continue;
            }
            match trial {
                Trial::Quick(index) | Trial::Full(index) => {
                    if index == 1 {
                        let mut evaluation = Evaluation::new(self.problem, scratch);
                        memory.evaluate_at(&mut evaluation, start);
                        self.problem.mark_free_to_wander(memory.residual(), wander);
                    }
                    self.restarts
                        .start_of(index, start, wander, self.problem, attempt);
                    found.attempts += 1;
                }
                Trial::FinishBest if found.outcome.termination != Termination::Stalled => continue,
                Trial::FinishFirst if first_is_best || !first_may_win => continue,
                Trial::FinishAtLast if settled(found.outcome.termination) => continue,
                Trial::FinishAtLast if found.attempts == self.restarts.attempts => continue,
                Trial::FinishAtLast => {
                    found.attempts += 1;
                    attempt.copy_from_slice(best_x);
                }
                Trial::FinishBest => attempt.copy_from_slice(best_x),
                Trial::FinishFirst => attempt.copy_from_slice(first_x),
            }
            let stopping = match trial {
                Trial::Quick(index) => self.stopping.impatient(self.restarts.patience(index)),
                _ => self.stopping,
            };
            let outcome = minimise_until(
                &mut Evaluation::new(self.problem, scratch),
                self.method,
                attempt,
                &stopping,
                deadline,
                observer,
                memory,
            );
            found.iterations += outcome.iterations;
            found.counts += memory.counts();

            let cost = memory.cost();
            let reached = self.problem.is_reached(memory.residual());
            if settled(outcome.termination) && trial.counts_for_agreement() {
                agreeing = if cost < found.cost * (1.0 - SAME_COST) {
                    1
                } else {
                    agreeing + usize::from(cost <= found.cost * (1.0 + SAME_COST))
                };
            }
            let first = found.attempts == 1 && !trial.goes_on();
            // Among equals the earliest, which is the nearest to the caller's start, stays.
            let better = cost < found.cost * (1.0 - SAME_COST) || found.cost.is_nan();
            if first {
                first_x.copy_from_slice(memory.x());
                let ended = outcome.termination;
                first_may_win = settled(ended) || ended == Termination::Stalled;
            }
            let kept = match trial {
                Trial::FinishFirst => cost <= found.cost * (1.0 + NEARLY_SAME),
                _ => first || better || trial.goes_on(),
            };
            if reached || kept {
                first_is_best &= first || trial.goes_on();
                (found.outcome, found.cost) = (outcome, cost);
                best_x.copy_from_slice(memory.x());
                best_residual.copy_from_slice(memory.residual());
            }
            let cancelled = outcome.termination == Termination::Cancelled;
            let late = deadline.is_some_and(|deadline| Instant::now() >= deadline);
            over = found.iterations >= self.restarts.steps || agreeing >= enough;
            if reached || cancelled || late {
                break;
            }
        }
        found
    }
}

/// Whether an attempt ended because nothing better is near, rather than for lack of patience.
fn settled(termination: Termination) -> bool {
    matches!(
        termination,
        Termination::Stationary | Termination::SmallStep
    )
}
