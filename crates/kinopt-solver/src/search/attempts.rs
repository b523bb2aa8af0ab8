//! The loop over the attempts of a search.

use super::basin_hopping::Hops;
use super::best_attempt::Keeper;
use super::independent_limbs::IndependentLimbs;
use super::out_of_reach::min_cost as min_cost_of;
use super::schedule::{Schedule, Trial};
use super::search_result::SearchResult;
use crate::problem::{ProblemInstance, TaskSubset};
use crate::solver::{Stopping, Termination};
use kinopt_kinematics::clock::{Instant, is_past};

/// A local search from one start.
#[doc(hidden)]
pub trait Engine {
    /// Weighted residual at the caller's start, of the tasks that are searched for.
    fn residual_at_start(&mut self, start: &[f64]) -> &[f64];

    /// Searches from x, projected into the bounds.
    fn attempt(&mut self, x: &[f64], stopping: &Stopping) -> SearchResult;

    /// Variables and residual at the end of the last attempt.
    fn end(&self) -> (&[f64], &[f64]);
}

/// State and workspace of a search.
#[derive(Clone, Debug, Default)]
#[doc(hidden)]
pub struct Attempts {
    /// Variables of the caller's start.
    #[doc(hidden)]
    pub start: Vec<f64>,
    #[doc(hidden)]
    pub keeper: Keeper,
    /// Start of the next attempt.
    pub(crate) x: Vec<f64>,
    /// Variables that the first attempts near the start may change.
    local: Vec<bool>,
    hops: Hops,
    limbs: IndependentLimbs,
}

impl Attempts {
    /// Resizes the workspace for a problem.
    #[doc(hidden)]
    pub fn fit(&mut self, instance: ProblemInstance<'_>, subset: TaskSubset) {
        let variables = instance.variables();
        self.start.resize(variables, 0.0);
        self.x.resize(variables, 0.0);
        self.local.resize(variables, true);
        self.hops.fit(variables);
        self.limbs.fit(variables);
        self.keeper.fit(variables, instance.problem.rows_of(subset));
    }
}

/// Runs the trials of a schedule. The search ends when an attempt reaches the goals, when enough attempts agree, or
/// when no trials or time remain.
#[doc(hidden)]
pub fn run(
    instance: ProblemInstance<'_>,
    subset: TaskSubset,
    schedule: &Schedule,
    deadline: Option<Instant>,
    engine: &mut dyn Engine,
    search: &mut Attempts,
) -> SearchResult {
    let is_late = || is_past(deadline);
    let Attempts {
        start,
        keeper,
        x,
        local,
        hops,
        limbs,
    } = search;
    keeper.begin(schedule);
    hops.begin();
    let mut min_cost = None;
    for trial in schedule.trials() {
        if !keeper.is_useful(trial, schedule) {
            continue;
        }
        if keeper.result.attempts > 0 && schedule.may_end_at_optimum(trial) {
            let min_cost = *min_cost.get_or_insert_with(|| min_cost_of(instance, subset));
            if min_cost > 0.0 && keeper.is_optimal(min_cost) {
                continue;
            }
        }
        if keeper.result.attempts > 0 && is_late() {
            keeper.cut(Termination::TimeLimit);
            break;
        }
        match trial {
            Trial::NearbyFirst => {
                let residual = engine.residual_at_start(start);
                if !instance.problem.is_nearby(subset, residual) {
                    continue;
                }
                x.copy_from_slice(start);
            }
            Trial::Quick(index) | Trial::Full(index) => {
                if index == 1 {
                    limbs.begin(instance, subset);
                    limbs.record_solved(instance, subset, (&keeper.x, &keeper.residual));
                    let residual = engine.residual_at_start(start);
                    instance.problem.mark_local(subset, residual, local);
                }
                let restarts = schedule.restarts();
                if !(schedule.hops() && hops.start_of(index, restarts.seed, instance, x)) {
                    restarts.start_of(index, start, local, instance, x);
                }
                if index > 0 {
                    limbs.write_solved(x);
                }
            }
            _ => x.copy_from_slice(keeper.start_of(trial)),
        }
        let attempt = engine.attempt(x, &schedule.stopping(trial));
        keeper.record(trial, &attempt, engine.end(), schedule);
        if keeper.result.attempts > 1 {
            limbs.record_solved(instance, subset, engine.end());
        }
        if schedule.hops() {
            hops.record(&attempt, engine.end().0);
        }
        let was_cut = attempt.termination.is_cut();
        if was_cut && !attempt.reached {
            keeper.cut(attempt.termination);
        }
        if attempt.reached || was_cut {
            break;
        }
    }
    keeper.finish(schedule)
}
