//! Gauss-Newton: min ‖J Δ + r‖ over the free variables, with a line search; where that fails,
//! a damped step.

use super::line_search::along_projected_path;
use super::{LeastSquares, Memory, Method, Step};

/// Gauss-Newton with a rank-revealing factorisation: where J loses rank, as in singular poses,
/// the shortest Δ among the minimisers is taken.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
pub struct GaussNewton {
    rank_tolerance: f64,
}

/// Next to a singular place Δ may be as long as the rank tolerance allows: a search along it begins
/// with a step of at most so many times max(1, ‖x‖∞).
const LONGEST: f64 = 10.0;
/// How often a step along Δ, and then along the damped step, is halved.
const MOST_TRIALS: [usize; 2] = [6, 30];

impl GaussNewton {
    /// Diagonal entries of R below `tolerance` times the largest count as zero. Taken as the
    /// nearest within [ε, ½]; NaN changes nothing.
    #[must_use]
    pub fn with_rank_tolerance(mut self, tolerance: f64) -> Self {
        if !tolerance.is_nan() {
            self.rank_tolerance = tolerance.clamp(f64::EPSILON, 0.5);
        }
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
        memory.direction.fill(0.0);
        memory
            .orthogonal
            .minimise(&memory.residual, &memory.free, &mut memory.direction);

        let along = |memory: &Memory, j: usize| memory.direction[j];
        let reference = memory.cost;
        let longest = LONGEST * largest(&memory.x).max(1.0);
        let first = (longest / largest(&memory.direction)).min(1.0);
        let mut found =
            along_projected_path(problem, memory, along, first, reference, MOST_TRIALS[0]);
        if found.is_none() {
            // With a large residual next to a singular place Δ stands almost across the gradient;
            // the step damped by λ = s ‖r‖ does not; with s the largest column norm, that is the
            // size of the curvature that Gauss-Newton leaves out.
            memory.damping = memory.column_norm * (2.0 * memory.cost).sqrt();
            memory.solve_damped();
            memory.direction.copy_from_slice(&memory.step);
            found = along_projected_path(problem, memory, along, 1.0, reference, MOST_TRIALS[1]);
        }
        match found {
            Some((alpha, cost)) => {
                memory.accept_trial(cost);
                memory.damping = alpha;
                Step::Taken
            }
            None => Step::Stuck,
        }
    }
}

/// ‖·‖∞.
fn largest(vector: &[f64]) -> f64 {
    vector.iter().fold(0.0, |most, v| v.abs().max(most))
}
