//! Gauss-Newton: min ‖J Δ + r‖ over the free variables, with a line search.

use super::line_search::along_projected_path;
use super::{LeastSquares, Memory, Method, Step};

/// Gauss-Newton with a rank-revealing factorisation: where J loses rank, as in singular poses,
/// the shortest Δ among the minimisers is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
pub struct GaussNewton {
    rank_tolerance: f64,
}

impl GaussNewton {
    /// Diagonal entries of R below `tolerance` times the largest count as zero. Within [ε, 1).
    #[must_use]
    pub fn with_rank_tolerance(mut self, tolerance: f64) -> Self {
        self.rank_tolerance = tolerance.clamp(f64::EPSILON, 0.5);
        self
    }
}

impl Default for GaussNewton {
    fn default() -> Self {
        Self {
            rank_tolerance: 1e-8,
        }
    }
}

impl Method for GaussNewton {
    fn name(&self) -> &'static str {
        "gauss-newton"
    }

    fn needs_jacobian(&self) -> bool {
        true
    }

    fn begin(&self, memory: &mut Memory) {
        memory.damping = 1.0;
    }

    fn step(&self, problem: &mut dyn LeastSquares, memory: &mut Memory) -> Step {
        memory
            .orthogonal
            .factorise(&memory.jacobian, &memory.free, self.rank_tolerance);
        memory.previous_x.fill(0.0);
        memory
            .orthogonal
            .minimise(&memory.residual, &memory.free, &mut memory.previous_x);

        // previous_x holds the direction Δ while the trials overwrite `step`.
        let delta = |memory: &Memory, j: usize| memory.previous_x[j];
        let reference = memory.cost;
        match along_projected_path(problem, memory, delta, 1.0, reference) {
            Some((alpha, cost)) => {
                memory.accept_trial(cost);
                memory.damping = alpha;
                Step::Taken
            }
            None => Step::Stuck,
        }
    }
}
