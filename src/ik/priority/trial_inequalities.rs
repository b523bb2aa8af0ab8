//! Active [inequalities](super::inequalities) at a trial point.

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use super::inequalities::{Edge, LevelInequalities};
use crate::problem::TaskSubset;

impl Edge {
    /// Returns whether the correction of a trial ends on it.
    fn brings_back(&self) -> bool {
        self.counts && (self.locked || self.stands || self.joins)
    }
}

impl LevelInequalities {
    /// Records the inequalities on which a step's model ended. A whole step must end on them.
    pub(super) fn rest(
        &mut self,
        on: impl Iterator<Item = usize>,
        keeps_working: bool,
        whole: bool,
    ) {
        for edge in &mut self.edges {
            edge.rests = keeps_working && edge.works;
        }
        for edge in on {
            self.edges[edge].rests = true;
        }
        for edge in 0..self.edges.len() {
            let ends = self.edges[edge].rests && (whole || self.may_work(edge));
            self.edges[edge].stands = ends;
        }
    }

    /// Requires the trial to end on the active set.
    pub(super) fn stand_where_they_work(&mut self) {
        for edge in &mut self.edges {
            edge.stands = edge.works;
        }
    }

    /// Computes the slacks at a trial and writes the violation of each required inequality into `change`.
    ///
    /// Crossed inequalities are required from then on. The first round resets them.
    pub(super) fn change(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (rank, trial): (usize, &[f64]),
        is_first: bool,
        (residual, change): (&mut [f64], &mut [f64]),
    ) {
        descent.slacks(TaskSubset::above(rank), trial, &mut self.trial_slacks);
        for (residual, replaced) in residual.iter_mut().zip(&self.replaced) {
            if *replaced {
                *residual = 0.0;
            }
        }
        let edges = self.edges.iter_mut().zip(&self.trial_slacks);
        for (change, (edge, slack)) in change.iter_mut().zip(edges) {
            let gap = slack - edge.least;
            if is_first {
                edge.joins = false;
            }
            edge.joins |= edge.counts && gap < 0.0;
            let brings = edge.brings_back() && gap < f64::INFINITY;
            *change = if brings { gap } else { 0.0 };
        }
    }

    /// Writes the constraint Jacobian of the correction at a trial.
    pub(super) fn complete_there(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (rank, trial): (usize, &[f64]),
        residual: &DMatrix<f64>,
        whole: &mut DMatrix<f64>,
    ) {
        let mut there = std::mem::take(&mut self.jacobian_there);
        descent.depth_jacobian(TaskSubset::above(rank), trial, &mut there);
        self.write(residual, &there, Edge::brings_back, whole);
        self.jacobian_there = there;
    }

    /// Returns whether the violations written by [`change`](Self::change) are within tolerance.
    pub(super) fn are_kept(&self, change: &[f64]) -> bool {
        let edges = self.edges.iter().zip(change);
        edges
            .into_iter()
            .all(|(edge, change)| change.abs() <= edge.slack)
    }
}
