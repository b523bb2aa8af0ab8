//! Backtracking along the projected path x(α) = proj(x + α d).

use super::{LeastSquares, Memory};

/// The share of the promised decrease that a step must deliver (Nocedal & Wright 2006, eq. 3.4).
const SUFFICIENT: f64 = 1e-4;
/// The source documents halve the step until the cost falls.
const SHRINK: f64 = 0.5;

/// Shortens α from `first`, at most `trials` times, until the cost falls below `reference`, if only
/// by the last digit, by a share of gᵀ(x(α) − x)
/// (Bertsekas 1999, "Nonlinear Programming", eq. 2.45). `direction` is d for unit α. Returns the
/// α and the cost of the trial in memory, or `None` when no α does.
pub(super) fn along_projected_path(
    problem: &mut dyn LeastSquares,
    memory: &mut Memory,
    direction: impl Fn(&Memory, usize) -> f64,
    first: f64,
    reference: f64,
    trials: usize,
) -> Option<(f64, f64)> {
    let mut alpha = first;
    for _ in 0..trials {
        for j in 0..memory.x.len() {
            memory.trial[j] = memory.x[j] + alpha * direction(memory, j);
        }
        let cost = memory.evaluate_trial(problem);
        let slope: f64 = memory
            .gradient
            .iter()
            .zip(&memory.step)
            .map(|(g, s)| g * s)
            .sum();
        if slope < 0.0 && cost < reference && cost <= reference + SUFFICIENT * slope {
            return Some((alpha, cost));
        }
        if memory.step.iter().all(|&s| s == 0.0) {
            return None;
        }
        alpha *= SHRINK;
    }
    None
}
