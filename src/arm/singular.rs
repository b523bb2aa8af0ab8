//! Staying clear of singular places, and what of a motion leaves the tool where it is.
//!
//! At the nearest place to a target out of reach the Jacobian has lost a rank: an arm is stretched out
//! there, and its elbow's two sides meet. An arm that goes all the way forgets which side it came from.
//! So where a singular value σ falls below S it is pushed back to the side that it is on, by |r| (S − σ):
//! against all of the error that holds at S/2. S² grows with the error, so that a target within reach
//! is reached, and a singular place on the way to one is no obstacle.

use nalgebra::{Cholesky, Const, Matrix6, SymmetricEigen, Vector6};

use super::workspace::Workspace;

/// S² as a share of the longest column of J times the error: resting inside of the edge makes the miss
/// longer by some 1e-4 of that column.
const CLEARANCE: f64 = 4e-4;
/// The error from which on S grows no more, as a share of that column.
const LARGE_ERROR: f64 = 1e-2;
/// A singular value below this share of that column has no side.
const NO_SIDE: f64 = 1e-9;
/// What is pushed back changes this many times as fast as the error, or less.
const STEEPNESS: f64 = 3.0;
/// The way to a second difference, radians.
const PROBE: f64 = 1e-4;
/// What is added to J Jᵀ, as a share of its trace, so that it can be factored.
const NO_RANK: f64 = 1e-14;
const EIGEN_STEPS: usize = 60;

impl Workspace {
    /// The residual with what keeps the arm clear of singular places, and the damping that a step needs
    /// there; none far from any. The Jacobian at x is here.
    pub(super) fn clear_of_singular(
        &mut self,
        x: &[f64],
        residual: &Vector6<f64>,
        error: f64,
        longest: f64,
    ) -> Option<(Vector6<f64>, f64)> {
        let room = (CLEARANCE * longest * error.min(LARGE_ERROR * longest)).sqrt();
        let held = |i: usize, column: &Vector6<f64>| {
            let slope = column.dot(residual);
            x[i] <= self.lowest[i] && slope > 0.0 || x[i] >= self.highest[i] && slope < 0.0
        };
        let mut normal = Matrix6::<f64>::zeros();
        for i in 0..x.len() {
            let column = self.column(i);
            if !held(i, &column) {
                normal += column * column.transpose();
            }
        }
        if clearance_of(&factored(normal)?) > room {
            return None;
        }
        let parts = SymmetricEigen::try_new(normal, f64::EPSILON, EIGEN_STEPS)?;
        let mut cleared = *residual;
        let mut damping = 0.0_f64;
        let mut way = std::mem::take(&mut self.wanted);
        let mut trial = std::mem::take(&mut self.trial);
        for (k, square) in parts.eigenvalues.iter().enumerate() {
            let sigma = square.max(0.0).sqrt();
            if sigma >= room || sigma <= NO_SIDE * longest {
                continue;
            }
            let lost = parts.eigenvectors.column(k).into_owned();
            for (i, way) in way.iter_mut().enumerate() {
                let column = self.column(i);
                let slope = column.dot(residual);
                let held =
                    x[i] <= self.lowest[i] && slope > 0.0 || x[i] >= self.highest[i] && slope < 0.0;
                *way = if held { 0.0 } else { column.dot(&lost) / sigma };
            }
            let mut bend = -2.0 * residual;
            for side in [PROBE, -PROBE] {
                for (i, trial) in trial.iter_mut().enumerate() {
                    *trial = x[i] + side * way[i] / self.scale[i];
                }
                bend += Vector6::from(self.residual(&trial));
            }
            bend /= PROBE * PROBE;
            // σ grows along the way where the error bends the way that σ goes.
            let push = error * (room - sigma) / sigma;
            cleared -= lost * push.copysign(bend.dot(&lost));
            damping = damping.max(STEEPNESS * error * bend.norm());
        }
        self.trial = trial;
        self.wanted = way;
        (damping > 0.0).then_some((cleared, damping))
    }

    /// Writes into `projected` what of `motion` (radians a joint) leaves the tool where it is, radians
    /// or metres; joints stay within the bounds that they are on. The Jacobian at x is here. How far in
    /// radians the arm is from a singular place, about.
    pub(super) fn project_to_null(&mut self, x: &[f64], motion: &[f64]) -> f64 {
        let mut clearance = 0.0;
        let mut projected = std::mem::take(&mut self.projected);
        let (lower, upper) = (&self.lower, &self.upper);
        let leaves =
            |i: usize, by: f64| x[i] <= lower[i] && by < 0.0 || x[i] >= upper[i] && by > 0.0;
        projected.copy_from_slice(motion);
        // Those that would leave are held, and the rest projected anew.
        for _ in 0..2 {
            let mut normal = Matrix6::<f64>::zeros();
            let mut moved = Vector6::<f64>::zeros();
            for (i, &by) in projected.iter().enumerate() {
                if !leaves(i, by) {
                    let column = self.column(i);
                    normal += column * column.transpose();
                    moved += column * motion[i];
                }
            }
            let Some(factor) = factored(normal) else {
                projected.fill(0.0);
                break;
            };
            clearance = clearance_of(&factor);
            let back = factor.solve(&moved);
            let mut all_stay = true;
            for (i, by) in projected.iter_mut().enumerate() {
                if !leaves(i, *by) {
                    *by = motion[i] - self.column(i).dot(&back);
                    all_stay &= !leaves(i, *by);
                }
            }
            if all_stay {
                break;
            }
        }
        for (i, by) in projected.iter_mut().enumerate() {
            *by = match leaves(i, *by) {
                true => 0.0,
                false => *by / self.scale[i],
            };
        }
        self.projected = projected;
        clearance / self.longest_column()
    }

    /// What a radian of a joint (or the metres that weigh as much) does to the residual.
    fn column(&self, i: usize) -> Vector6<f64> {
        let column: Vector6<f64> = self.jacobian.fixed_view::<6, 1>(0, i).into();
        column / self.scale[i]
    }
}

/// J Jᵀ factored, rows without a weight taken for well-conditioned ones.
fn factored(mut normal: Matrix6<f64>) -> Option<Cholesky<f64, Const<6>>> {
    let trace = normal.trace();
    for k in 0..6 {
        let entry = &mut normal[(k, k)];
        *entry = if *entry > 0.0 {
            *entry + NO_RANK * trace
        } else {
            trace
        };
    }
    normal.cholesky()
}

/// A lower bound of the least singular value, by no more than the root of six less than it.
fn clearance_of(factor: &Cholesky<f64, Const<6>>) -> f64 {
    let mut inverse = Matrix6::<f64>::identity();
    factor.l_dirty().solve_lower_triangular_mut(&mut inverse);
    inverse.norm().recip()
}
