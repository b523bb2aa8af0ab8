//! Least squares within linear limits, from a start that may be at them.
//!
//! A primal-dual interior-point method (Nocedal & Wright 2006, "Numerical Optimization", section 19.3) with a
//! Gauss-Newton Hessian. The damping grows after a step that does not reduce the merit function.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::basis::Row;
use kinopt_kinematics::scalar::elementary;

/// Cost ½ ‖r‖² with its gradient and JᵀJ.
pub(super) trait Cost {
    type Error;
    fn value(&mut self, x: &DVector<f64>) -> Result<f64, Self::Error>;
    fn linearise(
        &mut self,
        x: &DVector<f64>,
        gradient: &mut DVector<f64>,
        hessian: &mut DMatrix<f64>,
    ) -> Result<f64, Self::Error>;
}

const ITERATIONS: usize = 100;
/// Fraction of the distance to a limit that one step may use.
const BOUNDARY_FRACTION: f64 = 0.995;
/// Factor of the barrier parameter per reduction.
const BARRIER_REDUCTION: f64 = 0.2;
const MIN_BARRIER_RATIO: f64 = 1e-10;
/// Smallest initial slack of a row, radians.
const MIN_INITIAL_SLACK: f64 = 1e-2;
/// Step length that ends the iteration, radians.
const MIN_STEP: f64 = 1e-10;

/// Minimises the cost within all rows, from a start that satisfies them. The result satisfies them too, and its cost is
/// not higher.
pub(super) fn minimise<C: Cost>(
    cost: &mut C,
    rows: &[Row],
    start: DVector<f64>,
) -> Result<DVector<f64>, C::Error> {
    let (variables, mut x) = (start.len(), start);
    let (mut gradient, mut hessian) = (
        DVector::zeros(variables),
        DMatrix::zeros(variables, variables),
    );
    let mut f = cost.linearise(&x, &mut gradient, &mut hessian)?;
    let scale = f.max(f64::MIN_POSITIVE);
    let mut barrier = 0.1 * f / rows.len().max(1) as f64;
    let mut slack: Vec<f64> = rows
        .iter()
        .map(|row| (-row.excess(&x)).max(MIN_INITIAL_SLACK))
        .collect();
    let mut push: Vec<f64> = slack.iter().map(|slack| barrier / slack).collect();
    let (mut damping, mut best) = (1e-8 * hessian.diagonal().max(), (f, x.clone()));
    for _ in 0..ITERATIONS {
        let residuals: Vec<f64> = rows
            .iter()
            .zip(&slack)
            .map(|(row, s)| row.excess(&x) + s)
            .collect();
        let Some(step) = step(
            rows,
            &gradient,
            &hessian,
            (&slack, &push, &residuals),
            barrier,
            damping,
        ) else {
            damping = 10.0 * damping.max(1e-12 * scale);
            continue;
        };
        let (to_slack, to_push) = directions(rows, &step, (&slack, &push, &residuals), barrier);
        let step_scale = max_fraction(&slack, &to_slack);
        let trial = &x + step_scale * &step;
        let next: Vec<f64> = slack
            .iter()
            .zip(&to_slack)
            .map(|(s, d)| s + step_scale * d)
            .collect();
        let infeasibility: f64 = residuals.iter().map(|residuals| residuals.abs()).sum();
        let weight = push.iter().copied().fold(0.0, f64::max);
        let merit = |f: f64, slack: &[f64], infeasibility: f64| {
            f - barrier * slack.iter().map(|s| elementary::ln(*s)).sum::<f64>()
                + 2.0 * weight * infeasibility
        };
        let (before, trial_cost) = (merit(f, &slack, infeasibility), cost.value(&trial)?);
        let after = merit(trial_cost, &next, (1.0 - step_scale) * infeasibility);
        if after.is_nan() || after > before + 1e-12 * before.abs() {
            damping *= 4.0;
            // The barrier problem cannot be improved further.
            if damping > 1e6 * hessian.diagonal().max() {
                break;
            }
            continue;
        }
        damping *= 0.3;
        let push_scale = max_fraction(&push, &to_push);
        for (push, d) in push.iter_mut().zip(&to_push) {
            *push += push_scale * d;
        }
        (x, slack) = (trial, next);
        // The barrier pushes iterates away from limits, so a later iterate can have a higher cost.
        if trial_cost <= best.0 && rows.iter().all(|row| row.excess(&x) <= 0.0) {
            best = (trial_cost, x.clone());
        }
        f = cost.linearise(&x, &mut gradient, &mut hessian)?;
        let moved = step_scale * step.amax();
        if barrier <= MIN_BARRIER_RATIO * scale && moved < MIN_STEP {
            break;
        }
        if moved < 1e-3 || step_scale > 0.9 {
            barrier = (BARRIER_REDUCTION * barrier)
                .max(MIN_BARRIER_RATIO * scale / rows.len().max(1) as f64);
        }
    }
    Ok(best.1)
}

/// (H + Aᵀ diag(z/s) A) dx = −∇f − Aᵀ z − Aᵀ (μ − s z + z r)/s.
fn step(
    rows: &[Row],
    gradient: &DVector<f64>,
    hessian: &DMatrix<f64>,
    (slack, push, residuals): (&[f64], &[f64], &[f64]),
    barrier: f64,
    damping: f64,
) -> Option<DVector<f64>> {
    let (mut matrix, mut rhs) = (hessian.clone(), -gradient);
    for k in 0..rhs.len() {
        matrix[(k, k)] += damping;
    }
    for (row, ((&s, &z), &r)) in rows.iter().zip(slack.iter().zip(push).zip(residuals)) {
        let pull = z + (barrier - s * z + z * r) / s;
        for &(a, gain) in &row.gains {
            rhs[a] -= gain * pull;
            for &(b, other) in &row.gains {
                matrix[(a, b)] += gain * other * z / s;
            }
        }
    }
    Cholesky::new(matrix).map(|factor| factor.solve(&rhs))
}

fn directions(
    rows: &[Row],
    step: &DVector<f64>,
    (slack, push, residuals): (&[f64], &[f64], &[f64]),
    barrier: f64,
) -> (Vec<f64>, Vec<f64>) {
    let pairs = rows.iter().zip(slack.iter().zip(push).zip(residuals));
    let pairs = pairs.map(|(row, ((&s, &z), &r))| {
        let along: f64 = row.gains.iter().map(|(v, gain)| gain * step[*v]).sum();
        let to_slack = -r - along;
        (to_slack, (barrier - s * z - z * to_slack) / s)
    });
    pairs.unzip()
}

/// Returns the largest fraction of a step that keeps all values positive.
fn max_fraction(values: &[f64], step: &[f64]) -> f64 {
    let fractions = values.iter().zip(step).filter(|(_, d)| **d < 0.0);
    fractions
        .map(|(v, d)| -BOUNDARY_FRACTION * v / d)
        .fold(1.0, f64::min)
}
