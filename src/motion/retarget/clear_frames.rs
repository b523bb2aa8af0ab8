//! Frames that touch nothing: each begins where the last one stood free, and is taken only where it is free too.

use super::problem_of_frame::ProblemOfFrame;
use crate::problem::{AnyClearanceCheck, Fence};

/// A frame that is not free goes so often half as far.
const HALVINGS: usize = 6;

/// The same problem with a clearance that holds, and what tells whether a configuration is free.
#[derive(Clone, Debug)]
pub(super) struct ClearFrames {
    holding: ProblemOfFrame,
    /// Where the clearance's rows begin.
    first_row: usize,
    check: Box<dyn AnyClearanceCheck>,
    /// Whether the last frame was next to something, so that this one begins with the clearance.
    near: bool,
    q: Vec<f64>,
    from: Vec<f64>,
}

impl ClearFrames {
    /// `size` is as of [`ProblemOfFrame::new`], `rows` how many there are without the clearance.
    pub(super) fn new(fence: &Fence, rows: usize, size: f64) -> Self {
        let problem = fence.holding();
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
        /// Whether the last frame is next to something.
        pub(super) fn is_near(&self) -> bool = self.near;
    }

    /// Follows from x, where nothing touches, to where nothing does; the frame's own problem is left where x is.
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

    /// Goes back the way that x came as far as it must: straight, on which speeds only fall.
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
