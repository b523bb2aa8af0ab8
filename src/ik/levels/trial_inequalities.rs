//! The edges of [rooms](super::inequalities) at a trial: which of them it is brought back onto.

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use super::inequalities::{Edge, Rooms};
use crate::problem::Share;

impl Edge {
    /// Whether a trial is brought back onto it.
    fn brings_back(&self) -> bool {
        self.counts && (self.locked || self.stands || self.joins)
    }
}

impl Rooms {
    /// Notes on which edges a step's model came to rest, beside those that it kept to; a whole step ends on them.
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

    /// A trial is brought back onto the edges that work.
    pub(super) fn stand_where_they_work(&mut self) {
        for edge in &mut self.edges {
            edge.stands = edge.works;
        }
    }

    /// Takes the depths at a trial: by how much edges miss what they should be. Edges that turn out to be crossed are
    /// stood on from then on; none is yet in the first round.
    pub(super) fn change(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (rank, trial): (usize, &[f64]),
        is_first: bool,
        (residual, change): (&mut [f64], &mut [f64]),
    ) {
        descent.depths(Share::above(rank), trial, &mut self.depths_there);
        for (residual, replaced) in residual.iter_mut().zip(&self.replaced) {
            if *replaced {
                *residual = 0.0;
            }
        }
        let edges = self.edges.iter_mut().zip(&self.depths_there);
        for (change, (edge, depth)) in change.iter_mut().zip(edges) {
            let gap = depth - edge.least;
            if is_first {
                edge.joins = false;
            }
            edge.joins |= edge.counts && gap < 0.0;
            let brings = edge.brings_back() && gap < f64::INFINITY;
            *change = if brings { gap } else { 0.0 };
        }
    }

    /// Completes the rows that bring a trial back.
    pub(super) fn complete_there(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (rank, trial): (usize, &[f64]),
        residual: &DMatrix<f64>,
        whole: &mut DMatrix<f64>,
    ) {
        let mut there = std::mem::take(&mut self.jacobian_there);
        descent.depth_jacobian(Share::above(rank), trial, &mut there);
        self.write(residual, &there, Edge::brings_back, whole);
        self.jacobian_there = there;
    }

    /// Whether edges are within what a goal may change, by what [`change`](Self::change) wrote.
    pub(super) fn are_kept(&self, change: &[f64]) -> bool {
        let edges = self.edges.iter().zip(change);
        edges
            .into_iter()
            .all(|(edge, change)| change.abs() <= edge.slack)
    }
}
