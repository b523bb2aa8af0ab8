//! How far a configuration is from one that nothing near it betters.

use super::workspace::Workspace;
use crate::solver::negligible_slope;

impl Workspace {
    /// Takes the gradient at x; the cost there.
    fn slope(&mut self, x: &[f64]) -> f64 {
        let residual = self.linearise(x);
        for (slope, column) in self.gradient.iter_mut().zip(self.jacobian.column_iter()) {
            *slope = column.iter().zip(&residual).map(|(j, r)| j * r).sum();
        }
        0.5 * residual.iter().map(|v| v * v).sum::<f64>()
    }

    /// Takes the gradient at the workspace's own x; the slope that counts as none there.
    pub(super) fn take_slope(&mut self) -> f64 {
        let x = std::mem::take(&mut self.x);
        let cost = self.slope(&x);
        self.x = x;
        self.negligible(cost)
    }

    /// The slope that counts as none at a place of this cost, by the core's measure; the Jacobian is
    /// here.
    fn negligible(&self, cost: f64) -> f64 {
        let columns = self.jacobian.column_iter().map(|column| column.norm());
        negligible_slope(
            columns.fold(0.0, f64::max),
            cost,
            &super::workspace::stopping(),
        )
    }

    /// ‖proj(x − g) − x‖∞ by the gradient that is here.
    pub(super) fn projected_gradient(&self, x: &[f64]) -> f64 {
        let bounds = self.question.lower.iter().zip(&self.question.upper);
        let moves = x.iter().zip(&self.gradient).zip(bounds);
        let moves =
            moves.map(|((x, g), (lower, upper))| ((x - g).max(*lower).min(*upper) - x).abs());
        moves.fold(0.0, f64::max)
    }
}
