//! Active [inequalities](super::inequalities) at a trial point.

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use super::inequalities::{BoundInequality, LevelInequalities};
use crate::problem::TaskSubset;

impl BoundInequality {
    /// Returns whether the correction of a trial ends on it.
    fn constrains_trial(&self) -> bool {
        self.is_enabled && (self.is_locked || self.is_required || self.is_crossed)
    }
}

impl LevelInequalities {
    /// Records the inequalities on which a step's model ended. A whole step must end on them.
    pub(super) fn record_step_end(
        &mut self,
        ended_edges: impl Iterator<Item = usize>,
        keeps_active_set: bool,
        is_whole_step: bool,
    ) {
        for edge in &mut self.edges {
            edge.ended_step = keeps_active_set && edge.is_active;
        }
        for edge in ended_edges {
            self.edges[edge].ended_step = true;
        }
        for edge in 0..self.edges.len() {
            let is_required =
                self.edges[edge].ended_step && (is_whole_step || self.is_binding(edge));
            self.edges[edge].is_required = is_required;
        }
    }

    /// Requires the trial to end on the active set.
    pub(super) fn require_active_set(&mut self) {
        for edge in &mut self.edges {
            edge.is_required = edge.is_active;
        }
    }

    /// Computes the slacks at a trial and writes the violation of each required inequality into `violations`.
    ///
    /// Crossed inequalities are required from then on. The first round resets them.
    pub(super) fn write_violations(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (rank, trial): (usize, &[f64]),
        is_first: bool,
        (residual, violations): (&mut [f64], &mut [f64]),
    ) {
        descent.slacks(TaskSubset::above(rank), trial, &mut self.trial_slacks);
        for (residual, replaced) in residual.iter_mut().zip(&self.replaced_rows) {
            if *replaced {
                *residual = 0.0;
            }
        }
        let edges = self.edges.iter_mut().zip(&self.trial_slacks);
        for (violation, (edge, slack)) in violations.iter_mut().zip(edges) {
            let gap = slack - edge.min_slack;
            if is_first {
                edge.is_crossed = false;
            }
            edge.is_crossed |= edge.is_enabled && gap < 0.0;
            let constrains = edge.constrains_trial() && gap < f64::INFINITY;
            *violation = if constrains { gap } else { 0.0 };
        }
    }

    /// Writes the constraint Jacobian of the correction at a trial.
    pub(super) fn write_trial_jacobian(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (rank, trial): (usize, &[f64]),
        residual: &DMatrix<f64>,
        jacobian: &mut DMatrix<f64>,
    ) {
        let mut slack_jacobian = std::mem::take(&mut self.trial_jacobian);
        descent.slack_jacobian(TaskSubset::above(rank), trial, &mut slack_jacobian);
        self.write(
            residual,
            &slack_jacobian,
            BoundInequality::constrains_trial,
            jacobian,
        );
        self.trial_jacobian = slack_jacobian;
    }

    /// Returns whether the violations written by [`write_violations`](Self::write_violations) are within tolerance.
    pub(super) fn are_within_tolerance(&self, violations: &[f64]) -> bool {
        let edges = self.edges.iter().zip(violations);
        edges
            .into_iter()
            .all(|(edge, violation)| violation.abs() <= edge.active_slack)
    }
}
