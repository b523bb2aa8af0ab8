//! What of a motion leaves the tool where it is.

use nalgebra::{Matrix6, Vector6};

use super::workspace::Workspace;

/// What is added to J Jᵀ, as a share of its trace, so that it can be factored.
const NO_RANK: f64 = 1e-14;

impl Workspace {
    /// Writes into `projected` what of `motion` leaves the tool where it is: (1 − Jᵀ (J Jᵀ + δ²)⁻¹ J) motion,
    /// both in radians a joint, a slide's by the metres that weigh as much. Directions that move the
    /// tool by far less than `blunt` (δ, metres a radian) count as leaving it. Joints on a bound of the
    /// question stay within it. The Jacobian at x is here. A lower bound of the least singular value, metres a
    /// radian, too small by a factor of √6 at most; 0 where there is none.
    pub(super) fn project_to_null(&mut self, x: &[f64], motion: &[f64], blunt: f64) -> f64 {
        let mut projected = std::mem::take(&mut self.projected);
        projected.copy_from_slice(motion);
        let clearance = self.take_null_of(x, motion, blunt, &mut projected);
        for (i, by) in projected.iter_mut().enumerate() {
            if self.leaves(x, i, *by) {
                *by = 0.0;
            }
        }
        self.projected = projected;
        clearance
    }

    fn take_null_of(&self, x: &[f64], motion: &[f64], blunt: f64, projected: &mut [f64]) -> f64 {
        let mut clearance = 0.0;
        // Joints that would leave their bounds are held, and the rest is projected anew.
        for _ in 0..2 {
            let mut normal = Matrix6::<f64>::zeros();
            let mut moved = Vector6::<f64>::zeros();
            for (i, &by) in projected.iter().enumerate() {
                if !self.leaves(x, i, by) {
                    let column = self.column(i);
                    add_square(&mut normal, &column, 1.0);
                    moved += column * motion[i];
                }
            }
            let Some((back, least)) = solved(normal, blunt, &moved) else {
                projected.fill(0.0);
                return 0.0;
            };
            clearance = least;
            let mut all_stay = true;
            for (i, by) in projected.iter_mut().enumerate() {
                if !self.leaves(x, i, *by) {
                    *by = motion[i] - self.column(i).dot(&back);
                    all_stay &= !self.leaves(x, i, *by);
                }
            }
            if all_stay {
                break;
            }
        }
        clearance
    }

    fn leaves(&self, x: &[f64], i: usize, by: f64) -> bool {
        x[i] <= self.lower[i] && by < 0.0 || x[i] >= self.upper[i] && by > 0.0
    }

    /// What a radian of a joint (or the metres that weigh as much) does to the residual, metres.
    pub(super) fn column(&self, i: usize) -> Vector6<f64> {
        let column: Vector6<f64> = self.jacobian.fixed_view::<6, 1>(0, i).into();
        column / self.scale[i]
    }
}

/// Adds weight × c cᵀ to the lower triangle, which is all that a factorisation reads. Counted by hand: products of
/// small matrices are hundreds of calls in a debug build.
pub(super) fn add_square(normal: &mut Matrix6<f64>, column: &Vector6<f64>, weight: f64) {
    let (entries, column) = (normal.as_mut_slice(), column.as_slice());
    let mut k = 0;
    while k < 6 {
        let by = weight * column[k];
        let mut row = k;
        while row < 6 {
            entries[6 * k + row] += by * column[row];
            row += 1;
        }
        k += 1;
    }
}

/// (N + δ²)⁻¹ b, and how small the root of an eigenvalue of N may be. Rows without a weight count for nothing.
fn solved(mut normal: Matrix6<f64>, blunt: f64, b: &Vector6<f64>) -> Option<(Vector6<f64>, f64)> {
    let trace = normal.trace();
    for k in 0..6 {
        let entry = &mut normal[(k, k)];
        *entry = match *entry > 0.0 {
            true => *entry + NO_RANK * trace + blunt * blunt,
            false => trace,
        };
    }
    let factor = normal.cholesky()?;
    let mut inverse = Matrix6::<f64>::identity();
    factor.l_dirty().solve_lower_triangular_mut(&mut inverse);
    Some((factor.solve(b), inverse.norm().recip()))
}
