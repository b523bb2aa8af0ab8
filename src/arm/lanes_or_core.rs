//! One question, from the fast way to the slower ones.

use super::Reply;
use super::arm::Arm;
use super::options::Search;
use super::workspace::{ArmWorkspace, Errors};
use crate::clock::{Instant, is_past};
use crate::ik::{RowsReport, Solution};
use crate::lanes::{self, PoseOutcome, PoseSolver};
use crate::problem::Anchor;
use crate::scalar::elementary;
use crate::search::Found;
use crate::solver::{Counts, Termination};
use crate::spatial::{Placement, Vector3};
use crate::task::Quantity;

/// Iterations after which the start's own end and the engine's best are first handed to the core,
/// whose damping by gain ratio comes through narrow valleys that the engine's does not.
pub(super) const QUICK: u32 = 600;

/// A question that is checked.
#[derive(Clone, Copy)]
pub(super) struct Query<'a> {
    pub(super) target: &'a Placement<f64>,
    pub(super) start: &'a [f64],
    pub(super) deadline: Option<Instant>,
}

impl Query<'_> {
    /// Whether less time than this is left.
    #[cfg(feature = "collision")]
    pub(super) fn is_late_by(&self, needed: std::time::Duration) -> bool {
        let earlier = |at: Instant| at.checked_sub(needed).unwrap_or(at);
        is_past(self.deadline.map(earlier))
    }

    pub(super) fn is_late(&self) -> bool {
        is_past(self.deadline)
    }
}

impl Arm {
    /// A question that begins now.
    pub(super) fn query<'a>(&self, target: &'a Placement<f64>, start: &'a [f64]) -> Query<'a> {
        Query {
            target,
            start,
            deadline: self.deadline(),
        }
    }

    /// Whether the lane engine's answer to a question is the arm's, if it reaches.
    pub(super) fn is_plain(&self) -> bool {
        let options = &self.options;
        options.max_move.is_none() && options.posture.is_none() && !options.search.compares()
    }

    /// Whether the end of the start's own way is all that is asked of a target: no attempt can reach it, and
    /// none but that one counts then.
    pub(super) fn asks_for_own_way(&self, target: &Placement<f64>) -> bool {
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

    /// The lane engine, within the bounds of moves where these are bounded.
    pub(super) fn lanes_within<'a>(
        &'a self,
        bounded: &'a Option<PoseSolver>,
    ) -> Option<&'a PoseSolver> {
        match bounded {
            Some(_) if self.options.max_move.is_some() => bounded.as_ref(),
            _ => self.lanes.as_ref(),
        }
    }

    /// Attempts of the lane engine at a question, from the first to before the last.
    pub(super) fn lane_query<'a>(
        &self,
        query: &Query<'a>,
        attempts: (u32, u32),
        budget: u32,
    ) -> lanes::Query<'a> {
        lanes::Query {
            target: query.target,
            start: query.start,
            search: self.options.search.lanes(),
            attempts,
            budget,
            deadline: query.deadline,
        }
    }

    fn first_attempts<'a>(&self, query: &Query<'a>) -> lanes::Query<'a> {
        let attempts = self.attempts_at(query.target);
        self.lane_query(query, (0, attempts), self.options.budget().min(QUICK))
    }

    /// Answers a question; what its attempts came to, and the errors where that is.
    pub(super) fn answer(
        &self,
        query: &Query<'_>,
        solution: &mut Solution,
    ) -> Reply<(Found, Errors)> {
        #[cfg(feature = "collision")]
        if let Some(collisions) = &self.collisions {
            return self.answer_clear_of(collisions, query, solution);
        }
        self.answer_anywhere(query, solution)
    }

    /// The same, whatever is in the way.
    pub(super) fn answer_anywhere(
        &self,
        query: &Query<'_>,
        solution: &mut Solution,
    ) -> Reply<(Found, Errors)> {
        let (Some(lanes), true) = (&self.lanes, self.is_plain()) else {
            return self.with_workspace(|workspace| self.answer_at(workspace, query, solution));
        };
        let n = self.joint_count();
        // The second half is for the best of all, where the start's own attempt misses.
        solution.q.resize(2 * n, 0.0);
        let (q, best) = solution.q.split_at_mut(n);
        let mut answer = lanes::Answer {
            q,
            best,
            best_attempt: 0,
        };
        let outcome = lanes.race(&self.first_attempts(query), false, &mut answer);
        let best_attempt = answer.best_attempt;
        let mut found = self.found_by(&outcome);
        if outcome.reached {
            solution.q.truncate(n);
            let errors = Errors::of(&outcome);
            self.tell(&found, errors, solution);
            return Ok((found, errors));
        }
        self.with_workspace(|workspace| {
            let (own, best) = solution.q.split_at(n);
            workspace.x.copy_from_slice(own);
            workspace.best.copy_from_slice(match self.options.search {
                Search::First => own,
                _ => best,
            });
            found.number = best_attempt as usize;
            workspace.aim(query.target);
            self.bound_moves(workspace, query.start);
            self.finish(workspace, query, &mut found);
            self.tell_place(&found, workspace, solution);
            (found, workspace.errors)
        })
    }

    /// Answers with a workspace: bounded moves, searches that compare, postures, chains with followers.
    fn answer_at(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        solution: &mut Solution,
    ) -> (Found, Errors) {
        workspace.aim(query.target);
        self.bound_moves(workspace, query.start);
        let mut found = if self.options.search.compares() {
            let ended = self.gather(workspace, query);
            self.nearest(workspace, query, ended)
        } else if self.lanes.is_some() {
            self.search_by_lanes(workspace, query)
        } else {
            self.search_by_core(workspace, query)
        };
        self.finish(workspace, query, &mut found);
        if let (true, Some(posture)) = (found.reached, &self.options.posture) {
            self.descend(workspace, posture, query.deadline);
            self.judge(workspace, &mut found);
        }
        self.tell_place(&found, workspace, solution);
        (found, workspace.errors)
    }

    /// The engine's own search, into the workspace's x; after a miss that is where the start's own attempt
    /// ended, and the workspace's best is the best of all, of the number that is found.
    fn search_by_lanes(&self, workspace: &mut ArmWorkspace, query: &Query<'_>) -> Found {
        let ArmWorkspace {
            bounded_lanes,
            x,
            best,
            ..
        } = workspace;
        let mut first = self.first_attempts(query);
        // Within bounded moves the start's own way is tried to its end before others are.
        let lone = self.options.max_move.is_some();
        if lone {
            first.attempts.1 = 1;
        }
        let Some(lanes) = self.lanes_within(bounded_lanes) else {
            return Found::default();
        };
        let mut answer = lanes::Answer {
            q: x,
            best,
            best_attempt: 0,
        };
        let outcome = lanes.race(&first, lone, &mut answer);
        let best_attempt = answer.best_attempt;
        if self.options.search == Search::First {
            best.copy_from_slice(x);
        }
        workspace.errors = Errors::of(&outcome);
        Found {
            number: outcome.winner.unwrap_or(best_attempt) as usize,
            ..self.found_by(&outcome)
        }
    }

    /// What the lane engine's attempts came to. Those that miss were given up where they stalled.
    pub(super) fn found_by(&self, outcome: &PoseOutcome) -> Found {
        Found {
            termination: match outcome.reached {
                true => Termination::Reached,
                false => Termination::Stalled,
            },
            number: outcome.winner.unwrap_or(0) as usize,
            cost: self.cost(Errors::of(outcome)),
            reached: outcome.reached,
            iterations: outcome.iterations as usize,
            attempts: outcome.attempts as usize,
            ..Found::default()
        }
    }

    /// Takes the errors at the workspace's x as those of what is found.
    pub(super) fn judge(&self, workspace: &mut ArmWorkspace, found: &mut Found) {
        let errors = workspace.judge_x();
        (found.cost, found.reached) = (self.cost(errors), errors.reached);
    }

    /// Half the squared errors, a radian weighing as much as so many metres.
    pub(super) fn cost(&self, errors: Errors) -> f64 {
        // Goals that leave room are solved in chords.
        let turned = match self.options.goal.is_full_pose() {
            true => errors.orientation,
            false => 2.0 * elementary::sin(0.5 * errors.orientation),
        };
        let turned = turned * self.options.metres_per_radian;
        0.5 * (errors.position * errors.position + turned * turned)
    }

    /// Fills everything in but `q` and what is in the way of a miss.
    pub(super) fn tell(&self, found: &Found, errors: Errors, solution: &mut Solution) {
        let options = &self.options;
        let metres = RowsReport::of_goal(
            Quantity::Metres,
            errors.position,
            options.position_tolerance,
        );
        let turned = options.orientation_tolerance;
        let radians = RowsReport::of_goal(Quantity::Radians, errors.orientation, turned);
        let metres = options.goal.has_position().then_some(metres);
        let radians = options.goal.has_orientation().then_some(radians);
        solution.tell_errors(&self.names, metres.into_iter().chain(radians));
        solution.cost = found.cost;
        solution.tell(&Found {
            // An iteration takes a residual and a Jacobian, in the lanes as in the core.
            counts: Counts {
                residuals: found.iterations,
                jacobians: found.iterations,
                gradients: 0,
            },
            projected_gradient: None,
            agreeing: 0,
            ..*found
        });
    }

    /// Fills everything in from the workspace's configuration, naming what is in the way of a miss.
    pub(super) fn tell_place(
        &self,
        found: &Found,
        workspace: &mut ArmWorkspace,
        solution: &mut Solution,
    ) {
        workspace.x.clone_into(&mut solution.q);
        self.tell(found, workspace.errors, solution);
        if !solution.reached {
            let negligible = workspace.take_slope();
            let (x, question) = (&workspace.x, workspace.question.ask());
            solution.tell_limits(question, x, &workspace.gradient, negligible);
            solution.projected_gradient = Some(workspace.projected_gradient(x));
            solution.find_beyond(question);
        }
    }
}

impl Errors {
    /// Of the lane engine's answer.
    pub(super) fn of(outcome: &PoseOutcome) -> Self {
        Self {
            position: outcome.position_error,
            orientation: outcome.orientation_error,
            reached: outcome.reached,
        }
    }
}
