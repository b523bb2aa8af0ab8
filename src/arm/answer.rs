//! One question, from the fast way to the slower ones.

use std::time::Instant;

use super::QueryError;
use super::follower::LONG_STEP;
use super::options::Search;
use super::query::Arm;
use super::report::Reply;
use super::settle::Settling;
use super::workspace::{Errors, Workspace};
use crate::ik::Solution;
use crate::lanes;
use crate::problem::Anchor;
use crate::solver::Termination;
use crate::spatial::{Placement, Vector3};

/// Iterations after which the start's own end and the engine's best are first handed to the core,
/// whose damping by gain ratio comes through narrow valleys that the engine's does not.
pub(super) const QUICK: u32 = 600;
/// Short steps from the start to a place near it.
const NEAR_STEPS: usize = 100;

impl Arm {
    /// Whether the lane engine's answer to a question is the arm's, if it reaches.
    pub(super) fn is_plain(&self) -> bool {
        let options = &self.options;
        options.max_move.is_none() && options.posture.is_none() && !options.search.compares()
    }

    /// Whether the end of the start's own way is all that is asked of a target: no attempt can reach it, and
    /// none but that one counts then.
    fn asks_for_own_way(&self, target: &Placement<f64>) -> bool {
        let options = &self.options;
        if options.attempts_asked || options.leaps_on_miss() || !options.goal.is_exact_in_position()
        {
            return false;
        }
        let anchor = self.names.anchors.first().and_then(Option::as_ref);
        let tolerance = options.position_tolerance;
        let beyond =
            |anchor: &Anchor| anchor.falls_short_of(target.translation, Vector3::zero(), tolerance);
        anchor.and_then(beyond).is_some()
    }

    /// How many attempts at a target are made at most.
    pub(super) fn attempts_at(&self, target: &Placement<f64>) -> u32 {
        match self.asks_for_own_way(target) {
            true => 1,
            false => self.options.attempts,
        }
    }

    /// Answers a question that is checked.
    pub(super) fn answer(
        &self,
        target: &Placement<f64>,
        start: &[f64],
        solution: &mut Solution,
    ) -> Result<Reply, QueryError> {
        let deadline = self.deadline();
        let (Some(lanes), true) = (&self.lanes, self.is_plain()) else {
            return self.with_workspace(|workspace| {
                self.answer_at(workspace, target, start, deadline, solution)
            });
        };
        let n = self.joint_count();
        // The second half is for the best of all, where the start's own attempt misses.
        solution.q.resize(2 * n, 0.0);
        let (q, best) = solution.q.split_at_mut(n);
        let query = self.first_attempts(target, start, deadline);
        let mut answer = lanes::Answer {
            q,
            best,
            best_attempt: 0,
        };
        let outcome = lanes.race(&query, false, &mut answer);
        let best_attempt = answer.best_attempt;
        let mut reply = Reply::of(&outcome);
        if outcome.reached {
            solution.q.truncate(n);
            self.report(&reply, solution);
            return Ok(reply);
        }
        self.with_workspace(|workspace| {
            let (own, best) = solution.q.split_at(n);
            workspace.x.copy_from_slice(own);
            workspace.best.copy_from_slice(match self.options.search {
                Search::First => own,
                _ => best,
            });
            reply.winner = Some(best_attempt);
            workspace.aim(target);
            self.open_window(workspace, start);
            self.finish(workspace, target, start, &mut reply, deadline);
            self.report_workspace(&reply, workspace, solution);
            reply
        })
    }

    /// The engine's first attempts at a question.
    fn first_attempts<'a>(
        &self,
        target: &'a Placement<f64>,
        start: &'a [f64],
        deadline: Option<Instant>,
    ) -> lanes::Query<'a> {
        lanes::Query {
            target,
            start,
            search: self.options.search.lanes(),
            attempts: (0, self.attempts_at(target)),
            budget: self.options.budget().min(QUICK),
            deadline,
        }
    }

    /// Answers with a workspace: bounded moves, searches that compare, postures, chains with followers.
    fn answer_at(
        &self,
        workspace: &mut Workspace,
        target: &Placement<f64>,
        start: &[f64],
        deadline: Option<Instant>,
        solution: &mut Solution,
    ) -> Reply {
        workspace.aim(target);
        self.open_window(workspace, start);
        let mut reply = if self.options.search.compares() {
            let ended = self.gather(workspace, target, start, deadline);
            self.nearest(workspace, ended, deadline)
        } else {
            self.one_search(workspace, target, start, deadline)
        };
        self.finish(workspace, target, start, &mut reply, deadline);
        if let (true, Some(posture)) = (reply.errors.reached, &self.options.posture) {
            self.descend(workspace, posture, deadline);
            reply.errors = workspace.judge_x();
        }
        self.report_workspace(&reply, workspace, solution);
        reply
    }

    /// The engine's or the core's own search, into the workspace's x; after a miss that is where the
    /// start's own attempt ended, and the workspace's best is the best of all: the reply's winner.
    fn one_search(
        &self,
        workspace: &mut Workspace,
        target: &Placement<f64>,
        start: &[f64],
        deadline: Option<Instant>,
    ) -> Reply {
        let Some(lanes) = &self.lanes else {
            let reply = self.search_by_core(workspace, start, deadline);
            if !reply.errors.reached {
                workspace.best.copy_from_slice(&workspace.x);
                workspace.x.copy_from_slice(&workspace.start);
            }
            return reply;
        };
        let Workspace {
            windowed, x, best, ..
        } = workspace;
        let mut query = self.first_attempts(target, start, deadline);
        let mut lone = false;
        let lanes = match windowed {
            Some(windowed) if self.options.max_move.is_some() => {
                // Within bounded moves the start's own way is tried to its end before others are.
                query.attempts.1 = 1;
                lone = true;
                windowed
            }
            _ => lanes,
        };
        let mut answer = lanes::Answer {
            q: x,
            best,
            best_attempt: 0,
        };
        let outcome = lanes.race(&query, lone, &mut answer);
        let best_attempt = answer.best_attempt;
        if self.options.search == Search::First {
            best.copy_from_slice(x);
        }
        Reply {
            winner: outcome.winner.or(Some(best_attempt)),
            ..Reply::of(&outcome)
        }
    }

    /// Takes a miss to the place where nothing near is better: first the start's own way, whose end is
    /// in the workspace's x, then, for a target that it does not reach, the best of all attempts and
    /// the attempts that are left. A target that none reaches is answered by the start's own end,
    /// unless the arm searches everywhere on a miss.
    pub(super) fn finish(
        &self,
        workspace: &mut Workspace,
        target: &Placement<f64>,
        start: &[f64],
        reply: &mut Reply,
        deadline: Option<Instant>,
    ) {
        if reply.errors.reached {
            return;
        }
        let late = || deadline.is_some_and(|at| Instant::now() >= at);
        let best = reply.winner;
        // Under `First` the own end is the best of all.
        reply.winner = match self.options.search {
            Search::First => best,
            _ => Some(0),
        };
        let mut termination = self.settle(workspace, reply, deadline);
        if !reply.errors.reached && !self.asks_for_own_way(target) && !late() {
            let own = reply.errors;
            // Taken out and put back, so that nothing is allocated.
            let mut kept = std::mem::take(&mut workspace.kept);
            kept.copy_from_slice(&workspace.x);
            reply.winner = best;
            let other = self.search_elsewhere(workspace, target, start, reply, deadline);
            let lower = |errors: Errors, than: Errors| self.cost_of(errors) < self.cost_of(than);
            if reply.errors.reached || self.options.leaps_on_miss() && lower(reply.errors, own) {
                termination = other;
            } else {
                reply.errors = own;
                workspace.x.copy_from_slice(&kept);
            }
            workspace.kept = kept;
        }
        if !reply.errors.reached {
            reply.winner = None;
            if self.options.search != Search::First && !self.options.leaps_on_miss() && !late() {
                termination = self
                    .stay_near(workspace, reply, deadline)
                    .unwrap_or(termination);
            }
        }
        reply.termination = self.ended(reply.errors, termination, late());
    }

    /// Replaces an end far from the start by the nearest place that short steps from the start lead to, if that
    /// is near: an attempt's long steps may have led past it. How that ended.
    fn stay_near(
        &self,
        workspace: &mut Workspace,
        reply: &mut Reply,
        deadline: Option<Instant>,
    ) -> Option<Termination> {
        let moved = |workspace: &Workspace| self.longest_move(&workspace.start, &workspace.x).1;
        if moved(workspace) <= LONG_STEP {
            return None;
        }
        // Taken out and put back, so that nothing is allocated.
        let mut other = std::mem::take(&mut workspace.kept);
        other.copy_from_slice(&workspace.x);
        workspace.x.copy_from_slice(&workspace.start);
        let how = Settling {
            steps: NEAR_STEPS,
            anchor: 0.0,
            deadline,
        };
        let (_, steps) = workspace.settle_near(&how);
        reply.iterations += steps;
        let near = moved(workspace) <= LONG_STEP;
        let mut ended = None;
        if near {
            other.copy_from_slice(&workspace.x);
            let (termination, iterations) = workspace.settle(deadline);
            reply.iterations += iterations;
            ended = Some(termination);
        }
        if moved(workspace) > LONG_STEP {
            workspace.x.copy_from_slice(&other);
        }
        workspace.kept = other;
        if near {
            reply.errors = workspace.judge_x();
        }
        ended
    }

    /// How a question ended that was taken to its end.
    pub(super) fn ended(
        &self,
        errors: Errors,
        termination: Termination,
        late: bool,
    ) -> Termination {
        if errors.reached {
            Termination::Reached
        } else if late {
            Termination::TimeLimit
        } else if self.options.max_move.is_some() {
            Termination::CannotContinue
        } else {
            // A hair's breadth short of the tolerance is not reached.
            match termination {
                Termination::Reached => Termination::SmallStep,
                other => other,
            }
        }
    }

    /// Settles from the workspace's best, then runs the attempts that are left and settles from their
    /// best; the lower of the two ends is in x and in the reply.
    fn search_elsewhere(
        &self,
        workspace: &mut Workspace,
        target: &Placement<f64>,
        start: &[f64],
        reply: &mut Reply,
        deadline: Option<Instant>,
    ) -> Termination {
        workspace.x.copy_from_slice(&workspace.best);
        let termination = self.settle(workspace, reply, deadline);
        let Some(lanes) = &self.lanes else {
            return termination;
        };
        let first = u32::try_from(reply.attempts).unwrap_or(u32::MAX);
        let spent = u32::try_from(reply.iterations).unwrap_or(u32::MAX);
        let query = lanes::Query {
            target,
            start,
            search: self.options.search.lanes(),
            attempts: (first, self.options.attempts),
            budget: self.options.budget().saturating_sub(spent.min(QUICK)),
            deadline,
        };
        let late = deadline.is_some_and(|at| Instant::now() >= at);
        if reply.errors.reached || late || first >= query.attempts.1 || query.budget == 0 {
            return termination;
        }
        let Workspace {
            windowed, trial, ..
        } = &mut *workspace;
        let lanes = match windowed {
            Some(windowed) if self.options.max_move.is_some() => windowed,
            _ => lanes,
        };
        let mut answer = lanes::Answer::of(trial);
        let more = lanes.race(&query, false, &mut answer);
        let best_attempt = answer.best_attempt;
        reply.iterations += more.iterations as usize;
        reply.attempts += more.attempts as usize;
        if more.reached {
            workspace.x.copy_from_slice(&workspace.trial);
            reply.errors = Reply::of(&more).errors;
            reply.winner = more.winner;
        } else if self.cost(more.position_error, more.orientation_error)
            < self.cost_of(reply.errors)
        {
            workspace.x.copy_from_slice(&workspace.trial);
            reply.winner = Some(best_attempt);
            return self.settle(workspace, reply, deadline);
        }
        termination
    }

    pub(super) fn cost_of(&self, errors: Errors) -> f64 {
        self.cost(errors.position, errors.orientation)
    }

    fn settle(
        &self,
        workspace: &mut Workspace,
        reply: &mut Reply,
        deadline: Option<Instant>,
    ) -> Termination {
        let (termination, iterations) = workspace.settle(deadline);
        reply.iterations += iterations;
        reply.errors = workspace.judge_x();
        termination
    }
}
