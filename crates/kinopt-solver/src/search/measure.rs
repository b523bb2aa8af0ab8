//! Measurement of the errors and limits at the end of a search.

use std::sync::Arc;

use super::solution::Blocked;
use super::{BoundKind, RowBlockReport, Solution};
use crate::problem::{Evaluation, ProblemInstance, ReportNames, Scratch, TaskSubset};
use crate::solver::{Edge, Side, SolverState, Stopping, half_squared, negligible_slope};
use crate::task::{Quantity, Role};

/// End of a search.
#[doc(hidden)]
pub struct End<'a> {
    #[doc(hidden)]
    pub question: ProblemInstance<'a>,
    #[doc(hidden)]
    pub x: &'a [f64],
    /// Task subset that was searched for, and its weighted residual at x.
    #[doc(hidden)]
    pub share: TaskSubset,
    #[doc(hidden)]
    pub searched: &'a [f64],
    /// Weighted residual of all tasks.
    #[doc(hidden)]
    pub residual: &'a [f64],
}

/// Gradient of the cost at a point.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct Slope {
    /// Largest derivative by one variable that counts as zero.
    pub(crate) negligible: f64,
    /// The point is stationary by the solvers' test.
    #[doc(hidden)]
    pub is_level: bool,
}

impl Solution {
    /// Sets the configuration, its cost and its errors.
    ///
    /// It also sets the projected gradient of the searched cost, unless the solution is reached and no lower cost is
    /// wanted. For an unreached solution it lists the limits that block it. The Jacobian stays in `memory`. Returns
    /// `None` without a gradient, also for a cost that is not finite.
    #[doc(hidden)]
    pub fn measure(
        &mut self,
        end: &End<'_>,
        stopping: &Stopping,
        scratch: &mut Scratch,
        memory: &mut SolverState,
    ) -> Option<Slope> {
        let End {
            question: instance,
            x,
            ..
        } = *end;
        let problem = instance.problem;
        self.q.resize(problem.configuration_len(), 0.0);
        problem.parameters().scatter_within_limits(x, &mut self.q);
        self.cost = half_squared(end.residual);
        let errors = problem.errors(TaskSubset::All, end.residual);
        self.record_errors(
            problem.names(),
            errors.map(|block| RowBlockReport {
                task: block.task,
                quantity: block.quantity,
                error: block.error,
                reached: block.reached,
                role: block.role,
            }),
        );
        if problem.has_unweighted_blocks() {
            let mut evaluation = Evaluation::new(instance, scratch);
            let errors = problem.unweighted_errors(evaluation.unweighted(x));
            for (rows, error) in self.rows.iter_mut().zip(errors) {
                rows.error = error.unwrap_or(rows.error);
            }
        }
        let lower_is_better = problem.has_soft_tasks(end.share);
        let has_gradient = !lower_is_better || self.projected_gradient.is_some();
        let cost = half_squared(end.searched);
        if self.reached && has_gradient || !cost.is_finite() {
            return None;
        }
        memory.resize_derivatives(end.searched.len(), x.len());
        let mut evaluation = Evaluation::of(end.share, instance, scratch);
        let (gradient, steepest) = memory.slope_at(&mut evaluation, x, end.searched);
        let negligible = negligible_slope(steepest, cost, stopping);
        let space = instance.space();
        let projected_norm = |curvature| space.projected_gradient_norm(x, gradient, curvature);
        if end.share != TaskSubset::All || self.projected_gradient.is_none() {
            self.projected_gradient = Some(projected_norm(1.0));
        }
        if !self.reached {
            self.record_active_limits(instance, x, gradient, negligible);
        }
        let cosine = projected_norm(steepest * steepest) * steepest / (2.0 * cost).sqrt();
        Some(Slope {
            negligible,
            // With a zero gradient or a zero cost the angle is undefined.
            is_level: cosine <= stopping.gradient_tolerance() || steepest == 0.0 || cost == 0.0,
        })
    }

    /// Sets the errors of all tasks and clears the findings about an unreached target.
    #[doc(hidden)]
    pub fn record_errors(
        &mut self,
        names: &Arc<ReportNames>,
        errors: impl Iterator<Item = RowBlockReport>,
    ) {
        self.rows.clear();
        self.rows.extend(errors);
        let mut goals = self.rows.iter().filter(|rows| rows.role == Role::Goal);
        self.reached = goals.all(|rows| rows.reached);
        self.blocked.clear();
        self.pulling.clear();
        self.beyond = None;
        let current_names = self.names.as_ref();
        if !current_names.is_some_and(|current_names| Arc::ptr_eq(current_names, names)) {
            self.names = Some(Arc::clone(names));
        }
    }

    /// Lists the variables at a bound beyond which the cost would fall, with a derivative above `negligible`.
    #[doc(hidden)]
    pub fn record_active_limits(
        &mut self,
        instance: ProblemInstance<'_>,
        x: &[f64],
        gradient: &[f64],
        negligible: f64,
    ) {
        let problem = instance.problem;
        let space = instance.space();
        for (variable, &g) in gradient.iter().enumerate() {
            let Some(side) = space.held_at(x, variable, g, negligible) else {
                continue;
            };
            let limit = match side {
                Side::Lower => problem.lower()[variable],
                Side::Upper => problem.upper()[variable],
            };
            // The bounds of a move are within the limits.
            let kind_of = |value: f64| match value == limit {
                true => BoundKind::Limit,
                false => BoundKind::Move,
            };
            let value = x[variable];
            let (side, kind, value, is_whole) = match space.edge_at(x, variable) {
                None => (side, kind_of(value), value, false),
                Some(Edge::Swing) => {
                    let swing = problem.swing_at(variable);
                    let angle = swing.map_or(value, |swing| swing.angle(x));
                    (side, BoundKind::Limit, angle, false)
                }
                Some(Edge::Twist { upper: true }) => (side, BoundKind::Limit, value, false),
                Some(Edge::Twist { upper: false }) => (Side::Lower, BoundKind::Limit, value, false),
                Some(Edge::Angle(max_angle)) => (side, BoundKind::Limit, max_angle, true),
                Some(Edge::Move(max_angle)) => (side, BoundKind::Move, max_angle, true),
            };
            self.blocked.push(Blocked {
                variable,
                side,
                kind,
                value,
                is_whole,
                push: g.abs(),
            });
        }
    }
}

impl RowBlockReport {
    /// Report of the only required task.
    #[doc(hidden)]
    pub fn of_goal(quantity: Quantity, error: f64, tolerance: f64) -> Self {
        Self {
            task: 0,
            quantity,
            error,
            reached: error <= tolerance,
            role: Role::Goal,
        }
    }
}
