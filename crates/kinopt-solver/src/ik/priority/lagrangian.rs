//! Gradient of a level's Lagrangian L = ½‖r‖² + λᵀr↑, with the multipliers λ of the constraints.

use super::descent::Descent;
use super::descent_problem::DescentProblem;
use super::slope_differences::clear_fixed;
use crate::solver::dot;

impl Descent {
    /// Computes the constraints, ∇L and the row weights at x, from the level's residual and Jacobian there.
    pub(super) fn compute_lagrangian(&mut self, descent: &mut DescentProblem<'_, '_>) {
        self.compute_constraints(descent);
        self.compute_multipliers(descent);
    }

    /// Computes the constraints at x.
    pub(super) fn compute_constraints(&mut self, descent: &mut DescentProblem<'_, '_>) {
        let has_stepped = self.newton.has_stepped;
        self.constraints
            .compute_rows(descent, &self.x, &self.fixed, has_stepped);
    }

    /// Computes ∇L for the constraints and the held variables, and removes inequalities that are pulled inward.
    pub(super) fn compute_multipliers(&mut self, descent: &DescentProblem<'_, '_>) {
        let Self {
            newton,
            constraints,
            jacobian,
            residual,
            fixed,
            ..
        } = self;
        let problem = descent.instance.problem;
        loop {
            let columns = jacobian.as_slice().chunks_exact(residual.len().max(1));
            for (slope, column) in newton.slope.iter_mut().zip(columns) {
                *slope = dot(column, residual);
            }
            newton.higher_span.clear();
            newton.row_weights.fill(0.0);
            newton.inequality_multipliers.fill(0.0);
            constraints.add_to_span(problem, &mut newton.higher_span, &newton.is_held);
            constraints.add_active_to_span(&mut newton.higher_span, &newton.is_held);
            let (slope, weights) = (&mut newton.slope, &mut newton.row_weights);
            constraints.apply_multipliers(
                problem,
                &mut newton.higher_span,
                slope,
                (weights, &mut newton.inequality_multipliers),
            );
            if !constraints.drop_inward(&newton.inequality_multipliers) {
                break;
            }
        }
        clear_fixed(&mut newton.slope, fixed);
    }
}
