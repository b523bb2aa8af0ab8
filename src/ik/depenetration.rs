//! Escape from penetration that local steps cannot resolve.
//!
//! Each side of a plate repels the links near it, so an arm that pierces the plate can converge there. Each idle frame
//! then attempts one collision-free solution, from perturbations of increasing size. The following frames move to a
//! solution in a straight line through the penetrated obstacle, within the joint step limit of a frame. Motions through
//! other obstacles are accepted only after many attempts found none.

use super::Drag;
use super::drag_frame::solve;
use super::joint_interpolation::{furthest_move, go_share};
use crate::problem::{AnyClearanceCheck, CollisionConstraint, ProblemInstance};
use crate::random::RandomStream;

/// Maximum number of attempts per local minimum.
const TRIES: usize = 64;
/// Number of attempts whose motion may collide only with the pairs that are in collision at the start.
const TRIES_PAST_OTHERS: usize = 40;
/// Increment of the perturbation size per attempt, radians.
const FARTHER: f64 = 0.05;
/// Decrease of the penetration per frame that counts as no progress, metres.
const NO_LESS: f64 = 1e-6;
/// Joint displacement between two checked configurations of a motion, radians.
const LOOKED_AT_EVERY: f64 = 0.01;

/// State of the escape.
#[derive(Clone, Debug, Default)]
pub(super) struct WayOutOfContact {
    /// Number of attempts made at this local minimum.
    tries: usize,
    /// Variables of a collision-free solution.
    end: Vec<f64>,
    /// True if `end` is known.
    known: bool,
}

impl WayOutOfContact {
    /// Creates the state for a problem with `variables` variables.
    pub(super) fn new(variables: usize) -> Self {
        Self {
            end: Vec::with_capacity(variables),
            ..Self::default()
        }
    }

    /// Resets the state.
    pub(super) fn clear(&mut self) {
        (self.tries, self.known) = (0, false);
    }
}

impl Drag {
    /// Returns whether following frames attempt an escape or move along one.
    pub(super) fn seeks_way_out_of_contact(&self) -> bool {
        let way = &self.way_out_of_contact;
        self.touches && self.problem.fence().is_some() && (way.known || way.tries < TRIES)
    }

    /// Runs one attempt if a frame changed the distance of the deepest pair, metres, from `before` to `after` without
    /// progress.
    pub(super) fn seek_way_out_of_contact(
        &mut self,
        fence: &CollisionConstraint,
        check: &mut dyn AnyClearanceCheck,
        (before, after): (f64, f64),
    ) {
        if after > before + NO_LESS {
            self.way_out_of_contact.clear();
            return;
        }
        if self.way_out_of_contact.tries == TRIES {
            return;
        }
        self.way_out_of_contact.tries += 1;
        let tries = self.way_out_of_contact.tries;
        let mut random = RandomStream::new(2, tries as u64);
        let start = &mut self.way_out_of_contact.end;
        start.clone_from(&self.x);
        for (value, unit) in start.iter_mut().zip(&self.unit) {
            *value += unit * FARTHER * tries as f64 * (2.0 * random.unit() - 1.0);
        }
        let question = ProblemInstance::from(&self.problem).with_targets(&self.targets);
        question.space().project(start);
        let map = self.problem.parameters();
        let mut q = self.q_before.clone();
        map.scatter_within_limits(start, &mut q);
        let solver = self.way_out_solvers.attempt();
        solve(
            solver,
            question.fenced(fence.holding()),
            &q,
            &mut self.trial,
        );
        let trial = &self.trial.solution;
        self.workspace.solution.iterations += trial.iterations;
        self.workspace.solution.counts += trial.counts;
        let finite = trial.q.iter().all(|value| value.is_finite());
        let free = finite && check.is_free(&trial.q);
        map.gather(&trial.q, &mut self.way_out_of_contact.end);
        self.way_out_of_contact.known =
            free && (tries > TRIES_PAST_OTHERS || self.meets_nothing_else(check));
    }

    /// Returns whether the linear motion to the solution collides only with the pairs that are in collision at its
    /// start.
    fn meets_nothing_else(&self, check: &mut dyn AnyClearanceCheck) -> bool {
        let (map, space) = (
            self.problem.parameters(),
            ProblemInstance::from(&self.problem).space(),
        );
        let mut q = self.workspace.solution.q.clone();
        let touched = check.collisions(&q);
        let end = &self.way_out_of_contact.end;
        let mut from = self.x.clone();
        map.gather(&q, &mut from);
        let (mut way, mut x) = (from.clone(), from.clone());
        let far = furthest_move(&self.problem, &self.unit, [&from, end], &mut way);
        let looks = (far.map_or(0.0, |(_, far)| far) / LOOKED_AT_EVERY).ceil();
        (1..looks as usize).all(|look| {
            let share = look as f64 / looks;
            go_share(space, [&from, end], share, &mut way, &mut x);
            map.scatter_within_limits(&x, &mut q);
            let met = check.collisions(&q);
            met.iter()
                .all(|pair| touched.iter().any(|own| own.is_of_same_pair(pair)))
        })
    }

    /// Returns the variables one frame closer to the known collision-free solution, if there is one.
    pub(super) fn go_out_of_contact(&mut self) -> Option<Vec<f64>> {
        if !self.way_out_of_contact.known {
            return None;
        }
        let [_, way] = &mut self.before;
        let ends = [self.x.as_slice(), &self.way_out_of_contact.end];
        let far = furthest_move(&self.problem, &self.unit, ends, way).map_or(0.0, |(_, far)| far);
        let share = (self.max_move / far).min(1.0);
        let mut to = self.x.clone();
        go_share(
            ProblemInstance::from(&self.problem).space(),
            ends,
            share,
            way,
            &mut to,
        );
        Some(to)
    }
}
