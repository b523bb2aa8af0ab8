//! Problem interface of the solvers.

use nalgebra::DMatrix;

use super::ConfigurationSpace;

/// A residual r(x) with bounds on x. Implementations have their own scratch memory, hence `&mut`.
pub trait LeastSquares {
    /// Number of variables n, the length of x.
    fn variables(&self) -> usize;

    /// Number of rows m, the length of r.
    fn rows(&self) -> usize;

    /// Lower bounds, n numbers; −∞ for none.
    fn lower(&self) -> &[f64];

    /// Upper bounds, n numbers, each at least its lower bound; ∞ for none.
    fn upper(&self) -> &[f64];

    /// The unit of each variable's steps, n numbers: lengths that count as much as a radian. Empty if all are 1.
    fn step_scale(&self) -> &[f64] {
        &[]
    }

    /// The space that x is from.
    fn space(&self) -> ConfigurationSpace<'_> {
        ConfigurationSpace::new(self.lower(), self.upper())
    }

    /// Writes r(x), m numbers. `x` is always within the bounds, except for finite differences.
    fn residual(&mut self, x: &[f64], residual: &mut [f64]);

    /// Writes every entry of ∂r/∂x, m × n.
    fn jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>);

    /// Writes Jᵀr, n numbers, with `residual` = r(x).
    ///
    /// `jacobian` (m × n) is scratch memory for problems without a faster method, as in the default implementation.
    fn gradient(
        &mut self,
        x: &[f64],
        residual: &[f64],
        gradient: &mut [f64],
        jacobian: &mut DMatrix<f64>,
    ) {
        self.jacobian(x, jacobian);
        for (k, entry) in gradient.iter_mut().enumerate() {
            let column = jacobian.column(k);
            *entry = column.iter().zip(residual).map(|(j, r)| j * r).sum();
        }
    }

    /// Returns true if `residual` is within the problem's tolerances.
    fn is_reached(&self, residual: &[f64]) -> bool {
        residual.iter().all(|&r| r == 0.0)
    }

    /// Largest allowed fraction of a step between two points within the bounds.
    ///
    /// It is below 1 if the step meets an obstacle, and 0 if the obstacle is at x.
    fn allowed_share(&mut self, from: &[f64], to: &[f64]) -> f64 {
        let _ = (from, to);
        1.0
    }

    /// Returns true if a residual within the tolerances ends the search; otherwise only a stationary point does.
    fn stops_when_reached(&self) -> bool {
        true
    }
}
