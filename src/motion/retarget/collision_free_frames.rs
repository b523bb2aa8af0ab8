//! Collision-free online retargeting: each sample starts collision-free and is accepted only if its end is too.

use super::frame_problem::FrameProblem;
use crate::problem::{AnyClearanceCheck, CollisionConstraint};

/// Maximum number of halvings of a step in collision.
const HALVINGS: usize = 6;

/// Problem with collision avoidance, and the collision check.
#[derive(Clone, Debug)]
pub(super) struct CollisionFreeFrames {
    with_avoidance: FrameProblem,
    /// Index of the first row of collision avoidance.
    first_row: usize,
    check: Box<dyn AnyClearanceCheck>,
    /// True if collision avoidance was active at the last sample. The next one then starts with it.
    avoidance_active: bool,
    q: Vec<f64>,
    from: Vec<f64>,
}

impl CollisionFreeFrames {
    /// Creates it. `size` is that of [`FrameProblem::new`], `rows` the number of rows without collision avoidance.
    pub(super) fn new(constraint: &CollisionConstraint, rows: usize, size: f64) -> Self {
        let problem = constraint.with_strong_clearance();
        Self {
            q: vec![0.0; problem.configuration_len()],
            from: vec![0.0; problem.variables()],
            first_row: rows,
            check: constraint.check(),
            avoidance_active: false,
            with_avoidance: FrameProblem::new(problem.clone(), size),
        }
    }

    /// True if collision avoidance was active at the last sample.
    #[must_use]
    pub(super) fn is_avoiding(&self) -> bool {
        self.avoidance_active
    }

    /// Solves from a collision-free x to a collision-free x. The problem `frame` without avoidance is tried first.
    pub(super) fn follow(
        &mut self,
        frame: &mut FrameProblem,
        within: [&[f64]; 2],
        x: &mut [f64],
        mut descend: impl FnMut(&mut FrameProblem, &mut [f64]) -> bool,
    ) -> bool {
        self.from.copy_from_slice(x);
        if !self.avoidance_active {
            if !descend(frame, x) {
                return false;
            }
            if self.is_free(x) {
                return true;
            }
        }
        if !descend(&mut self.with_avoidance, x) {
            return false;
        }
        let clearance = &self.with_avoidance.residual()[self.first_row..];
        self.avoidance_active = clearance.iter().any(|row| *row != 0.0);
        if !self.is_free(x) {
            self.move_back(within, x);
        }
        true
    }

    fn is_free(&mut self, x: &[f64]) -> bool {
        let parameters = self.with_avoidance.problem().parameters();
        parameters.scatter_within_limits(x, &mut self.q);
        self.check.is_free(&self.q)
    }

    /// Shortens the step to x until it is collision-free. The line back never increases velocities.
    fn move_back(&mut self, within: [&[f64]; 2], x: &mut [f64]) {
        for _ in 0..HALVINGS {
            self.with_avoidance.move_back(within, &self.from, 0.5, x);
            if self.is_free(x) {
                return;
            }
        }
        x.copy_from_slice(&self.from);
    }
}
