//! Choice of the best attempt, and the number of attempts that agree with it.

use super::schedule::{Schedule, Trial};
use super::search_result::SearchResult;
use crate::solver::Termination;

/// Smallest relative reduction of the cost by which an attempt replaces the best one.
const MIN_COST_REDUCTION: f64 = 1e-6;

/// Largest relative excess over the lowest cost at which an attempt agrees with it. It applies to the end of a search
/// and to the number in a solution. The first attempt is kept if it agrees with the lowest.
const AGREEMENT_TOLERANCE: f64 = 1e-3;

/// Number of attempts for whose costs memory is reserved.
const RESERVED_ATTEMPTS: usize = 1024;

/// The best attempt so far, and the totals of all attempts.
#[derive(Clone, Debug, Default)]
#[doc(hidden)]
pub struct Keeper {
    #[doc(hidden)]
    pub x: Vec<f64>,
    /// Weighted residual at x, of the tasks that are searched for.
    pub(crate) residual: Vec<f64>,
    pub(super) result: SearchResult,
    /// End of the attempt from the caller's start.
    first_x: Vec<f64>,
    first_is_best: bool,
    /// The first attempt may be returned although another one has a lower cost.
    first_may_win: bool,
    /// Costs of the attempts that may end the search by agreement.
    settled_costs: Vec<f64>,
    /// Costs of all attempts that converged or stalled, if the schedule counts agreement.
    costs: Vec<f64>,
}

impl Keeper {
    /// Resizes the workspace.
    pub(crate) fn fit(&mut self, variables: usize, rows: usize) {
        self.x.resize(variables, 0.0);
        self.residual.resize(rows, 0.0);
    }

    /// Resets the state for a search by a schedule.
    pub(super) fn begin(&mut self, schedule: &Schedule) {
        self.result = SearchResult::default();
        (self.first_is_best, self.first_may_win) = (true, false);
        self.settled_costs.clear();
        self.costs.clear();
        if schedule.counts_agreement() {
            let attempts = schedule.attempts();
            self.costs.reserve(attempts.min(RESERVED_ATTEMPTS));
            self.settled_costs.reserve(attempts.min(RESERVED_ATTEMPTS));
            self.first_x.resize(self.x.len(), 0.0);
        }
    }

    /// Reports whether a trial is useful after the earlier ones.
    pub(super) fn is_useful(&self, trial: Trial, schedule: &Schedule) -> bool {
        let result = &self.result;
        let search_over = result.iterations >= schedule.restarts().steps
            || self.enough_agree(schedule.agreement_limit());
        match trial {
            Trial::Quick(_) | Trial::Full(_) => result.attempts == 0 || !search_over,
            Trial::FinishBest | Trial::NearbyFirst => result.termination == Termination::Stalled,
            Trial::FinishFirst => !self.first_is_best && self.first_may_win,
            Trial::FinishAtLast => {
                !schedule.is_converged(result.termination) && result.attempts != schedule.attempts()
            }
        }
    }

    /// Reports whether no other attempt can replace the best one, because no cost is below `min_cost`.
    pub(super) fn is_optimal(&self, min_cost: f64) -> bool {
        self.result.cost * (1.0 - MIN_COST_REDUCTION) <= min_cost
    }

    /// Reports whether `count` attempts agree with the lowest cost.
    fn enough_agree(&self, count: usize) -> bool {
        let max_agreeing_cost = self.result.cost * (1.0 + AGREEMENT_TOLERANCE);
        let mut costs = self
            .settled_costs
            .iter()
            .filter(|cost| **cost <= max_agreeing_cost);
        count == 0 || costs.nth(count - 1).is_some()
    }

    /// Start of a trial that continues another one.
    pub(super) fn start_of(&self, trial: Trial) -> &[f64] {
        match trial {
            Trial::FinishFirst => &self.first_x,
            _ => &self.x,
        }
    }

    /// Takes the result of a trial. Of equal results the earliest is kept, as it is the nearest to the caller's start.
    pub(super) fn record(
        &mut self,
        trial: Trial,
        attempt: &SearchResult,
        (x, residual): (&[f64], &[f64]),
        schedule: &Schedule,
    ) {
        let result = &mut self.result;
        let continuations = [Trial::NearbyFirst, Trial::FinishBest, Trial::FinishFirst];
        result.attempts += usize::from(!continuations.contains(&trial));
        result.iterations += attempt.iterations;
        result.counts += attempt.counts;
        if trial == Trial::NearbyFirst && !attempt.reached {
            // The attempt already counts as stalled, and is finished later like any other.
            return;
        }
        let settled = schedule.is_converged(attempt.termination);
        let ended = settled || attempt.termination == Termination::Stalled;
        if ended && !trial.continues_best() && schedule.counts_agreement() {
            self.costs.push(attempt.cost);
        }
        let has_lower_cost = attempt.cost < result.cost * (1.0 - MIN_COST_REDUCTION);
        if settled && schedule.counts_for_agreement(trial) {
            self.settled_costs.push(attempt.cost);
        }
        let first = result.attempts == 1 && !trial.continues_best();
        if first {
            if schedule.counts_agreement() {
                self.first_x.copy_from_slice(x);
            }
            self.first_may_win = ended;
        }
        let usable = result.cost.is_nan() && !attempt.cost.is_nan();
        let is_new_best = match trial {
            Trial::FinishFirst => attempt.cost <= result.cost * (1.0 + AGREEMENT_TOLERANCE),
            _ => first || has_lower_cost || usable || trial.continues_best(),
        };
        if attempt.reached || is_new_best {
            self.first_is_best &= first || trial.continues_best();
            result.termination = attempt.termination;
            result.number = result.attempts.saturating_sub(1);
            result.projected_gradient = attempt.projected_gradient;
            (result.cost, result.reached) = (attempt.cost, attempt.reached);
            self.x.copy_from_slice(x);
            self.residual.copy_from_slice(residual);
        }
    }

    /// Sets the termination that ended the search early, also if an earlier attempt is returned.
    pub(super) fn cut(&mut self, termination: Termination) {
        self.result.termination = termination;
    }

    /// The result of the search.
    pub(super) fn finish(&mut self, schedule: &Schedule) -> SearchResult {
        if schedule.counts_agreement() {
            let max_agreeing_cost = self.result.cost * (1.0 + AGREEMENT_TOLERANCE);
            let agreeing = self.costs.iter().filter(|cost| **cost <= max_agreeing_cost);
            self.result.agreeing = agreeing.count().max(1);
        }
        self.result
    }
}
