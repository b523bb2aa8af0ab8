//! One question, from the fast way to the slower ones.

use std::time::Instant;

use super::QueryError;
use super::query::Arm;
use super::report::Reply;
use super::workspace::Workspace;
use crate::ik::Solution;
use crate::lanes;
use crate::solver::Termination;
use crate::spatial::Placement;

/// Iterations after which the engine's best is first handed to the core, whose damping by gain
/// ratio comes through narrow valleys that the engine's does not.
pub(super) const QUICK: u32 = 600;
/// Iterations of the engine where that did not help.
const PATIENT: u32 = 2000;

impl Arm {
    /// Whether the lane engine's answer to a question is the arm's, if it reaches.
    pub(super) fn is_plain(&self) -> bool {
        let options = &self.options;
        options.max_move.is_none() && options.posture.is_none() && !options.search.compares()
    }

    /// Answers a question that is checked. `follow` wants the solution nearest to the start, whatever
    /// the search.
    pub(super) fn answer(
        &self,
        target: &Placement<f64>,
        start: &[f64],
        follow: bool,
        solution: &mut Solution,
    ) -> Result<(), QueryError> {
        let deadline = self.deadline();
        let options = &self.options;
        let alone = options.max_move.is_none() && options.posture.is_none();
        let (Some(lanes), true) = (&self.lanes, self.is_plain() || follow && alone) else {
            return self.with_workspace(|workspace| {
                self.answer_at(workspace, target, start, follow, deadline, solution);
            });
        };
        let search = self.lane_search(follow);
        solution.q.resize(self.joint_count(), 0.0);
        let outcome = lanes.solve_checked(
            target,
            start,
            search,
            QUICK,
            deadline,
            follow,
            &mut solution.q,
        );
        let reply = Reply::of(&outcome);
        if outcome.reached && !follow {
            self.report(&reply, solution);
            return Ok(());
        }
        if outcome.reached {
            // The start's own attempt led far away: the nearest of all keeps a path together.
            return self.with_workspace(|workspace| {
                workspace.aim(target);
                self.open_window(workspace, start);
                self.gather(workspace, target, start, deadline);
                let ended = Termination::Reached;
                let reply = self.nearest(workspace, target, start, ended, deadline);
                let rescued = self.distance(&solution.q, &workspace.start);
                if reply.errors.reached && self.distance(&workspace.x, &workspace.start) < rescued {
                    self.report_workspace(&reply, workspace, solution);
                } else {
                    self.report(&Reply::of(&outcome), solution);
                }
            });
        }
        self.with_workspace(|workspace| {
            self.explain_miss(workspace, target, start, reply, deadline, solution)
        })
    }

    pub(super) fn lane_search(&self, follow: bool) -> lanes::Search {
        if follow {
            lanes::Search::Start
        } else {
            self.options.search.lanes()
        }
    }

    /// Goes on from the best configuration that the engine left in the solution, and reports it.
    pub(super) fn explain_miss(
        &self,
        workspace: &mut Workspace,
        target: &Placement<f64>,
        start: &[f64],
        mut reply: Reply,
        deadline: Option<Instant>,
        solution: &mut Solution,
    ) {
        workspace.aim(target);
        self.open_window(workspace, start);
        workspace.x.copy_from_slice(&solution.q);
        self.finish(workspace, target, start, &mut reply, deadline);
        self.report_workspace(&reply, workspace, solution);
    }

    /// Answers with a workspace: bounded moves, searches that compare, postures, chains with followers.
    fn answer_at(
        &self,
        workspace: &mut Workspace,
        target: &Placement<f64>,
        start: &[f64],
        follow: bool,
        deadline: Option<Instant>,
        solution: &mut Solution,
    ) {
        workspace.aim(target);
        self.open_window(workspace, start);
        let compares = self.options.search.compares() && !follow;
        let mut reply = if compares {
            let ended = self.gather(workspace, target, start, deadline);
            self.nearest(workspace, target, start, ended, deadline)
        } else {
            self.one_search(workspace, target, start, follow, deadline)
        };
        self.finish(workspace, target, start, &mut reply, deadline);
        if let (true, Some(posture)) = (reply.errors.reached, &self.options.posture) {
            self.descend(workspace, posture, deadline);
            reply.errors = workspace.judge_x();
        }
        self.report_workspace(&reply, workspace, solution);
    }

    /// The engine's or the core's own search, into the workspace's x.
    pub(super) fn one_search(
        &self,
        workspace: &mut Workspace,
        target: &Placement<f64>,
        start: &[f64],
        follow: bool,
        deadline: Option<Instant>,
    ) -> Reply {
        let Some(lanes) = &self.lanes else {
            return self.search_by_core(workspace, start, deadline);
        };
        let search = self.lane_search(follow);
        let Workspace { windowed, x, .. } = workspace;
        let lanes = match windowed {
            Some(windowed) if self.options.max_move.is_some() => windowed,
            _ => lanes,
        };
        Reply::of(&lanes.solve_checked(target, start, search, QUICK, deadline, follow, x))
    }

    /// Takes a miss to the place where nothing near is better, and names how it ended.
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
        let mut termination = self.settle(workspace, reply, deadline);
        if let (false, Some(lanes)) = (reply.errors.reached || late(), &self.lanes) {
            // More attempts, and again from the best of all.
            let cost = self.cost(reply.errors.position, reply.errors.orientation);
            let Workspace {
                windowed, trial, ..
            } = &mut *workspace;
            let lanes = match windowed {
                Some(windowed) if self.options.max_move.is_some() => windowed,
                _ => lanes,
            };
            let search = lanes::Search::First;
            let more = lanes.solve_checked(target, start, search, PATIENT, deadline, false, trial);
            reply.iterations += more.iterations as usize;
            reply.attempts = reply.attempts.max(more.attempts as usize);
            if more.reached {
                workspace.x.copy_from_slice(&workspace.trial);
                reply.errors = Reply::of(&more).errors;
            } else if self.cost(more.position_error, more.orientation_error) < cost {
                workspace.x.copy_from_slice(&workspace.trial);
                termination = self.settle(workspace, reply, deadline);
            }
        }
        reply.termination = if reply.errors.reached {
            Termination::Reached
        } else if late() {
            Termination::TimeLimit
        } else if self.options.max_move.is_some() {
            Termination::CannotContinue
        } else {
            // A hair's breadth short of the tolerance is not reached.
            match termination {
                Termination::Reached => Termination::SmallStep,
                other => other,
            }
        };
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
