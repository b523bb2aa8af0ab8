//! Which of several attempts counts, and how many agree with it.

use super::attempt::{Attempt, Found};
use super::schedule::{Schedule, Trial};
use crate::solver::Termination;

/// Smallest share of the cost by which an attempt must be lower to replace the best one.
const SAME_COST: f64 = 1e-6;

/// Attempts whose costs exceed the lowest by at most this share agree with it, both for the end of a search and for the number
/// that a solution reports. The first attempt is kept if it agrees with the lowest.
const AGREEING_COST: f64 = 1e-3;

/// Room for the costs of so many attempts is made before the first.
const USUAL_ATTEMPTS: usize = 1024;

/// The attempts made so far: where the one that counts ended, and what all came to.
#[derive(Clone, Debug, Default)]
pub(crate) struct Keeper {
    pub(crate) x: Vec<f64>,
    /// Of what is searched for, at x.
    pub(crate) residual: Vec<f64>,
    pub(super) found: Found,
    /// Where the attempt from the caller's start ended.
    first_x: Vec<f64>,
    first_is_best: bool,
    /// Whether it may be the one that counts, though another is better.
    first_may_win: bool,
    /// Costs of the attempts that count for agreement.
    settled_costs: Vec<f64>,
    /// The cost of every attempt that came to its end or stalled, where the schedule tells agreement.
    costs: Vec<f64>,
}

impl Keeper {
    /// Makes room for a search of so many variables and rows.
    pub(crate) fn fit(&mut self, variables: usize, rows: usize) {
        self.x.resize(variables, 0.0);
        self.residual.resize(rows, 0.0);
    }

    /// Forgets the last search, before one by a schedule.
    pub(super) fn begin(&mut self, schedule: &Schedule) {
        self.found = Found::default();
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

    /// Whether a trial makes sense after those before.
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

    /// Whether so many attempts agree with the lowest.
    fn agree(&self, enough: usize) -> bool {
        let agreeing = self.found.cost * (1.0 + AGREEING_COST);
        let mut costs = self.settled_costs.iter().filter(|cost| **cost <= agreeing);
        enough == 0 || costs.nth(enough - 1).is_some()
    }

    /// Where a trial that finishes another begins.
    pub(super) fn start_of(&self, trial: Trial) -> &[f64] {
        match trial {
            Trial::FinishFirst => &self.first_x,
            _ => &self.x,
        }
    }

    /// Takes what a trial came to. Among equals the earliest, which is the nearest to the caller's start,
    /// stays.
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
            // It counts as the attempt that gave up, which is finished later like any other.
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

    /// Says what cut the search short: reported also where an earlier attempt is the one returned.
    pub(super) fn cut(&mut self, termination: Termination) {
        self.found.termination = termination;
    }

    /// What the attempts came to.
    pub(super) fn found(&mut self, schedule: &Schedule) -> Found {
        if schedule.tells_agreement() {
            let alike = self.found.cost * (1.0 + AGREEING_COST);
            let agreeing = self.costs.iter().filter(|cost| **cost <= alike);
            self.found.agreeing = agreeing.count().max(1);
        }
        self.found
    }
}
