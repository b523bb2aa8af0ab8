//! Escape from penetration that local steps cannot resolve.
//!
//! Each side of a plate repels the links near it, so an arm that pierces the plate can converge there. Each idle frame
//! then attempts one collision-free solution, from perturbations of increasing size. The following frames move to a
//! solution in a straight line through the penetrated obstacle, within the joint step limit of a frame. Motions through
//! other obstacles are accepted only after many attempts found none.

use super::Drag;
use super::drag_frame::solve;
use super::joint_interpolation::{interpolate, max_displacement};
use crate::problem::{AnyClearanceCheck, CollisionConstraint, ProblemInstance};
use kinopt_kinematics::random::RandomStream;

/// Maximum number of attempts per local minimum.
const MAX_ATTEMPTS: usize = 64;
/// Number of attempts whose motion may collide only with the pairs that are in collision at the start.
const MAX_ATTEMPTS_WITHOUT_NEW_CONTACT: usize = 40;
/// Increment of the perturbation size per attempt, radians.
const PERTURBATION_INCREMENT: f64 = 0.05;
/// Decrease of the penetration per frame that counts as no progress, metres.
const MIN_PROGRESS: f64 = 1e-6;
/// Joint displacement between two checked configurations of a motion, radians.
const CHECK_SPACING: f64 = 0.01;

/// State of the escape.
#[derive(Clone, Debug, Default)]
pub(super) struct Depenetration {
    /// Number of attempts made at this local minimum.
    attempts: usize,
    /// Variables of a collision-free solution.
    solution_x: Vec<f64>,
    /// True if `end` is known.
    is_solution_known: bool,
}

impl Depenetration {
    /// Creates the state for a problem with `variables` variables.
    pub(super) fn new(variables: usize) -> Self {
        Self {
            solution_x: Vec::with_capacity(variables),
            ..Self::default()
        }
    }

    /// Resets the state.
    pub(super) fn clear(&mut self) {
        (self.attempts, self.is_solution_known) = (0, false);
    }
}

impl Drag {
    /// Returns whether following frames attempt an escape or move along one.
    pub(super) fn is_depenetrating(&self) -> bool {
        let depenetration = &self.depenetration;
        self.may_collide
            && self.problem.collision_constraint().is_some()
            && (depenetration.is_solution_known || depenetration.attempts < MAX_ATTEMPTS)
    }

    /// Runs one attempt if a frame changed the distance of the deepest pair, metres, from `start_distance` to
    /// `end_distance` without progress.
    pub(super) fn attempt_depenetration(
        &mut self,
        constraint: &CollisionConstraint,
        check: &mut dyn AnyClearanceCheck,
        (start_distance, end_distance): (f64, f64),
    ) {
        if end_distance > start_distance + MIN_PROGRESS {
            self.depenetration.clear();
            return;
        }
        if self.depenetration.attempts == MAX_ATTEMPTS {
            return;
        }
        self.depenetration.attempts += 1;
        let attempt = self.depenetration.attempts;
        let mut random = RandomStream::new(2, attempt as u64);
        let start = &mut self.depenetration.solution_x;
        start.clone_from(&self.x);
        for (value, unit) in start.iter_mut().zip(&self.units) {
            *value += unit * PERTURBATION_INCREMENT * attempt as f64 * (2.0 * random.unit() - 1.0);
        }
        let instance = ProblemInstance::from(&self.problem).with_targets(&self.targets);
        instance.space().project(start);
        let map = self.problem.parameters();
        let mut q = self.q_before.clone();
        map.scatter_within_limits(start, &mut q);
        let solver = self.escape_solvers.attempt();
        solve(
            solver,
            instance.with_constraint(constraint.with_strong_clearance()),
            &q,
            &mut self.trial,
        );
        let trial = &self.trial.solution;
        self.workspace.solution.iterations += trial.iterations;
        self.workspace.solution.counts += trial.counts;
        let is_finite = trial.q.iter().all(|value| value.is_finite());
        let is_collision_free = is_finite && check.is_free(&trial.q);
        map.gather(&trial.q, &mut self.depenetration.solution_x);
        self.depenetration.is_solution_known = is_collision_free
            && (attempt > MAX_ATTEMPTS_WITHOUT_NEW_CONTACT || self.has_no_new_contact(check));
    }

    /// Returns whether the linear motion to the solution collides only with the pairs that are in collision at its
    /// start.
    fn has_no_new_contact(&self, check: &mut dyn AnyClearanceCheck) -> bool {
        let (map, space) = (
            self.problem.parameters(),
            ProblemInstance::from(&self.problem).space(),
        );
        let mut q = self.workspace.solution.q.clone();
        let start_pairs = check.collisions(&q);
        let end = &self.depenetration.solution_x;
        let mut from = self.x.clone();
        map.gather(&q, &mut from);
        let (mut displacement, mut x) = (from.clone(), from.clone());
        let distance =
            max_displacement(&self.problem, &self.units, [&from, end], &mut displacement);
        let checks = (distance.map_or(0.0, |(_, distance)| distance) / CHECK_SPACING).ceil();
        (1..checks as usize).all(|k| {
            let fraction = k as f64 / checks;
            interpolate(space, [&from, end], fraction, &mut displacement, &mut x);
            map.scatter_within_limits(&x, &mut q);
            let pairs = check.collisions(&q);
            pairs.iter().all(|pair| {
                start_pairs
                    .iter()
                    .any(|start_pair| start_pair.is_of_same_pair(pair))
            })
        })
    }

    /// Returns the variables one frame closer to the known collision-free solution, if there is one.
    pub(super) fn depenetration_step(&mut self) -> Option<Vec<f64>> {
        if !self.depenetration.is_solution_known {
            return None;
        }
        let [_, displacement] = &mut self.last_motion;
        let ends = [self.x.as_slice(), &self.depenetration.solution_x];
        let distance = max_displacement(&self.problem, &self.units, ends, displacement)
            .map_or(0.0, |(_, distance)| distance);
        let fraction = (self.max_move / distance).min(1.0);
        let mut x = self.x.clone();
        interpolate(
            ProblemInstance::from(&self.problem).space(),
            ends,
            fraction,
            displacement,
            &mut x,
        );
        Some(x)
    }
}
