//! Attempts one after the other: which one runs next, and which one counts.

use std::time::Instant;

use super::Workspace;
use super::restarts::{Restarts, Trial};
use crate::problem::{Evaluation, Question, Scratch, Share};
use crate::solver::{Counts, Method, Observer, Outcome, Stopping, Termination, minimise_until};

/// Costs within this share of each other count as the same miss.
const SAME_COST: f64 = 1e-6;

/// The caller's own attempt stays where another is better by no more than this share of the cost: what
/// one did not ask for should not happen for a hair's breadth.
const NEARLY_SAME: f64 = 1e-3;

/// Room for the costs of so many attempts is made before the first.
const USUAL_ATTEMPTS: usize = 1024;

/// What the attempts together came to; where, is in the workspace.
pub(super) struct Found {
    /// How the attempt that counts ended.
    pub(super) outcome: Outcome,
    pub(super) cost: f64,
    pub(super) iterations: usize,
    pub(super) attempts: usize,
    /// How many attempts stopped as near as the one that counts, itself included.
    pub(super) agreeing: usize,
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
            agreeing: 0,
            counts: Counts::default(),
        }
    }
}

/// All attempts at one problem; each is a search of its own.
pub(super) struct Attempts<'a> {
    pub(super) question: Question<'a>,
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
        deadline: Option<Instant>,
        observer: &mut dyn Observer,
    ) -> Found {
        let Workspace {
            memory,
            start,
            attempt,
            wander,
            first_x,
            costs,
            best_x,
            best_residual,
            ..
        } = workspace;
        let mut found = Found::nothing();
        let mut agreeing = 0;
        let problem = self.question.problem;
        let share = problem.search_share();
        // Where preferences are traded the minimum is the goal, and a stall is on the way to it.
        let patient = share == Share::All && problem.has_preferences();
        let enough = self.restarts.enough(patient);
        let (mut over, mut first_is_best, mut first_may_win) = (false, true, false);
        costs.clear();
        costs.reserve(self.restarts.attempts.min(USUAL_ATTEMPTS));
        let late = || deadline.is_some_and(|deadline| Instant::now() >= deadline);
        for trial in self.restarts.trials(patient) {
            if over && !trial.finishes() {
                continue;
            }
            match trial {
                Trial::FinishBest if found.outcome.termination != Termination::Stalled => continue,
                Trial::FinishFirst if first_is_best || !first_may_win => continue,
                Trial::FinishAtLast if settled(found.outcome.termination) => continue,
                Trial::FinishAtLast if found.attempts == self.restarts.attempts => continue,
                _ if found.attempts > 0 && late() => {
                    found.outcome.termination = Termination::TimeLimit;
                    break;
                }
                Trial::Quick(index) | Trial::Full(index) => {
                    if index == 1 {
                        let mut evaluation = Evaluation::of(share, self.question, scratch);
                        memory.evaluate_at(&mut evaluation, start);
                        let residual = memory.residual();
                        problem.mark_free_to_wander(share, residual, wander);
                    }
                    self.restarts
                        .start_of(index, start, wander, self.question, attempt);
                    found.attempts += 1;
                }
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
                &mut Evaluation::of(share, self.question, scratch),
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
            let reached = problem.is_reached_by(share, memory.residual());
            let stalled = outcome.termination == Termination::Stalled;
            if !trial.goes_on() && (stalled || settled(outcome.termination)) {
                costs.push(cost);
            }
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
            over = found.iterations >= self.restarts.steps || agreeing >= enough;
            let cut = matches!(
                outcome.termination,
                Termination::Cancelled | Termination::TimeLimit
            );
            if cut && !reached {
                // What ends the search is told, also where an earlier attempt is the one returned.
                found.outcome.termination = outcome.termination;
            }
            if reached || cut {
                break;
            }
        }
        let alike = found.cost * (1.0 + NEARLY_SAME);
        let agreeing = costs.iter().filter(|cost| **cost <= alike);
        found.agreeing = agreeing.count().max(1);
        found
    }
}

/// Whether an attempt ended because nothing better is near, rather than for lack of patience.
pub(super) fn settled(termination: Termination) -> bool {
    matches!(
        termination,
        Termination::Stationary | Termination::SmallStep
    )
}
