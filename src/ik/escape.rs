//! Escape from local minima of a drag.
//!
//! A drag that converges at joint limits can stop short of a reachable target (a local minimum of the bounded problem).
//! Each idle frame then solves once from a perturbed configuration. If that solution is on the same branch, the
//! following frames move to it, within the joint step limit of a frame.

use super::drag_frame::{FRAMES_PER_PERTURBATION, MAX_REST_MOVE, frame_instance, solve};
use super::joint_interpolation::{interpolate, max_displacement};
use super::priority::Extent;
use super::{Drag, Restarts, Solver};
use crate::random::RandomStream;
use crate::solver::{Stopping, Termination};

/// Maximum number of attempts per local minimum.
const MAX_ATTEMPTS: usize = 24;
/// Maximum number of frames per attempt, each with the iterations of a frame.
const MAX_FRAMES_PER_ATTEMPT: usize = 4;
/// Size of the perturbation, radians; alternates between attempts. A third of the attempts escaped from limits of a
/// spine and arm.
const PERTURBATIONS: [f64; 2] = [0.2, 0.4];
/// Largest joint displacement that still counts as the same branch, radians.
const MAX_BRANCH_DISTANCE: f64 = 0.5;
/// Solver iterations per frame of the motion, which restore the required tasks.
const MOTION_STEPS: usize = 3;
/// Fraction of the joint step limit used along the motion. The rest is for restoring the required tasks.
const MOVE_FRACTION: f64 = 0.8;
/// Largest ratio of frames used to the minimal number of frames.
const MAX_SLOWDOWN: usize = 3;

/// State of the escape.
#[derive(Clone, Debug, Default)]
pub(super) struct LocalMinimumEscape {
    /// Number of attempts made at this local minimum.
    attempts: usize,
    /// Number of frames that the current attempt has taken; 0 between attempts.
    attempt_frames: usize,
    /// Variables of the known solution, or of the current attempt.
    end_x: Vec<f64>,
    /// True if `end` reaches the targets.
    is_end_known: bool,
    /// Number of frames left to move to `end`.
    frames_left: usize,
}

impl LocalMinimumEscape {
    /// Creates the state for a problem with `variables` variables.
    pub(super) fn new(variables: usize) -> Self {
        Self {
            end_x: Vec::with_capacity(variables),
            ..Self::default()
        }
    }

    /// Resets the state.
    pub(super) fn clear(&mut self) {
        self.attempts = 0;
        self.attempt_frames = 0;
        self.is_end_known = false;
        self.frames_left = 0;
    }
}

/// Solvers of attempts and of frames.
#[derive(Clone, Debug)]
pub(super) struct EscapeSolvers {
    attempt: Solver,
    step: Solver,
    evaluator: Solver,
}

impl EscapeSolvers {
    /// Solver of attempts.
    #[must_use]
    pub(super) fn attempt(&self) -> &Solver {
        &self.attempt
    }

    /// Derives the solvers from that of a frame and its stopping criteria.
    pub(super) fn new(solver: &Solver, stopping: Stopping) -> Self {
        let with_max_steps = |steps: usize| {
            let max_steps = stopping.max_iterations().min(steps);
            let single_attempt = solver.clone().with_restarts(Restarts::none());
            let single_attempt = single_attempt.with_extent(Extent::Attempt);
            single_attempt.with_stopping(stopping.with_max_iterations(max_steps))
        };
        Self {
            attempt: with_max_steps(usize::MAX),
            step: with_max_steps(MOTION_STEPS),
            evaluator: with_max_steps(0),
        }
    }
}

impl Drag {
    /// Returns whether escapes apply to this problem.
    ///
    /// Weighted soft tasks cause intended errors. Collision avoidance forbids linear motions. A drag that searches
    /// globally needs no escape.
    fn can_escape(&self) -> bool {
        let has_weighted_soft_tasks = self.problem.has_soft_tasks(self.problem.searched_subset());
        !has_weighted_soft_tasks
            && self.problem.collision_constraint().is_none()
            && self.search.is_none()
    }

    /// Returns whether following frames attempt an escape or move along one.
    pub(super) fn is_escaping(&self) -> bool {
        let is_active = match self.escape.is_end_known {
            true => self.escape.frames_left > 0,
            false => {
                self.escape.attempts < MAX_ATTEMPTS && !self.workspace.solution.is_beyond_reach()
            }
        };
        is_active && self.can_escape() && !self.workspace.solution.reached
    }

    /// Runs one attempt from a perturbed configuration if the drag is at rest.
    pub(super) fn attempt_escape(&mut self) {
        if self.escape.is_end_known {
            if self.is_end_reached() {
                // The motion to the known solution failed.
                return;
            }
            self.escape.clear();
        }
        if self.last_move >= MAX_REST_MOVE {
            self.escape.clear();
            return;
        }
        if self.unreached_frames % FRAMES_PER_PERTURBATION == 1 || !self.is_escaping() {
            return;
        }
        if self.escape.attempt_frames == 0 {
            self.begin_attempt();
        }
        self.escape.attempt_frames += 1;
        self.solve_from_end(false);
        let solution = &mut self.workspace.solution;
        solution.iterations += self.trial.solution.iterations;
        solution.counts += self.trial.solution.counts;
        let map = self.problem.parameters();
        map.gather(&self.trial.solution.q, &mut self.escape.end_x);
        let is_cut = self.trial.solution.termination == Termination::IterationLimit;
        if is_cut && self.escape.attempt_frames < MAX_FRAMES_PER_ATTEMPT {
            return;
        }
        self.escape.attempts += 1;
        self.escape.attempt_frames = 0;
        let distance = self.distance_to_end();
        self.escape.is_end_known = self.trial.solution.reached && distance <= MAX_BRANCH_DISTANCE;
        if self.escape.is_end_known {
            let frames = (distance / (MOVE_FRACTION * self.max_move)).ceil();
            self.escape.frames_left = MAX_SLOWDOWN * (1 + frames as usize);
        }
    }

    /// Writes a perturbed copy of the current variables as the start of an attempt.
    fn begin_attempt(&mut self) {
        let perturbation = PERTURBATIONS[self.escape.attempts % PERTURBATIONS.len()];
        let mut random = RandomStream::new(1, self.escape.attempts as u64 + 1);
        let start = &mut self.escape.end_x;
        start.clone_from(&self.x);
        for (j, value) in start.iter_mut().enumerate() {
            let sample = 2.0 * random.unit() - 1.0;
            if self.problem.moves_a_task(j) {
                *value += self.units[j] * perturbation * sample;
            }
        }
    }

    /// Moves one frame towards the known solution if it reaches the current targets. Returns whether it moved.
    pub(super) fn step_escape(&mut self) -> bool {
        if !self.escape.is_end_known || self.escape.frames_left == 0 {
            return false;
        }
        if !self.is_end_reached() {
            self.escape.clear();
            return false;
        }
        self.escape.frames_left -= 1;
        let distance = self.distance_to_end();
        let fraction = match distance <= self.max_move {
            true => 1.0,
            false => MOVE_FRACTION * self.max_move / distance,
        };
        let start = &mut self.trial.search.start;
        start.resize(self.x.len(), 0.0);
        let instance = frame_instance(
            &self.problem,
            &self.targets,
            &self.move_limits,
            &self.moved_joints,
        );
        let [_, displacement] = &mut self.last_motion;
        let ends = [self.x.as_slice(), &self.escape.end_x];
        interpolate(instance.space(), ends, fraction, displacement, start);
        let map = self.problem.parameters();
        map.scatter_within_limits(start, &mut self.q);
        let step = &self.escape_solvers.step;
        solve(step, instance, &self.q, &mut self.workspace);
        if self.workspace.solution.reached {
            self.escape.clear();
        }
        self.unreached_frames = 0;
        true
    }

    /// Returns whether the known solution reaches the current targets.
    fn is_end_reached(&mut self) -> bool {
        self.solve_from_end(true);
        self.trial.solution.reached
    }

    /// Solves from `end` within the joint limits, or only evaluates it if `evaluate_only` is set.
    fn solve_from_end(&mut self, evaluate_only: bool) {
        let instance = self.moved_joints.instance(&self.problem, &self.targets);
        instance.space().project(&mut self.escape.end_x);
        let map = self.problem.parameters();
        map.scatter_within_limits(&self.escape.end_x, &mut self.q);
        let EscapeSolvers {
            attempt, evaluator, ..
        } = &self.escape_solvers;
        let solver = if evaluate_only { evaluator } else { attempt };
        solve(solver, instance, &self.q, &mut self.trial);
        self.q.copy_from_slice(&self.q_before);
    }

    /// Returns the largest joint displacement to the known solution, radians.
    fn distance_to_end(&mut self) -> f64 {
        let [_, displacement] = &mut self.last_motion;
        let ends = [self.x.as_slice(), &self.escape.end_x];
        max_displacement(&self.problem, &self.units, ends, displacement)
            .map_or(0.0, |(_, distance)| distance)
    }
}
