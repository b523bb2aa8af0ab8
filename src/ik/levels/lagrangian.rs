//! The slope of a rank's L = ½‖r‖² + λᵀr↑ at a place, with the multipliers λ of what is held.

use super::asked::Asked;
use super::descent::Descent;
use super::slope_differences::release;
use crate::solver::dot;

impl Descent {
    /// Takes what is held at x, without the [edges](super::edges) that the rank pulls away from, then ∇L and what
    /// multiplies the gradients of all rows in it; by the rank's residual and Jacobian there.
    pub(super) fn take_lagrangian(&mut self, asked: &mut Asked<'_, '_>) {
        let Self {
            newton,
            held,
            jacobian,
            pulls,
            x,
            fixed,
            ..
        } = self;
        let problem = asked.question.problem;
        held.take_rows(asked, x, fixed);
        loop {
            let columns = jacobian.as_slice().chunks_exact(pulls.len().max(1));
            for (slope, column) in newton.slope.iter_mut().zip(columns) {
                *slope = dot(column, pulls);
            }
            newton.above.clear();
            newton.weights.fill(0.0);
            held.span(problem, &mut newton.above, &newton.pinned);
            let (slope, weights) = (&mut newton.slope, &mut newton.weights);
            held.multiply(problem, &mut newton.above, slope, weights);
            if !held.let_go(asked, x, fixed, weights) {
                break;
            }
        }
        let own = newton.weights.len() - pulls.len();
        newton.weights[own..].copy_from_slice(pulls);
        release(&mut newton.slope, fixed);
    }
}
