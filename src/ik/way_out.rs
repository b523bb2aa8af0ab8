//! A way out of a place of rest that misses what could be reached.
//!
//! A body that settles against limits of several joints may rest a little short of a target, where every small step
//! makes it worse (a local minimum of the bounded problem). While it rests, each frame makes one attempt from a place
//! not far from it; where that comes to the targets on the same branch, the next frames go there, within the most that
//! a joint may move in each.

use super::drag_frame::{NUDGE_EVERY, REST, near, solve};
use super::levels::Extent;
use super::straight_way::{furthest_move, go_share};
use super::{Drag, Restarts, Solver};
use crate::random::RandomStream;
use crate::solver::{Stopping, Termination};

/// Attempts for one place of rest.
const TRIES: usize = 24;
/// Frames that an attempt may take, each of as many steps as a frame has.
const FRAMES_A_TRY: usize = 4;
/// How far they begin from where the body rests, in radians, in turn: a third of them came out of places of rest beside
/// limits of a figure's spine and arm.
const ASIDE: [f64; 2] = [0.2, 0.4];
/// What turns a joint by more than this, in radians, is another branch: nobody expects it of a body at rest.
const SAME_BRANCH: f64 = 0.5;
/// Steps of a frame on the way, which bring the goals back to what they were.
const STEPS: usize = 3;
/// The share of what a joint may move in a frame that goes along the way; the rest is for bringing goals back.
const ALONG: f64 = 0.8;
/// Frames on the way for each that its length takes.
const PATIENCE: usize = 3;

/// What is known of ways out.
#[derive(Clone, Debug, Default)]
pub(super) struct WayOut {
    /// Attempts made for the place of rest.
    tries: usize,
    /// Frames that the attempt in hand has taken; 0 between attempts.
    tried: usize,
    /// Where the targets are reached, by variable, or where the attempt in hand has come to.
    end: Vec<f64>,
    /// Whether the targets are reached there.
    known: bool,
    /// Frames that may still go there: none where the way turned out to be none.
    frames: usize,
}

impl WayOut {
    /// Of a problem with so many variables, in which nothing is known.
    pub(super) fn new(variables: usize) -> Self {
        Self {
            end: Vec::with_capacity(variables),
            ..Self::default()
        }
    }

    /// Forgets everything.
    pub(super) fn clear(&mut self) {
        self.tries = 0;
        self.tried = 0;
        self.known = false;
        self.frames = 0;
    }
}

/// How attempts and frames on the way are solved.
#[derive(Clone, Debug)]
pub(super) struct WayOutSolvers {
    attempt: Solver,
    step: Solver,
    look: Solver,
}

impl WayOutSolvers {
    getters! {
        /// How an attempt is made.
        pub(super) fn attempt(&self) -> &Solver = &self.attempt;
    }

    /// Of a solver within these limits a frame.
    pub(super) fn new(solver: &Solver, stopping: Stopping) -> Self {
        let within = |steps: usize| {
            let few = stopping.max_iterations().min(steps);
            let once = solver.clone().with_restarts(Restarts::none());
            let once = once.with_refining(Extent::Attempt);
            once.with_stopping(stopping.with_max_iterations(few))
        };
        Self {
            attempt: within(usize::MAX),
            step: within(STEPS),
            look: within(0),
        }
    }
}

impl Drag {
    /// Whether ways out make sense at all: preferences that are traded miss on purpose, a body that keeps clear may not
    /// go straight, and a drag that searches needs none.
    fn may_go_out(&self) -> bool {
        let traded = self.problem.pulls_in(self.problem.search_share());
        !traded && self.problem.fence().is_none() && self.search.is_none()
    }

    /// Whether the frames to come look for a way out, or go on one.
    pub(super) fn seeks_way_out(&self) -> bool {
        let seeks = match self.way_out.known {
            true => self.way_out.frames > 0,
            false => self.way_out.tries < TRIES && !self.workspace.solution.is_beyond_reach(),
        };
        seeks && self.may_go_out() && !self.workspace.solution.reached
    }

    /// One attempt from beside the place where this frame settled, if the body rests there.
    pub(super) fn seek_way_out(&mut self) {
        if self.way_out.known {
            if self.end_reaches() {
                // It was no way.
                return;
            }
            self.way_out.clear();
        }
        if self.moved >= REST {
            self.way_out.clear();
            return;
        }
        if self.misses % NUDGE_EVERY == 1 || !self.seeks_way_out() {
            return;
        }
        if self.way_out.tried == 0 {
            self.begin_attempt();
        }
        self.way_out.tried += 1;
        self.look_at_end(false);
        let solution = &mut self.workspace.solution;
        solution.iterations += self.trial.solution.iterations;
        solution.counts += self.trial.solution.counts;
        let map = self.problem.parameters();
        map.gather(&self.trial.solution.q, &mut self.way_out.end);
        let cut = self.trial.solution.termination == Termination::IterationLimit;
        if cut && self.way_out.tried < FRAMES_A_TRY {
            return;
        }
        self.way_out.tries += 1;
        self.way_out.tried = 0;
        let far = self.distance_to_end();
        self.way_out.known = self.trial.solution.reached && far <= SAME_BRANCH;
        if self.way_out.known {
            let frames = (far / (ALONG * self.max_move)).ceil();
            self.way_out.frames = PATIENCE * (1 + frames as usize);
        }
    }

    /// Another place to begin at, beside the one where the body rests.
    fn begin_attempt(&mut self) {
        let aside = ASIDE[self.way_out.tries % ASIDE.len()];
        let mut random = RandomStream::new(1, self.way_out.tries as u64 + 1);
        let start = &mut self.way_out.end;
        start.clone_from(&self.x);
        for (j, value) in start.iter_mut().enumerate() {
            let drawn = 2.0 * random.unit() - 1.0;
            if self.problem.moves_a_task(j) {
                *value += self.unit[j] * aside * drawn;
            }
        }
    }

    /// Goes on towards a place that reaches the targets as they are now, if one is known; whether it did.
    pub(super) fn go_out(&mut self) -> bool {
        if !self.way_out.known || self.way_out.frames == 0 {
            return false;
        }
        if !self.end_reaches() {
            self.way_out.clear();
            return false;
        }
        self.way_out.frames -= 1;
        let far = self.distance_to_end();
        let share = match far <= self.max_move {
            true => 1.0,
            false => ALONG * self.max_move / far,
        };
        let start = &mut self.trial.search.start;
        start.resize(self.x.len(), 0.0);
        let question = near(
            &self.problem,
            &self.targets,
            &self.moves,
            &self.moved_joints,
        );
        let [_, way] = &mut self.before;
        let ends = [self.x.as_slice(), &self.way_out.end];
        go_share(question.space(), ends, share, way, start);
        let map = self.problem.parameters();
        map.scatter_within_limits(start, &mut self.q);
        let step = &self.way_out_solvers.step;
        solve(step, question, &self.q, &mut self.workspace);
        if self.workspace.solution.reached {
            self.way_out.clear();
        }
        self.misses = 0;
        true
    }

    /// Whether the known place reaches the targets as they are now.
    fn end_reaches(&mut self) -> bool {
        self.look_at_end(true);
        self.trial.solution.reached
    }

    /// Solves from the known place within the limits of the joints, or only looks at it.
    fn look_at_end(&mut self, only: bool) {
        let question = self.moved_joints.question(&self.problem, &self.targets);
        question.space().project(&mut self.way_out.end);
        let map = self.problem.parameters();
        map.scatter_within_limits(&self.way_out.end, &mut self.q);
        let WayOutSolvers { attempt, look, .. } = &self.way_out_solvers;
        let solver = if only { look } else { attempt };
        solve(solver, question, &self.q, &mut self.trial);
        self.q.copy_from_slice(&self.q_before);
    }

    /// How far the joint that has the longest way to the known place must go, in radians.
    fn distance_to_end(&mut self) -> f64 {
        let [_, way] = &mut self.before;
        let ends = [self.x.as_slice(), &self.way_out.end];
        furthest_move(&self.problem, &self.unit, ends, way).map_or(0.0, |(_, far)| far)
    }
}
