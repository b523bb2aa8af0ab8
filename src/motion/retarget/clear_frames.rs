//! Collision-free online retargeting: each sample starts collision-free and is accepted only if its end is too.

use super::frame_problem::ProblemOfFrame;
use crate::problem::{AnyClearanceCheck, CollisionConstraint};

/// Maximum number of halvings of a step in collision.
const HALVINGS: usize = 6;

/// Problem with collision avoidance, and the collision check.
#[derive(Clone, Debug)]
pub(super) struct ClearFrames {
    holding: ProblemOfFrame,
    /// Index of the first row of collision avoidance.
    first_row: usize,
    check: Box<dyn AnyClearanceCheck>,
    /// True if collision avoidance was active at the last sample. The next one then starts with it.
    near: bool,
    q: Vec<f64>,
    from: Vec<f64>,
}

impl ClearFrames {
    /// Creates it. `size` is that of [`ProblemOfFrame::new`], `rows` the number of rows without collision avoidance.
    pub(super) fn new(fence: &CollisionConstraint, rows: usize, size: f64) -> Self {
        let problem = fence.with_strong_clearance();
        Self {
            q: vec![0.0; problem.configuration_len()],
            from: vec![0.0; problem.variables()],
            first_row: rows,
            check: fence.check(),
            near: false,
            holding: ProblemOfFrame::new(problem.clone(), size),
        }
    }

    getters! {
        /// True if collision avoidance was active at the last sample.
        pub(super) fn is_near(&self) -> bool = self.near;
    }

    /// Solves from a collision-free x to a collision-free x. The problem `frame` without avoidance is tried first.
    pub(super) fn follow(
        &mut self,
        frame: &mut ProblemOfFrame,
        within: [&[f64]; 2],
        x: &mut [f64],
        mut descend: impl FnMut(&mut ProblemOfFrame, &mut [f64]) -> bool,
    ) -> bool {
        self.from.copy_from_slice(x);
        if !self.near {
            if !descend(frame, x) {
                return false;
            }
            if self.is_free(x) {
                return true;
            }
        }
        if !descend(&mut self.holding, x) {
            return false;
        }
        let clearance = &self.holding.residual()[self.first_row..];
        self.near = clearance.iter().any(|row| *row != 0.0);
        if !self.is_free(x) {
            self.go_back(within, x);
        }
        true
    }

    fn is_free(&mut self, x: &[f64]) -> bool {
        let parameters = self.holding.problem().parameters();
        parameters.scatter_within_limits(x, &mut self.q);
        self.check.is_free(&self.q)
    }

    /// Shortens the step to x until it is collision-free. The line back never increases velocities.
    fn go_back(&mut self, within: [&[f64]; 2], x: &mut [f64]) {
        for _ in 0..HALVINGS {
            self.holding.go_back(within, &self.from, 0.5, x);
            if self.is_free(x) {
                return;
            }
        }
        x.copy_from_slice(&self.from);
    }
}
