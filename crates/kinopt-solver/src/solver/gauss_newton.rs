//! Gauss-Newton method: min ‖J Δ + r‖ over the free variables with a line search, or else a damped step.

use super::line_search::along_projected_path;
use super::linear::{CompleteOrthogonal, DampedNormal, largest};
use super::{Iterate, Method, SolverState, Step};
use kinopt_kinematics::bad_option::BadOption;

/// Gauss-Newton method with a rank-revealing factorisation.
///
/// If J loses rank, as at singular configurations, it takes the shortest minimiser Δ.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
pub struct GaussNewton {
    rank_tolerance: f64,
}

/// Largest initial step of a line search, relative to max(1, ‖x‖∞): near singularities Δ may be very long.
const MAX_INITIAL_STEP: f64 = 10.0;
/// Largest numbers of trials along Δ, and then along the damped step, each at half the length of the last.
const MAX_TRIALS: [usize; 2] = [6, 30];

impl GaussNewton {
    /// Sets the relative size of diagonal entries of R below which they count as zero. From ε to ½. Default 1e-8.
    #[must_use]
    pub fn with_rank_tolerance(mut self, tolerance: f64) -> Self {
        self.rank_tolerance = tolerance;
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

/// State of a search by the Gauss-Newton method.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
pub struct GaussNewtonState {
    /// α of the last step.
    length: f64,
    #[cfg_attr(feature = "argmin", serde(skip))]
    buffers: GaussNewtonBuffers,
}

#[derive(Clone, Debug, Default)]
struct GaussNewtonBuffers {
    /// Δ, or the damped step.
    direction: Vec<f64>,
    orthogonal: CompleteOrthogonal,
    normal: DampedNormal,
}

impl Method for GaussNewton {
    type State = GaussNewtonState;

    fn name(&self) -> &'static str {
        "gauss-newton"
    }

    fn needs_jacobian(&self) -> bool {
        true
    }

    fn control(&self, state: &Self::State) -> f64 {
        state.length
    }

    fn check(&self) -> Result<(), BadOption> {
        let range = |tolerance| (f64::EPSILON..=0.5).contains(&tolerance);
        BadOption::check(
            "rank_tolerance",
            self.rank_tolerance,
            (range, "from 2.2e-16 to 0.5"),
        )
    }

    fn reserve(&self, state: &mut Self::State, rows: usize, variables: usize) {
        state.length = 0.0;
        state.buffers.direction.clear();
        state.buffers.direction.reserve(variables);
        state.buffers.orthogonal.reserve(rows, variables);
        state.buffers.normal.reserve(rows, variables);
    }

    fn begin(&self, state: &mut Self::State, _: &SolverState) {
        state.length = 1.0;
    }

    fn step(&self, state: &mut Self::State, iterate: &mut Iterate<'_>) -> Step {
        let GaussNewtonBuffers {
            direction,
            orthogonal,
            normal,
        } = &mut state.buffers;
        orthogonal.factorise(&iterate.jacobian, &iterate.free, self.rank_tolerance);
        direction.clear();
        direction.resize(iterate.x.len(), 0.0);
        orthogonal.minimise(&iterate.residual, &iterate.free, direction);

        let reference = iterate.cost;
        let max_length = MAX_INITIAL_STEP * largest(&iterate.x).max(1.0);
        let first = (max_length / largest(direction)).min(1.0);
        let component = |_: &SolverState, j: usize| direction[j];
        let mut result = along_projected_path(iterate, component, first, reference, MAX_TRIALS[0]);
        if result.is_none() {
            // With a large residual near a singularity, Δ is almost perpendicular to the gradient. The step damped by
            // λ = s ‖r‖ is not. With s the largest column norm, λ is the size of the curvature that Gauss-Newton
            // neglects.
            normal.forget();
            normal.step(
                iterate.state,
                iterate.column_norm * (2.0 * iterate.cost).sqrt(),
            );
            direction.copy_from_slice(&iterate.step);
            let component = |_: &SolverState, j: usize| direction[j];
            result = along_projected_path(iterate, component, 1.0, reference, MAX_TRIALS[1]);
        }
        let Some((alpha, _)) = result else {
            return Step::Stuck;
        };
        iterate.accept();
        state.length = alpha;
        Step::Taken
    }
}
