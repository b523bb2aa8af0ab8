//! What a search found, told as a [`Solution`].

use crate::ik::Solution;
use crate::problem::{Evaluation, Question, Scratch};
use crate::solver::{Memory, Stopping, Termination, negligible_slope, projected_gradient_norm};

/// The best place that the attempts have found.
#[derive(Default)]
pub(super) struct Best {
    pub(super) x: Vec<f64>,
    pub(super) residual: Vec<f64>,
    pub(super) cost: f64,
    pub(super) reached: bool,
}

/// The truth about the best place: its errors, the slope of the cost there, the limits that block
/// it. A search that stopped where nothing is left to gain ends as stationary.
pub(super) fn report(
    question: Question<'_>,
    scratch: &mut Scratch,
    stopping: Stopping,
    best: &Best,
    termination: Termination,
) -> Solution {
    let mut solution = Solution::default();
    solution.termination = termination;
    solution.cost = best.cost;
    let mut memory = Memory::default();
    let (mut gradient, mut negligible): (&[f64], f64) = (&[], 0.0);
    if !best.reached && best.cost.is_finite() {
        let mut evaluation = Evaluation::new(question, scratch);
        memory.take_shape(question.problem.rows(), question.problem.variables());
        let (slope, column_norm) = memory.slope_at(&mut evaluation, &best.x, &best.residual);
        let (lower, upper) = (question.lower(), question.upper());
        let left = |curvature| projected_gradient_norm(&best.x, slope, curvature, lower, upper);
        solution.projected_gradient = Some(left(1.0));
        // The solvers' own test: the cosine between r and what a free variable can do about it.
        let scale = column_norm;
        let length = (2.0 * best.cost).sqrt();
        let cosine = left(scale * scale) * scale / length;
        let flat = cosine <= stopping.gradient_tolerance() || column_norm == 0.0;
        if flat && termination == Termination::SmallStep {
            solution.termination = Termination::Stationary;
        }
        negligible = negligible_slope(column_norm, best.cost, &stopping);
        gradient = slope;
    }
    let evaluation = &mut Evaluation::new(question, scratch);
    solution.measure(evaluation, &best.x, &best.residual, gradient, negligible);
    solution
}
