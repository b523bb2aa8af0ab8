//! Bounds: projection, and which variables are held by them.

/// Clamps every variable into its bounds; NaN stays NaN.
pub fn project(x: &mut [f64], lower: &[f64], upper: &[f64]) {
    for ((value, &low), &high) in x.iter_mut().zip(lower).zip(upper) {
        if *value < low {
            *value = low;
        } else if *value > high {
            *value = high;
        }
    }
}

/// Lists the variables that are free to move: all but those on a bound whose gradient pushes
/// outward. A full step over all variables, clamped, is no descent method (Bertsekas 1982,
/// "Projected Newton methods for optimization problems with simple constraints").
pub(super) fn list_free(
    x: &[f64],
    gradient: &[f64],
    lower: &[f64],
    upper: &[f64],
    free: &mut Vec<usize>,
) {
    free.clear();
    free.extend((0..x.len()).filter(|&j| {
        let held_below = x[j] <= lower[j] && gradient[j] > 0.0;
        let held_above = x[j] >= upper[j] && gradient[j] < 0.0;
        lower[j] < upper[j] && !held_below && !held_above
    }));
}

/// ‖proj(x − g/c) − x‖∞ for a curvature c: zero exactly at the stationary points of the bounded
/// problem, NaN where the gradient is not finite.
pub(crate) fn projected_gradient_norm(
    x: &[f64],
    gradient: &[f64],
    curvature: f64,
    lower: &[f64],
    upper: &[f64],
) -> f64 {
    let mut largest = 0.0_f64;
    for j in 0..x.len() {
        if !gradient[j].is_finite() {
            // `min` and `max` would drop a NaN.
            return f64::NAN;
        }
        let room = if gradient[j] > 0.0 {
            x[j] - lower[j]
        } else {
            upper[j] - x[j]
        };
        largest = largest.max((gradient[j].abs() / curvature).min(room));
    }
    largest
}
