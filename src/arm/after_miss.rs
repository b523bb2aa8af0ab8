//! What is done where the first attempts at a question miss.

use super::arm::Arm;
use super::follower::LONG_STEP;
use super::lanes_or_core::{QUICK, Query};
use super::options::Search;
use super::settling::Settling;
use super::workspace::{ArmWorkspace, Errors};
use crate::lanes;
use crate::search::Found;
use crate::solver::Termination;

/// Short steps from the start to a place near it.
const NEAR_STEPS: usize = 100;

impl Arm {
    /// Takes a miss to the place where nothing near is better: first the start's own way, whose end is
    /// in the workspace's x, then, for a target that it does not reach, the best of all attempts and
    /// the attempts that are left. A target that none reaches is answered by the start's own end,
    /// unless the arm searches everywhere on a miss.
    pub(super) fn finish(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        found: &mut Found,
    ) {
        if found.reached {
            return;
        }
        let best = found.number;
        // Under `First` the own end is the best of all.
        if self.options.search != Search::First {
            found.number = 0;
        }
        self.settle(workspace, query, found);
        if !found.reached && !self.asks_for_own_way(query.target) && !query.is_late() {
            let (own, errors) = (*found, workspace.errors);
            // Taken out and put back, so that nothing is allocated.
            let mut kept = std::mem::take(&mut workspace.kept);
            kept.copy_from_slice(&workspace.x);
            found.number = best;
            self.search_elsewhere(workspace, query, found);
            let lower = self.options.leaps_on_miss() && found.cost < own.cost;
            if !found.reached && !lower {
                found.fall_back_to(&own);
                workspace.errors = errors;
                workspace.x.copy_from_slice(&kept);
            }
            workspace.kept = kept;
        }
        if !found.reached && !self.options.leaps_on_miss() && !query.is_late() {
            self.stay_near(workspace, query, found);
        }
        found.termination = self.ended(found, query.is_late());
    }

    /// Replaces an end far from the start by the nearest place that short steps from the start lead to, if that
    /// is near: an attempt's long steps may have led past it.
    fn stay_near(&self, workspace: &mut ArmWorkspace, query: &Query<'_>, found: &mut Found) {
        let moved = |workspace: &ArmWorkspace| self.longest_move(&workspace.start, &workspace.x).1;
        if moved(workspace) <= LONG_STEP {
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

    /// How a question ended that was taken to its end.
    pub(super) fn ended(&self, found: &Found, late: bool) -> Termination {
        if found.reached {
            Termination::Reached
        } else if late {
            Termination::TimeLimit
        } else if self.options.max_move.is_some() {
            Termination::CannotContinue
        } else {
            // A hair's breadth short of the tolerance is not reached.
            match found.termination {
                Termination::Reached => Termination::SmallStep,
                other => other,
            }
        }
    }

    /// Settles from the workspace's best, then runs the attempts that are left and settles from their
    /// best; the lower of the two ends is in x and found.
    fn search_elsewhere(&self, workspace: &mut ArmWorkspace, query: &Query<'_>, found: &mut Found) {
        workspace.x.copy_from_slice(&workspace.best);
        self.settle(workspace, query, found);
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
        let mut answer = lanes::Answer::of(&mut workspace.trial);
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

    fn settle(&self, workspace: &mut ArmWorkspace, query: &Query<'_>, found: &mut Found) {
        let (termination, iterations) = workspace.settle(query.deadline);
        found.iterations += iterations;
        found.termination = termination;
        self.unwrap_towards(query.start, workspace);
        self.judge(workspace, found);
    }
}
