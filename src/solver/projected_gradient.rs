//! Projected gradient method: x ← proj(x − σ g).

use super::line_search::along_projected_path;
use super::{Iterate, Method, SolverState, Step};

/// Large first σ of the source documents.
const DEFAULT_FIRST_STEP: f64 = 10_000.0;
/// Largest number of trials: from the large σ down to steps that change nothing.
const MAX_TRIALS: usize = 80;
/// Number of past costs up to which a spectral step may climb (Birgin, Martínez & Raydan 2000).
const HISTORY_LENGTH: usize = 10;

/// Rule for the first σ of a step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    any(feature = "argmin", feature = "serde"),
    derive(serde::Serialize, serde::Deserialize)
)]
#[non_exhaustive]
pub enum FirstStep {
    /// A constant σ, halved until the cost falls. The sources use 10 000.
    Fixed(f64),
    /// sᵀs / sᵀy from the last step s and the change y of the gradient (Barzilai & Borwein 1988).
    ///
    /// The cost may rise above the last one, but not above the last ten (spectral projected gradient).
    BarzilaiBorwein,
}

/// Projected gradient method with backtracking along the projected path.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
pub struct ProjectedGradient {
    first_step: FirstStep,
}

impl ProjectedGradient {
    /// Method with a rule for the first σ.
    #[must_use]
    pub fn new(first_step: FirstStep) -> Self {
        Self { first_step }
    }
}

impl Default for ProjectedGradient {
    fn default() -> Self {
        Self::new(FirstStep::Fixed(DEFAULT_FIRST_STEP))
    }
}

/// State of a search by the projected gradient method.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
pub struct ProjectedGradientState {
    /// Step length σ.
    length: f64,
    /// Last step s.
    step: Vec<f64>,
    previous_gradient: Vec<f64>,
    /// Costs of the last steps, newest last.
    recent_costs: Vec<f64>,
}

impl Method for ProjectedGradient {
    type State = ProjectedGradientState;

    fn name(&self) -> &'static str {
        match self.first_step {
            FirstStep::Fixed(_) => "projected-gradient",
            FirstStep::BarzilaiBorwein => "projected-gradient-bb",
        }
    }

    fn needs_jacobian(&self) -> bool {
        false
    }

    fn control(&self, state: &Self::State) -> f64 {
        state.length
    }

    fn reserve(&self, state: &mut Self::State, _rows: usize, variables: usize) {
        state.length = 0.0;
        for vector in [&mut state.step, &mut state.previous_gradient] {
            vector.clear();
            vector.resize(variables, 0.0);
        }
        state.recent_costs.clear();
        state.recent_costs.reserve(HISTORY_LENGTH);
    }

    fn begin(&self, state: &mut Self::State, solver_state: &SolverState) {
        // The step length of a linear problem of this curvature.
        let curvature = solver_state.column_norm * solver_state.column_norm;
        state.length = if curvature > 0.0 {
            1.0 / curvature
        } else {
            1.0
        };
        state.recent_costs.push(solver_state.cost);
    }

    fn step(&self, state: &mut Self::State, iterate: &mut Iterate<'_>) -> Step {
        let (first, reference) = match self.first_step {
            FirstStep::Fixed(sigma) => (sigma, iterate.cost),
            FirstStep::BarzilaiBorwein => {
                if state.recent_costs.len() > 1 {
                    state.length = state.spectral_step(iterate).unwrap_or(state.length);
                }
                let max_recent_cost = state.recent_costs.iter().copied().fold(0.0, f64::max);
                (state.length, max_recent_cost)
            }
        };
        state.previous_gradient.copy_from_slice(&iterate.gradient);

        let downhill = |iterate: &SolverState, j: usize| -iterate.gradient[j];
        let result = along_projected_path(iterate, downhill, first, reference, MAX_TRIALS);
        let Some((sigma, cost)) = result else {
            return Step::Stuck;
        };
        state.step.copy_from_slice(&iterate.step);
        iterate.accept();
        state.length = sigma;
        if self.first_step == FirstStep::BarzilaiBorwein {
            state.record_cost(cost);
        }
        Step::Taken
    }

    fn fits(&self, state: &Self::State, variables: usize) -> bool {
        state.step.len() == variables && state.previous_gradient.len() == variables
    }
}

impl ProjectedGradientState {
    fn record_cost(&mut self, cost: f64) {
        if self.recent_costs.len() == HISTORY_LENGTH {
            self.recent_costs.remove(0);
        }
        self.recent_costs.push(cost);
    }

    /// sᵀs / sᵀy, if the curvature along s is positive.
    fn spectral_step(&self, solver_state: &SolverState) -> Option<f64> {
        let (mut ss, mut sy) = (0.0, 0.0);
        for j in 0..solver_state.x.len() {
            let s = self.step[j];
            let y = solver_state.gradient[j] - self.previous_gradient[j];
            ss += s * s;
            sy += s * y;
        }
        (sy > 0.0 && ss > 0.0).then(|| (ss / sy).clamp(1e-12, 1e12))
    }
}
