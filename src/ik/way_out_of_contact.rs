//! A way out of contact for a body that no small step leads out of it.
//!
//! Each side of a plate looks like the way out to what is near it, so that an arm that pierces one may rest there. While it
//! does, each frame makes one attempt to touch nothing, from places ever farther from where it rests; where one does, the next
//! frames go there straight, through what the body is in, within the most that a joint may move in each. Ways through anything else
//! are taken only after many attempts found no other.

use super::Drag;
use super::drag_frame::solve;
use super::straight_way::{furthest_move, go_share};
use crate::problem::{AnyClearanceCheck, Fence, Question};
use crate::random::RandomStream;

/// Attempts for one place of rest.
const TRIES: usize = 64;
/// So many of them may meet nothing on their way but what is touched at rest.
const TRIES_PAST_OTHERS: usize = 40;
/// How much farther from it each begins than the one before, in radians.
const FARTHER: f64 = 0.05;
/// A frame after which the deepest pair is less deep by no more than this, metres, leads nowhere.
const NO_LESS: f64 = 1e-6;
/// How far a joint goes between two places of a way that are looked at, in radians.
const LOOKED_AT_EVERY: f64 = 0.01;

/// What is known of ways out of contact.
#[derive(Clone, Debug, Default)]
pub(super) struct WayOutOfContact {
    /// Attempts made for the place of rest.
    tries: usize,
    /// Where nothing is touched, by variable.
    end: Vec<f64>,
    /// Whether that is known.
    known: bool,
}

impl WayOutOfContact {
    /// Of a problem with so many variables, in which nothing is known.
    pub(super) fn new(variables: usize) -> Self {
        Self {
            end: Vec::with_capacity(variables),
            ..Self::default()
        }
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        (self.tries, self.known) = (0, false);
    }
}

impl Drag {
    /// Whether the frames to come look for a way out of contact, or go on one.
    pub(super) fn seeks_way_out_of_contact(&self) -> bool {
        let way = &self.way_out_of_contact;
        self.touches && self.problem.fence().is_some() && (way.known || way.tries < TRIES)
    }

    /// One attempt to touch nothing, where a frame has led from one distance of the deepest pair to another, metres, and that is nowhere.
    pub(super) fn seek_way_out_of_contact(
        &mut self,
        fence: &Fence,
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
        let question = Question::from(&self.problem).with_targets(&self.targets);
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

    /// Whether the straight way from where this frame ends to the place that touches nothing meets only what is touched where it begins.
    fn meets_nothing_else(&self, check: &mut dyn AnyClearanceCheck) -> bool {
        let (map, space) = (
            self.problem.parameters(),
            Question::from(&self.problem).space(),
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

    /// Goes on towards a place that touches nothing, if one is known: where that leads, by variable.
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
            Question::from(&self.problem).space(),
            ends,
            share,
            way,
            &mut to,
        );
        Some(to)
    }
}
