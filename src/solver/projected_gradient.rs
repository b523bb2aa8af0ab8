//! Projected gradient method: x ← proj(x − σ g).

use super::line_search::along_projected_path;
use super::{Iterate, Method, SolverState, Step};

/// Large first σ of the source documents.
const LARGE: f64 = 10_000.0;
/// Largest number of trials: from the large σ down to steps that change nothing.
const MOST_TRIALS: usize = 80;
/// Number of past costs up to which a spectral step may climb (Birgin, Martínez & Raydan 2000).
const HISTORY: usize = 10;

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
        Self::new(FirstStep::Fixed(LARGE))
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

    answers! {
        fn needs_jacobian(&self) -> bool = false;
        fn control(&self, own: &Self::State) -> f64 = own.length;
    }

    fn reserve(&self, own: &mut Self::State, _rows: usize, variables: usize) {
        own.length = 0.0;
        for vector in [&mut own.step, &mut own.previous_gradient] {
            vector.clear();
            vector.resize(variables, 0.0);
        }
        own.recent_costs.clear();
        own.recent_costs.reserve(HISTORY);
    }

    fn begin(&self, own: &mut Self::State, at: &SolverState) {
        // The step length of a linear problem of this curvature.
        let curvature = at.column_norm * at.column_norm;
        own.length = if curvature > 0.0 {
            1.0 / curvature
        } else {
            1.0
        };
        own.recent_costs.push(at.cost);
    }

    fn step(&self, own: &mut Self::State, at: &mut Iterate<'_>) -> Step {
        let (first, reference) = match self.first_step {
            FirstStep::Fixed(sigma) => (sigma, at.cost),
            FirstStep::BarzilaiBorwein => {
                if own.recent_costs.len() > 1 {
                    own.length = own.spectral_step(at).unwrap_or(own.length);
                }
                let worst = own.recent_costs.iter().copied().fold(0.0, f64::max);
                (own.length, worst)
            }
        };
        own.previous_gradient.copy_from_slice(&at.gradient);

        let downhill = |at: &SolverState, j: usize| -at.gradient[j];
        let found = along_projected_path(at, downhill, first, reference, MOST_TRIALS);
        let Some((sigma, cost)) = found else {
            return Step::Stuck;
        };
        own.step.copy_from_slice(&at.step);
        at.accept();
        own.length = sigma;
        if self.first_step == FirstStep::BarzilaiBorwein {
            own.remember(cost);
        }
        Step::Taken
    }

    fn fits(&self, own: &Self::State, variables: usize) -> bool {
        own.step.len() == variables && own.previous_gradient.len() == variables
    }
}

impl ProjectedGradientState {
    fn remember(&mut self, cost: f64) {
        if self.recent_costs.len() == HISTORY {
            self.recent_costs.remove(0);
        }
        self.recent_costs.push(cost);
    }

    /// sᵀs / sᵀy, if the curvature along s is positive.
    fn spectral_step(&self, at: &SolverState) -> Option<f64> {
        let (mut ss, mut sy) = (0.0, 0.0);
        for j in 0..at.x.len() {
            let s = self.step[j];
            let y = at.gradient[j] - self.previous_gradient[j];
            ss += s * s;
            sy += s * y;
        }
        (sy > 0.0 && ss > 0.0).then(|| (ss / sy).clamp(1e-12, 1e12))
    }
}
