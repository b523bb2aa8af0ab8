//! One question, from the fast way to the slower ones.

use std::time::Instant;

use super::QueryError;
use super::desk::Desk;
use super::query::Arm;
use super::report::Reply;
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

    /// Answers a question that is checked. `follow` takes the start's own attempt alone if it
    /// succeeds, whatever the search.
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
            return self.with_desk(|desk| {
                self.answer_at(desk, target, start, follow, deadline, solution);
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
        if outcome.reached && !(follow && outcome.winner != Some(0)) {
            self.report(&reply, solution);
            return Ok(());
        }
        if outcome.reached {
            // The start's own attempt failed: of all rescues the nearest keeps a path together.
            return self.with_desk(|desk| {
                desk.aim(target);
                self.open_window(desk, start);
                self.gather(desk, target, start, deadline);
                let reply = self.nearest(desk, target, start, deadline);
                let rescued = self.distance(&solution.q, &desk.start);
                if reply.errors.reached && self.distance(&desk.x, &desk.start) < rescued {
                    self.report_desk(&reply, desk, solution);
                } else {
                    self.report(&Reply::of(&outcome), solution);
                }
            });
        }
        self.with_desk(|desk| self.explain_miss(desk, target, start, reply, deadline, solution))
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
        desk: &mut Desk,
        target: &Placement<f64>,
        start: &[f64],
        mut reply: Reply,
        deadline: Option<Instant>,
        solution: &mut Solution,
    ) {
        desk.aim(target);
        self.open_window(desk, start);
        desk.x.copy_from_slice(&solution.q);
        self.finish(desk, target, start, &mut reply, deadline);
        self.report_desk(&reply, desk, solution);
    }

    /// Answers with a desk: bounded moves, searches that compare, postures, chains with followers.
    fn answer_at(
        &self,
        desk: &mut Desk,
        target: &Placement<f64>,
        start: &[f64],
        follow: bool,
        deadline: Option<Instant>,
        solution: &mut Solution,
    ) {
        desk.aim(target);
        self.open_window(desk, start);
        let compares = self.options.search.compares() && !follow;
        let mut reply = if compares {
            self.gather(desk, target, start, deadline);
            self.nearest(desk, target, start, deadline)
        } else {
            self.one_search(desk, target, start, follow, deadline)
        };
        self.finish(desk, target, start, &mut reply, deadline);
        if let (true, Some(posture)) = (reply.errors.reached, &self.options.posture) {
            self.descend(desk, posture, deadline);
            reply.errors = desk.judge_x();
        }
        self.report_desk(&reply, desk, solution);
    }

    /// The engine's or the core's own search, into the desk's x.
    pub(super) fn one_search(
        &self,
        desk: &mut Desk,
        target: &Placement<f64>,
        start: &[f64],
        follow: bool,
        deadline: Option<Instant>,
    ) -> Reply {
        let Some(lanes) = &self.lanes else {
            return self.search_by_core(desk, start, deadline);
        };
        let search = self.lane_search(follow);
        let Desk { windowed, x, .. } = desk;
        let lanes = match windowed {
            Some(windowed) if self.options.max_move.is_some() => windowed,
            _ => lanes,
        };
        Reply::of(&lanes.solve_checked(target, start, search, QUICK, deadline, follow, x))
    }

    /// Takes a miss to the place where nothing near is better, and names how it ended.
    pub(super) fn finish(
        &self,
        desk: &mut Desk,
        target: &Placement<f64>,
        start: &[f64],
        reply: &mut Reply,
        deadline: Option<Instant>,
    ) {
        if reply.errors.reached {
            return;
        }
        let late = || deadline.is_some_and(|at| Instant::now() >= at);
        let mut termination = self.settle(desk, reply, deadline);
        if let (false, Some(lanes)) = (reply.errors.reached || late(), &self.lanes) {
            // More attempts, and again from the best of all.
            let cost = self.cost(reply.errors.position, reply.errors.orientation);
            let Desk {
                windowed, trial, ..
            } = &mut *desk;
            let lanes = match windowed {
                Some(windowed) if self.options.max_move.is_some() => windowed,
                _ => lanes,
            };
            let search = lanes::Search::First;
            let more = lanes.solve_checked(target, start, search, PATIENT, deadline, false, trial);
            reply.iterations += more.iterations as usize;
            reply.attempts = reply.attempts.max(more.attempts as usize);
            if more.reached {
                desk.x.copy_from_slice(&desk.trial);
                reply.errors = Reply::of(&more).errors;
            } else if self.cost(more.position_error, more.orientation_error) < cost {
                desk.x.copy_from_slice(&desk.trial);
                termination = self.settle(desk, reply, deadline);
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

    fn settle(&self, desk: &mut Desk, reply: &mut Reply, deadline: Option<Instant>) -> Termination {
        let (termination, iterations) = desk.settle(deadline);
        reply.iterations += iterations;
        reply.errors = desk.judge_x();
        termination
    }
}
