//! Backtracking along the projected path x(α) = proj(x + α d).

use super::{Iterate, SolverState};

/// The share of the promised decrease that a step must deliver (Nocedal & Wright 2006, eq. 3.4).
const SUFFICIENT: f64 = 1e-4;
/// The source documents halve the step until the cost falls.
const SHRINK: f64 = 0.5;

/// Shortens α from `first`, at most `trials` times, until the cost falls below `reference`, if only
/// by the last digit, by a share of gᵀ(x(α) − x)
/// (Bertsekas 1999, "Nonlinear Programming", eq. 2.45). `direction` is d for unit α. Returns the
/// α and the cost of the trial in memory, or `None` when no α does.
pub(super) fn along_projected_path(
    iterate: &mut Iterate<'_>,
    direction: impl Fn(&SolverState, usize) -> f64,
    first: f64,
    reference: f64,
    trials: usize,
) -> Option<(f64, f64)> {
    let mut alpha = first;
    for _ in 0..trials {
        let at = &mut *iterate.state;
        for j in 0..at.x.len() {
            at.step[j] = alpha * direction(at, j);
        }
        iterate.project_step();
        let cost = iterate.evaluate_trial();
        let moves = iterate.gradient.iter().zip(&iterate.step);
        let slope: f64 = moves.map(|(g, s)| g * s).sum();
        if slope < 0.0 && cost < reference && cost <= reference + SUFFICIENT * slope {
            return Some((alpha, cost));
        }
        if iterate.step.iter().all(|&s| s == 0.0) {
            return None;
        }
        alpha *= SHRINK;
    }
    None
}
