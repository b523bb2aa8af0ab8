//! Soft tasks that keep required tasks from being reached when they are weighted against each other.

use std::ops::Range;

use nalgebra::DMatrix;

use crate::problem::{ProblemInstance, TaskSubset};
use crate::solver::largest;
use crate::task::Role;

/// Smallest share of a soft task in the balance of the required tasks' gradient at which the soft task is listed.
const MIN_NAMED_SHARE: f64 = 0.1;

/// An unreached weighted sum: Jacobian and residual of all tasks at the solution.
pub(crate) struct PreferenceConflict<'a> {
    pub(crate) question: ProblemInstance<'a>,
    pub(crate) jacobian: &'a DMatrix<f64>,
    pub(crate) residual: &'a [f64],
    /// Largest derivative of the total cost that counts as zero.
    pub(crate) negligible: f64,
}

impl PreferenceConflict<'_> {
    /// Lists the soft tasks whose cost rises along the steepest descent of the required tasks, within the bounds at x.
    /// The strongest comes first. `slope` is a workspace with one number per variable.
    pub(crate) fn list(&self, x: &[f64], slope: &mut [f64], tasks: &mut Vec<usize>) {
        tasks.clear();
        let (instance, residual) = (self.question, self.residual);
        let problem = instance.problem;
        let rows = residual.len();
        // Derivative by variable j of half a task's squared residual.
        let slope_by = |j: usize, task: &Range<usize>| {
            let column = &self.jacobian.as_slice()[j * rows..(j + 1) * rows];
            let pairs = column[task.clone()].iter().zip(&residual[task.clone()]);
            pairs.map(|(j, r)| j * r).sum::<f64>()
        };
        let goals = problem.tasks_of(TaskSubset::All);
        let goals = goals.filter(|(_, task, _)| task.role == Role::Goal);
        slope.fill(0.0);
        for (_, _, rows) in goals {
            for (j, slope) in slope.iter_mut().enumerate() {
                *slope += slope_by(j, &rows);
            }
        }
        for (j, slope) in slope.iter_mut().enumerate() {
            if instance.space().holds(x, j, *slope, 0.0) {
                *slope = 0.0;
            }
        }
        let steepest = largest(slope);
        let squared_norm: f64 = slope.iter().map(|s| s * s).sum();
        if steepest <= self.negligible || !squared_norm.is_finite() {
            return;
        }
        // Derivative of a soft task's cost along the negative gradient of the required tasks.
        let opposition = |index: usize| {
            let Some(task) = problem.compiled_tasks().get(index) else {
                return 0.0;
            };
            let slopes = slope.iter().enumerate();
            let along = slopes.map(|(j, slope)| slope * slope_by(j, &task.rows));
            -along.sum::<f64>()
        };
        let preferences = problem.compiled_tasks().iter().enumerate();
        let preferences = preferences.filter(|(_, task)| task.role == Role::Preference);
        let listed =
            preferences.filter(|&(index, _)| opposition(index) >= MIN_NAMED_SHARE * squared_norm);
        tasks.extend(listed.map(|(index, _)| index));
        tasks.sort_unstable_by(|&a, &b| opposition(b).total_cmp(&opposition(a)));
    }
}
