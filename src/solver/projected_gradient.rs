//! Projected gradient descent: x ← proj(x − σ g).

use super::line_search::along_projected_path;
use super::memory::MOST_RECENT_COSTS;
use super::{LeastSquares, Memory, Method, Step};

/// The source documents' large first σ.
const LARGE: f64 = 10_000.0;
/// From the large σ down to steps that change nothing.
const MOST_TRIALS: usize = 80;
/// How many past costs a spectral step may climb back to (Birgin, Martínez & Raydan 2000).
const HISTORY: usize = MOST_RECENT_COSTS;

/// Which σ a step tries first.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum FirstStep {
    /// The same σ every time, halved until the cost falls. The sources use 10 000.
    Fixed(f64),
    /// sᵀs / sᵀy from the last step s and the change of gradient y (Barzilai & Borwein 1988); the
    /// cost may rise above the last one, but not above the last ten (spectral projected gradient).
    BarzilaiBorwein,
}

/// Projected gradient descent with backtracking along the projected path.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
pub struct ProjectedGradient {
    first_step: FirstStep,
}

impl ProjectedGradient {
    /// With a rule for the first σ.
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

impl Method for ProjectedGradient {
    fn name(&self) -> &'static str {
        match self.first_step {
            FirstStep::Fixed(_) => "projected-gradient",
            FirstStep::BarzilaiBorwein => "projected-gradient-bb",
        }
    }

    fn needs_jacobian(&self) -> bool {
        false
    }

    fn begin(&self, memory: &mut Memory) {
        // A step of the size that a linear problem would need.
        let curvature = memory.column_norm * memory.column_norm;
        memory.damping = if curvature > 0.0 {
            1.0 / curvature
        } else {
            1.0
        };
        memory.recent_costs.push(memory.cost);
    }

    fn step(&self, problem: &mut dyn LeastSquares, memory: &mut Memory) -> Step {
        let (first, reference) = match self.first_step {
            FirstStep::Fixed(sigma) => (sigma, memory.cost),
            FirstStep::BarzilaiBorwein => {
                if memory.recent_costs.len() > 1 {
                    memory.damping = spectral_step(memory).unwrap_or(memory.damping);
                }
                let worst = memory.recent_costs.iter().copied().fold(0.0, f64::max);
                (memory.damping, worst)
            }
        };
        memory.previous_x.copy_from_slice(&memory.x);
        memory.previous_gradient.copy_from_slice(&memory.gradient);

        let downhill = |memory: &Memory, j: usize| -memory.gradient[j];
        let found = along_projected_path(problem, memory, downhill, first, reference, MOST_TRIALS);
        let Some((sigma, cost)) = found else {
            return Step::Stuck;
        };
        memory.accept_trial(cost);
        memory.damping = sigma;
        if self.first_step == FirstStep::BarzilaiBorwein {
            remember(memory, cost);
        }
        Step::Taken
    }
}

fn remember(memory: &mut Memory, cost: f64) {
    if memory.recent_costs.len() == HISTORY {
        memory.recent_costs.remove(0);
    }
    memory.recent_costs.push(cost);
}

/// sᵀs / sᵀy, if the curvature along s is positive.
fn spectral_step(memory: &Memory) -> Option<f64> {
    let (mut ss, mut sy) = (0.0, 0.0);
    for j in 0..memory.x.len() {
        let s = memory.x[j] - memory.previous_x[j];
        let y = memory.gradient[j] - memory.previous_gradient[j];
        ss += s * s;
        sy += s * y;
    }
    (sy > 0.0 && ss > 0.0).then(|| (ss / sy).clamp(1e-12, 1e12))
}
