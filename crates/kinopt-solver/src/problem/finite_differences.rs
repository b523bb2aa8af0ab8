//! Jacobian by forward or central differences of the residual.

use nalgebra::DMatrix;

use super::Evaluation;
use crate::solver::LeastSquares;
use kinopt_kinematics::scalar::elementary;

impl Evaluation<'_> {
    pub(super) fn difference_jacobian(
        &mut self,
        x: &[f64],
        central: bool,
        jacobian: &mut DMatrix<f64>,
    ) {
        let mut shifted = std::mem::take(&mut self.scratch.shifted);
        let mut residuals = std::mem::take(&mut self.scratch.shifted_residual);
        shifted.copy_from_slice(x);
        let rows = self.rows();
        let [ahead, behind] = residuals.each_mut().map(|residual| &mut residual[..rows]);
        if !central {
            self.residual(x, behind);
        }
        let relative_step = if central {
            elementary::cbrt(f64::EPSILON)
        } else {
            f64::EPSILON.sqrt()
        };
        for k in 0..x.len() {
            let step = relative_step * x[k].abs().max(1.0);
            shifted[k] = x[k] + step;
            let mut step_taken = shifted[k] - x[k];
            self.residual(&shifted, ahead);
            if central {
                shifted[k] = x[k] - step;
                step_taken -= shifted[k] - x[k];
                self.residual(&shifted, behind);
            }
            shifted[k] = x[k];
            let rows = jacobian.column_mut(k);
            for ((entry, a), b) in rows.into_iter().zip(&*ahead).zip(&*behind) {
                *entry = (a - b) / step_taken;
            }
        }
        self.scratch.shifted = shifted;
        self.scratch.shifted_residual = residuals;
    }
}
