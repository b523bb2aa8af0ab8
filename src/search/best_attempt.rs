//! Choice of the best attempt, and the number of attempts that agree with it.

use super::attempt::{Attempt, SearchResult};
use super::schedule::{Schedule, Trial};
use crate::solver::Termination;

/// Smallest relative reduction of the cost by which an attempt replaces the best one.
const SAME_COST: f64 = 1e-6;

/// Largest relative excess over the lowest cost at which an attempt agrees with it. It applies to the end of a search
/// and to the number in a solution. The first attempt is kept if it agrees with the lowest.
const AGREEING_COST: f64 = 1e-3;

/// Number of attempts for whose costs memory is reserved.
const USUAL_ATTEMPTS: usize = 1024;

/// The best attempt so far, and the totals of all attempts.
#[derive(Clone, Debug, Default)]
pub(crate) struct Keeper {
    pub(crate) x: Vec<f64>,
    /// Weighted residual at x, of the tasks that are searched for.
    pub(crate) residual: Vec<f64>,
    pub(super) found: SearchResult,
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
        self.found = SearchResult::default();
        (self.first_is_best, self.first_may_win) = (true, false);
        self.settled_costs.clear();
        self.costs.clear();
        if schedule.tells_agreement() {
            let attempts = schedule.attempts();
            self.costs.reserve(attempts.min(USUAL_ATTEMPTS));
            self.settled_costs.reserve(attempts.min(USUAL_ATTEMPTS));
            self.first_x.resize(self.x.len(), 0.0);
        }
    }

    /// Reports whether a trial is useful after the earlier ones.
    pub(super) fn wants(&self, trial: Trial, schedule: &Schedule) -> bool {
        let found = &self.found;
        let over = found.iterations >= schedule.restarts().steps || self.agree(schedule.enough());
        match trial {
            Trial::Quick(_) | Trial::Full(_) => found.attempts == 0 || !over,
            Trial::FinishBest | Trial::NearbyFirst => found.termination == Termination::Stalled,
            Trial::FinishFirst => !self.first_is_best && self.first_may_win,
            Trial::FinishAtLast => {
                !schedule.settles(found.termination) && found.attempts != schedule.attempts()
            }
        }
    }

    /// Reports whether `enough` attempts agree with the lowest cost.
    fn agree(&self, enough: usize) -> bool {
        let agreeing = self.found.cost * (1.0 + AGREEING_COST);
        let mut costs = self.settled_costs.iter().filter(|cost| **cost <= agreeing);
        enough == 0 || costs.nth(enough - 1).is_some()
    }

    /// Start of a trial that continues another one.
    pub(super) fn start_of(&self, trial: Trial) -> &[f64] {
        match trial {
            Trial::FinishFirst => &self.first_x,
            _ => &self.x,
        }
    }

    /// Takes the result of a trial. Of equal results the earliest is kept, as it is the nearest to the caller's start.
    pub(super) fn take(
        &mut self,
        trial: Trial,
        attempt: &Attempt,
        (x, residual): (&[f64], &[f64]),
        schedule: &Schedule,
    ) {
        let found = &mut self.found;
        let goes_on = [Trial::NearbyFirst, Trial::FinishBest, Trial::FinishFirst];
        found.attempts += usize::from(!goes_on.contains(&trial));
        found.iterations += attempt.iterations;
        found.counts += attempt.counts;
        if trial == Trial::NearbyFirst && !attempt.reached {
            // The attempt already counts as stalled, and is finished later like any other.
            return;
        }
        let settled = schedule.settles(attempt.termination);
        let ended = settled || attempt.termination == Termination::Stalled;
        if ended && !trial.goes_on() && schedule.tells_agreement() {
            self.costs.push(attempt.cost);
        }
        let lower = attempt.cost < found.cost * (1.0 - SAME_COST);
        if settled && schedule.counts_for_agreement(trial) {
            self.settled_costs.push(attempt.cost);
        }
        let first = found.attempts == 1 && !trial.goes_on();
        if first {
            if schedule.tells_agreement() {
                self.first_x.copy_from_slice(x);
            }
            self.first_may_win = ended;
        }
        let usable = found.cost.is_nan() && !attempt.cost.is_nan();
        let kept = match trial {
            Trial::FinishFirst => attempt.cost <= found.cost * (1.0 + AGREEING_COST),
            _ => first || lower || usable || trial.goes_on(),
        };
        if attempt.reached || kept {
            self.first_is_best &= first || trial.goes_on();
            found.termination = attempt.termination;
            found.number = found.attempts.saturating_sub(1);
            found.projected_gradient = attempt.projected_gradient;
            (found.cost, found.reached) = (attempt.cost, attempt.reached);
            self.x.copy_from_slice(x);
            self.residual.copy_from_slice(residual);
        }
    }

    /// Sets the termination that ended the search early, also if an earlier attempt is returned.
    pub(super) fn cut(&mut self, termination: Termination) {
        self.found.termination = termination;
    }

    /// The result of the search.
    pub(super) fn found(&mut self, schedule: &Schedule) -> SearchResult {
        if schedule.tells_agreement() {
            let alike = self.found.cost * (1.0 + AGREEING_COST);
            let agreeing = self.costs.iter().filter(|cost| **cost <= alike);
            self.found.agreeing = agreeing.count().max(1);
        }
        self.found
    }
}
