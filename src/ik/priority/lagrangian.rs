//! Gradient of a level's Lagrangian L = ½‖r‖² + λᵀr↑, with the multipliers λ of the constraints.

use super::descent::Descent;
use super::descent_problem::DescentProblem;
use super::slope_differences::release;
use crate::solver::dot;

impl Descent {
    /// Computes the constraints, ∇L and the row weights at x, from the level's residual and Jacobian there.
    pub(super) fn take_lagrangian(&mut self, descent: &mut DescentProblem<'_, '_>) {
        self.take_held(descent);
        self.take_multipliers(descent);
    }

    /// Computes the constraints at x.
    pub(super) fn take_held(&mut self, descent: &mut DescentProblem<'_, '_>) {
        let stepped = self.newton.has_stepped;
        self.held.take_rows(descent, &self.x, &self.fixed, stepped);
    }

    /// Computes ∇L for the constraints and the held variables, and removes inequalities that are pulled inward.
    pub(super) fn take_multipliers(&mut self, descent: &DescentProblem<'_, '_>) {
        let Self {
            newton,
            held,
            jacobian,
            pulls,
            fixed,
            ..
        } = self;
        let problem = descent.question.problem;
        loop {
            let columns = jacobian.as_slice().chunks_exact(pulls.len().max(1));
            for (slope, column) in newton.slope.iter_mut().zip(columns) {
                *slope = dot(column, pulls);
            }
            newton.above.clear();
            newton.weights.fill(0.0);
            newton.edges.fill(0.0);
            held.span(problem, &mut newton.above, &newton.pinned);
            held.span_working(&mut newton.above, &newton.pinned);
            let (slope, weights) = (&mut newton.slope, &mut newton.weights);
            held.multiply(
                problem,
                &mut newton.above,
                slope,
                (weights, &mut newton.edges),
            );
            if !held.let_go(&newton.edges) {
                break;
            }
        }
        release(&mut newton.slope, fixed);
    }
}
