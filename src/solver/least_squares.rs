//! What a solver asks of a problem.

use nalgebra::DMatrix;

use super::ConfigurationSpace;

/// A residual r(x) with bounds on x. Implementations keep their own scratch memory, hence `&mut`.
pub trait LeastSquares {
    /// n, the length of x.
    fn variables(&self) -> usize;

    /// m, the length of r.
    fn rows(&self) -> usize;

    /// Lower bounds, n numbers; −∞ where there is none.
    fn lower(&self) -> &[f64];

    /// Upper bounds, n numbers, each at least its lower bound; ∞ where there is none.
    fn upper(&self) -> &[f64];

    /// What a step of each variable is measured in, n numbers: lengths that count as much as a radian. Empty where all are 1.
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

    /// Writes Jᵀr, n numbers, where `residual` is r(x). `jacobian` (m × n) is memory to use for
    /// problems that have no shorter way, as is the default.
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

    /// Whether `residual` is good enough by the problem's own tolerances.
    fn is_reached(&self, residual: &[f64]) -> bool {
        residual.iter().all(|&r| r == 0.0)
    }

    /// How much of a step from one x within the bounds to another is allowed, as a share of it: less than all where something
    /// is in the way, 0 where it is at x. A search takes no longer one.
    fn allowed_share(&mut self, from: &[f64], to: &[f64]) -> f64 {
        let _ = (from, to);
        1.0
    }

    /// Whether a good enough residual ends the search, or only a stationary point does.
    fn stops_when_reached(&self) -> bool {
        true
    }
}
