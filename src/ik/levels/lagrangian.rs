//! The slope of a rank's L = ½‖r‖² + λᵀr↑ at a place, with the multipliers λ of what is held.

use super::descent::Descent;
use super::descent_problem::DescentProblem;
use super::slope_differences::release;
use crate::solver::dot;

impl Descent {
    /// Takes what is held at x, then ∇L and what multiplies the gradients of all rows in it, by the rank's residual and
    /// Jacobian there.
    pub(super) fn take_lagrangian(&mut self, descent: &mut DescentProblem<'_, '_>) {
        self.take_held(descent);
        self.take_multipliers(descent);
    }

    /// Takes what is held at x.
    pub(super) fn take_held(&mut self, descent: &mut DescentProblem<'_, '_>) {
        let stepped = self.newton.has_stepped;
        self.held.take_rows(descent, &self.x, &self.fixed, stepped);
    }

    /// Takes ∇L anew for what is held and the variables that are pinned, without the edges that it pulls away from.
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
