//! Escape from local minima of a drag.
//!
//! A drag that converges at joint limits can stop short of a reachable target (a local minimum of the bounded problem).
//! Each idle frame then solves once from a perturbed configuration. If that solution is on the same branch, the
//! following frames move to it, within the joint step limit of a frame.

use super::drag_frame::{NUDGE_EVERY, REST, near, solve};
use super::joint_interpolation::{furthest_move, go_share};
use super::priority::Extent;
use super::{Drag, Restarts, Solver};
use crate::problem::ProblemInstance;
use crate::random::RandomStream;
use crate::solver::{Stopping, Termination};

/// Maximum number of attempts per local minimum.
const TRIES: usize = 24;
/// Maximum number of frames per attempt, each with the iterations of a frame.
const FRAMES_A_TRY: usize = 4;
/// Size of the perturbation, radians; alternates between attempts. A third of the attempts escaped from limits of a
/// spine and arm.
const ASIDE: [f64; 2] = [0.2, 0.4];
/// Largest joint displacement that still counts as the same branch, radians.
const SAME_BRANCH: f64 = 0.5;
/// Solver iterations per frame of the motion, which restore the required tasks.
const STEPS: usize = 3;
/// Fraction of the joint step limit used along the motion. The rest is for restoring the required tasks.
const ALONG: f64 = 0.8;
/// Largest ratio of frames used to the minimal number of frames.
const PATIENCE: usize = 3;

/// State of the escape.
#[derive(Clone, Debug, Default)]
pub(super) struct LocalMinimumEscape {
    /// Number of attempts made at this local minimum.
    tries: usize,
    /// Number of frames that the current attempt has taken; 0 between attempts.
    tried: usize,
    /// Variables of the known solution, or of the current attempt.
    end: Vec<f64>,
    /// True if `end` reaches the targets.
    known: bool,
    /// Number of frames left to move to `end`.
    frames: usize,
}

impl LocalMinimumEscape {
    /// Creates the state for a problem with `variables` variables.
    pub(super) fn new(variables: usize) -> Self {
        Self {
            end: Vec::with_capacity(variables),
            ..Self::default()
        }
    }

    /// Resets the state.
    pub(super) fn clear(&mut self) {
        self.tries = 0;
        self.tried = 0;
        self.known = false;
        self.frames = 0;
    }
}

/// Solvers of attempts and of frames.
#[derive(Clone, Debug)]
pub(super) struct WayOutSolvers {
    attempt: Solver,
    step: Solver,
    look: Solver,
}

impl WayOutSolvers {
    getters! {
        /// Solver of attempts.
        pub(super) fn attempt(&self) -> &Solver = &self.attempt;
    }

    /// Derives the solvers from that of a frame and its stopping criteria.
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
    /// Returns whether escapes apply to this problem.
    ///
    /// Weighted soft tasks cause intended errors. Collision avoidance forbids linear motions. A drag that searches
    /// globally needs no escape.
    fn may_go_out(&self) -> bool {
        let traded = self.problem.pulls_in(self.problem.search_share());
        !traded && self.problem.fence().is_none() && self.search.is_none()
    }

    /// Returns whether following frames attempt an escape or move along one.
    pub(super) fn seeks_way_out(&self) -> bool {
        let seeks = match self.way_out.known {
            true => self.way_out.frames > 0,
            false => self.way_out.tries < TRIES && !self.workspace.solution.is_beyond_reach(),
        };
        seeks && self.may_go_out() && !self.workspace.solution.reached
    }

    /// Runs one attempt from a perturbed configuration if the drag is at rest.
    pub(super) fn seek_way_out(&mut self) {
        if self.way_out.known {
            if self.end_reaches() {
                // The motion to the known solution failed.
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

    /// Writes a perturbed copy of the current variables as the start of an attempt.
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

    /// Moves one frame towards the known solution if it reaches the current targets. Returns whether it moved.
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
        let question = near(&self.problem, &self.targets, &self.moves);
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

    /// Returns whether the known solution reaches the current targets.
    fn end_reaches(&mut self) -> bool {
        self.look_at_end(true);
        self.trial.solution.reached
    }

    /// Solves from `end` within the joint limits, or only evaluates it if `only` is set.
    fn look_at_end(&mut self, only: bool) {
        let question = ProblemInstance::from(&self.problem).with_targets(&self.targets);
        question.space().project(&mut self.way_out.end);
        let map = self.problem.parameters();
        map.scatter_within_limits(&self.way_out.end, &mut self.q);
        let WayOutSolvers { attempt, look, .. } = &self.way_out_solvers;
        let solver = if only { look } else { attempt };
        solve(solver, question, &self.q, &mut self.trial);
        self.q.copy_from_slice(&self.q_before);
    }

    /// Returns the largest joint displacement to the known solution, radians.
    fn distance_to_end(&mut self) -> f64 {
        let [_, way] = &mut self.before;
        let ends = [self.x.as_slice(), &self.way_out.end];
        furthest_move(&self.problem, &self.unit, ends, way).map_or(0.0, |(_, far)| far)
    }
}
