//! Fallbacks of a query whose first attempts fail.

use super::arm::Arm;
use super::dispatch::{QUICK, Query};
use super::follower::LONG_STEP;
use super::local_descent::Settling;
use super::options::Search;
use super::workspace::{ArmWorkspace, Errors};
use crate::problem::MAX_NEARBY_ERROR;
use crate::search::SearchResult;
use crate::simd_ik;
use crate::solver::Termination;

/// Largest number of short steps from the start towards a near solution.
const NEAR_STEPS: usize = 100;

impl Arm {
    /// Continues failed attempts with the general solver: the first, whose end is in the workspace's x, then the best,
    /// then the remaining ones.
    ///
    /// For a target near the start, all that a search of one attempt does comes before the remaining attempts. If none
    /// reaches, the result is the end of the first attempt, unless the arm searches globally on failure.
    pub(super) fn finish(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        found: &mut SearchResult,
    ) {
        if found.reached {
            return;
        }
        let best = found.number;
        // Under `First`, x is the best of all attempts already.
        if self.options.search != Search::First {
            found.number = 0;
        }
        self.settle(workspace, query, found);
        let stays = !self.options.leaps_on_miss();
        let nearby = stays && self.is_nearby(workspace);
        let mut has_stayed = false;
        if !found.reached && !self.asks_for_own_way(query.target) && !query.is_late() {
            let mut first = self.keep_first(workspace, found);
            found.number = best;
            workspace.x.copy_from_slice(&workspace.best);
            self.settle(workspace, query, found);
            if nearby && !found.reached && !query.is_late() {
                self.return_to_first(workspace, &first, found);
                self.stay_near(workspace, query, found);
                has_stayed = true;
                first = self.keep_first(workspace, found);
            }
            if !found.reached {
                self.make_attempts_left(workspace, query, found);
            }
            let lower = !stays && found.cost < first.0.cost;
            if !found.reached && !lower {
                self.return_to_first(workspace, &first, found);
            }
        }
        if !found.reached && stays && !has_stayed && !query.is_late() {
            self.stay_near(workspace, query, found);
        }
        found.termination = self.ended(found, query.is_late());
    }

    /// Continues the first attempt alone, whose end is in the workspace's x, as a search of one attempt does.
    pub(super) fn finish_first(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        found: &mut SearchResult,
    ) {
        self.settle(workspace, query, found);
        if !found.reached && !self.options.leaps_on_miss() && !query.is_late() {
            self.stay_near(workspace, query, found);
        }
    }

    /// Returns true if the target is near the tool at the start, so that the first attempt is finished before others
    /// begin.
    pub(super) fn is_nearby(&self, workspace: &mut ArmWorkspace) -> bool {
        // Taken out and put back, so that nothing is allocated.
        let start = std::mem::take(&mut workspace.start);
        let errors = workspace.judge(&start);
        workspace.start = start;
        let radians = MAX_NEARBY_ERROR * self.options.metres_per_radian;
        2.0 * self.cost(errors) < radians * radians
    }

    /// Saves the end of the first attempt, which is in the workspace's x.
    fn keep_first(
        &self,
        workspace: &mut ArmWorkspace,
        found: &SearchResult,
    ) -> (SearchResult, Errors) {
        let ArmWorkspace { kept, x, .. } = workspace;
        kept.copy_from_slice(x);
        (*found, workspace.errors)
    }

    /// Restores the saved end of the first attempt.
    fn return_to_first(
        &self,
        workspace: &mut ArmWorkspace,
        (first, errors): &(SearchResult, Errors),
        found: &mut SearchResult,
    ) {
        found.fall_back_to(first);
        let ArmWorkspace { kept, x, .. } = workspace;
        x.copy_from_slice(kept);
        workspace.errors = *errors;
    }

    /// Replaces an end far from the start by the minimum that short steps from the start lead to, if that is near.
    ///
    /// The long steps of an attempt may have passed it. An end near the start is only moved off a ridge.
    fn stay_near(&self, workspace: &mut ArmWorkspace, query: &Query<'_>, found: &mut SearchResult) {
        let moved = |workspace: &ArmWorkspace| self.longest_move(&workspace.start, &workspace.x).1;
        if moved(workspace) <= LONG_STEP {
            self.leave_ridge(workspace, query, found);
            return;
        }
        // Taken out and put back, so that nothing is allocated.
        let mut other = std::mem::take(&mut workspace.kept);
        other.copy_from_slice(&workspace.x);
        workspace.x.copy_from_slice(&workspace.start);
        let how = Settling::freely(NEAR_STEPS, query.deadline);
        let (_, steps) = workspace.settle_near(&how);
        found.iterations += steps;
        let near = moved(workspace) <= LONG_STEP;
        if near {
            other.copy_from_slice(&workspace.x);
            let (termination, iterations) = workspace.settle(query.deadline);
            found.iterations += iterations;
            found.termination = termination;
        }
        if moved(workspace) > LONG_STEP {
            workspace.x.copy_from_slice(&other);
        }
        workspace.kept = other;
        if near {
            self.judge(workspace, found);
        }
    }

    /// Continues from a perturbed configuration if an end near the start is a ridge.
    ///
    /// A stretched arm whose target is within reach is stationary there. The end stays unless the continuation reaches
    /// the target near the start.
    fn leave_ridge(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        found: &mut SearchResult,
    ) {
        let first = self.keep_first(workspace, found);
        if workspace.step_off_ridge() {
            self.settle(workspace, query, found);
            let near = self.longest_move(&workspace.start, &workspace.x).1 <= LONG_STEP;
            if !(found.reached && near) {
                self.return_to_first(workspace, &first, found);
            }
        }
    }

    /// Termination of a finished query.
    pub(super) fn ended(&self, found: &SearchResult, late: bool) -> Termination {
        if found.reached {
            Termination::Reached
        } else if late {
            Termination::TimeLimit
        } else if self.options.max_move.is_some() {
            Termination::CannotContinue
        } else {
            // The descent stopped as reached, but the error is slightly above the tolerance.
            match found.termination {
                Termination::Reached => Termination::SmallStep,
                other => other,
            }
        }
    }

    /// Runs the remaining attempts and continues the best of them.
    ///
    /// The better of its end and the workspace's x is then in x and `found`.
    fn make_attempts_left(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        found: &mut SearchResult,
    ) {
        let Some(lanes) = self.lanes_within(&workspace.bounded_lanes) else {
            return;
        };
        let first = u32::try_from(found.attempts).unwrap_or(u32::MAX);
        let spent = u32::try_from(found.iterations).unwrap_or(u32::MAX);
        let attempts = (first, self.options.attempts);
        let budget = self.options.budget().saturating_sub(spent.min(QUICK));
        if found.reached || query.is_late() || first >= attempts.1 || budget == 0 {
            return;
        }
        let left = self.lane_query(query, attempts, budget);
        let mut answer = simd_ik::Answer::of(&mut workspace.trial);
        let outcome = lanes.race(&left, false, &mut answer);
        let best_attempt = answer.best_attempt as usize;
        let more = self.found_by(&outcome);
        found.iterations += more.iterations;
        found.attempts += more.attempts;
        if more.reached {
            workspace.x.copy_from_slice(&workspace.trial);
            workspace.errors = Errors::of(&outcome);
            (found.number, found.cost, found.reached) = (more.number, more.cost, true);
        } else if more.cost < found.cost {
            workspace.x.copy_from_slice(&workspace.trial);
            found.number = best_attempt;
            self.settle(workspace, query, found);
        }
    }

    fn settle(&self, workspace: &mut ArmWorkspace, query: &Query<'_>, found: &mut SearchResult) {
        let (termination, iterations) = workspace.settle(query.deadline);
        found.iterations += iterations;
        found.termination = termination;
        self.unwrap_towards(query.start, workspace);
        self.judge(workspace, found);
    }
}
