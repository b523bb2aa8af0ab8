//! Backtracking line search along the projected path x(α) = proj(x + α d).

use super::{Iterate, SolverState};

/// Fraction of the predicted decrease that a step must achieve (Nocedal & Wright 2006, eq. 3.4).
const MIN_DECREASE_FRACTION: f64 = 1e-4;
/// Factor on α after a failed trial.
const SHRINK_FACTOR: f64 = 0.5;

/// Shortens α from `first` until the cost falls below `reference` by a fraction of gᵀ(x(α) − x).
///
/// The rule is eq. 2.45 of Bertsekas 1999, "Nonlinear Programming". `direction` is d for α = 1. Returns α and the cost
/// of the trial in memory, or `None` if no α of `trials` suffices.
pub(super) fn along_projected_path(
    iterate: &mut Iterate<'_>,
    direction: impl Fn(&SolverState, usize) -> f64,
    first: f64,
    reference: f64,
    trials: usize,
) -> Option<(f64, f64)> {
    let mut alpha = first;
    for _ in 0..trials {
        let state = &mut *iterate.state;
        for j in 0..state.x.len() {
            state.step[j] = alpha * direction(state, j);
        }
        iterate.project_step();
        let cost = iterate.evaluate_trial();
        let terms = iterate.gradient.iter().zip(&iterate.step);
        let slope: f64 = terms.map(|(g, s)| g * s).sum();
        if slope < 0.0 && cost < reference && cost <= reference + MIN_DECREASE_FRACTION * slope {
            return Some((alpha, cost));
        }
        if iterate.step.iter().all(|&s| s == 0.0) {
            return None;
        }
        alpha *= SHRINK_FACTOR;
    }
    None
}
