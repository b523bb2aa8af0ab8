//! The rows that hold missed ranks: by how much a step would tilt their costs.
//!
//! A missed rank stands where ∇L = 0 along what the ranks above leave free, for L = ½‖r‖² + λᵀr↑ with the
//! reached ranks' residuals r↑ and their multipliers λ (Nocedal & Wright 2006, section 12.5). A step Δ leaves it
//! there, in first order, where P ∇²L Δ = 0, P the projection onto what the ranks above leave free.

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use super::held_ranks::{HeldRank, is_of_reached};
use super::inequalities::Rooms;
use super::slope_differences::{SlopeDifferences, Weighted};
use crate::problem::{Problem, Share};
use crate::solver::{RowSpan, dot};

/// A row adds to those above it if so much of it is new, as a share of its rank's length, …
pub(super) const NEW: f64 = 1e-9;
/// … and a row of a curvature, which is a difference.
pub(super) const NEW_CURVATURE: f64 = 1e-5;

/// The rows that hold missed ranks, and room to take them.
#[derive(Clone, Debug, Default)]
pub(super) struct Curvature {
    /// What a step may not change: of missed ranks alone n rows; of several the rows of all, one for each edge of their
    /// rooms, then n for each missed one.
    rows: DMatrix<f64>,
    /// How many rows the residual of all has, and how many those are with the edges.
    pub(super) residual: usize,
    pub(super) first: usize,
    /// By how much it has changed.
    change: Vec<f64>,
    pub(super) slope: Vec<f64>,
    differences: SlopeDifferences,
    /// What multiplies the gradients of the rows in each missed rank's L, rank by rank.
    pub(super) multipliers: Vec<f64>,
    /// What the ranks above each missed one take, and leave.
    above: Vec<RowSpan>,
    pub(super) running: RowSpan,
}

impl Curvature {
    /// Makes room for the ranks above one; how many rows that may be.
    pub(super) fn fit(&mut self, problem: &Problem, rank: usize) -> usize {
        let n = problem.variables();
        let rows = problem.rows_of(Share::above(rank));
        self.slope.resize(n, 0.0);
        self.differences.fit(n, rows);
        let edges = problem.edges_above(rank);
        (self.residual, self.first) = (rows, rows + edges);
        let own = match rank {
            1 => n,
            _ => rows + edges + n * rank,
        };
        if self.rows.shape() != (own, n) {
            self.rows = DMatrix::zeros(own, n);
        }
        if rank > 1 {
            self.change.resize(own, 0.0);
            self.multipliers.resize((rows + edges) * rank, 0.0);
            self.above.resize_with(rank, RowSpan::default);
        }
        own
    }

    /// C: what a step may not change.
    pub(super) fn rows(&self) -> &DMatrix<f64> {
        &self.rows
    }

    pub(super) fn rows_mut(&mut self) -> &mut DMatrix<f64> {
        &mut self.rows
    }

    /// The second derivative of a lone rank's cost at x.
    pub(super) fn of_first(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        x: &[f64],
        fixed: &[bool],
    ) {
        let n = x.len();
        let of = Weighted {
            share: Share::rank(0),
            multipliers: &[],
            edges: &[],
            own: 0..0,
        };
        (self.differences).columns(descent, &of, x, fixed, |j, column| {
            self.rows.as_mut_slice()[j * n..(j + 1) * n].copy_from_slice(column);
        });
    }

    /// The rows of all ranks at x, by their Jacobian and residual there.
    pub(super) fn of_all(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (ranks, rooms): (&[HeldRank], &Rooms),
        x: &[f64],
        (jacobian, residual): (&DMatrix<f64>, &[f64]),
        fixed: &[bool],
    ) {
        self.rows.as_mut_slice().fill(0.0);
        self.copy_rows(jacobian, self.residual..self.first);
        let mut above = std::mem::take(&mut self.running);
        above.clear();
        for held in ranks {
            let own = descent.question.problem.ranks().rows_of(held.rank);
            if held.reached {
                self.copy_rows(jacobian, own.clone());
                add_rows(&mut above, jacobian, own, fixed, NEW);
                for edge in rooms.locked_of(held.rank) {
                    let row = self.residual + edge;
                    add_rows(&mut above, jacobian, row..row + 1, fixed, NEW);
                }
                continue;
            }
            self.take_multipliers(descent, ranks, held, &mut above, (jacobian, residual));
            self.above[held.rank].clone_from(&above);
            self.differentiate_slope(descent, (ranks, held), x, fixed);
            let first = self.first + held.rank * x.len();
            let own = first..first + x.len();
            add_rows(&mut above, &self.rows, own, fixed, NEW_CURVATURE);
        }
        self.running = above;
    }

    /// λ of a missed rank, with its own residual where its rows are: what multiplies all rows' gradients in ∇L.
    pub(super) fn take_multipliers(
        &mut self,
        descent: &DescentProblem<'_, '_>,
        ranks: &[HeldRank],
        missed: &HeldRank,
        above: &mut RowSpan,
        (jacobian, residual): (&DMatrix<f64>, &[f64]),
    ) {
        let (rows, first) = (self.first, self.residual);
        let own = descent.question.problem.ranks().rows_of(missed.rank);
        let slope = &mut self.slope;
        let columns = jacobian.as_slice().chunks_exact(rows.max(1));
        for (slope, column) in slope.iter_mut().zip(columns) {
            *slope = dot(&column[own.clone()], &residual[own.clone()]);
        }
        let multipliers = &mut self.multipliers[missed.rank * rows..(missed.rank + 1) * rows];
        multipliers.fill(0.0);
        for (row, multiplier) in above.multipliers(slope) {
            let is_edge = (first..rows).contains(&row);
            if is_edge || is_of_reached(descent.question.problem, ranks, row) {
                multipliers[row] = multiplier;
            }
        }
        multipliers[own.clone()].copy_from_slice(&residual[own]);
    }

    /// P ∇L of every missed rank at a trial.
    pub(super) fn slopes(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        ranks: &[HeldRank],
        trial: &[f64],
        fixed: &[bool],
    ) {
        let (rows, n) = ((self.residual, self.first), trial.len());
        for missed in ranks.iter().filter(|held| !held.reached) {
            let of = lagrangian(descent, ranks, missed, &self.multipliers, rows);
            let slope = self.differences.slope(descent, &of, trial, fixed);
            self.above[missed.rank].project_out(slope);
            let first = rows.1 + missed.rank * n;
            self.change[first..first + n].copy_from_slice(slope);
        }
    }

    /// P ∇²L of a missed rank.
    fn differentiate_slope(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (ranks, missed): (&[HeldRank], &HeldRank),
        x: &[f64],
        fixed: &[bool],
    ) {
        let n = x.len();
        let (order, rows) = (self.rows.nrows(), (self.residual, self.first));
        let of = lagrangian(descent, ranks, missed, &self.multipliers, rows);
        (self.differences).columns(descent, &of, x, fixed, |j, column| {
            self.above[missed.rank].project_out(column);
            let first = j * order + rows.1 + missed.rank * n;
            self.rows.as_mut_slice()[first..first + n].copy_from_slice(column);
        });
    }

    /// Newton's system at a trial: the rows there, of reached ranks by their Jacobian and of missed ones as they
    /// were taken, and what has changed, of reached ranks their residual.
    pub(super) fn system(
        &mut self,
        descent: &DescentProblem<'_, '_>,
        ranks: &[HeldRank],
        jacobian: &DMatrix<f64>,
        residual_change: &[f64],
    ) -> (&DMatrix<f64>, &[f64]) {
        for held in ranks {
            let own = descent.question.problem.ranks().rows_of(held.rank);
            match held.reached {
                true => {
                    self.change[own.clone()].copy_from_slice(&residual_change[own.clone()]);
                    self.copy_rows(jacobian, own);
                }
                false => self.change[own].fill(0.0),
            }
        }
        let edges = self.residual..self.first;
        self.change[edges.clone()].copy_from_slice(&residual_change[edges.clone()]);
        self.copy_rows(jacobian, edges);
        (&self.rows, &self.change)
    }

    fn copy_rows(&mut self, jacobian: &DMatrix<f64>, own: std::ops::Range<usize>) {
        let (order, rows) = (self.rows.nrows(), jacobian.nrows());
        let columns = self.rows.as_mut_slice().chunks_exact_mut(order.max(1));
        for (to, from) in columns.zip(jacobian.as_slice().chunks_exact(rows.max(1))) {
            to[own.clone()].copy_from_slice(&from[own.clone()]);
        }
    }
}

/// Adds rows of a matrix, of the variables that may move, where more than a share of their length is new.
pub(super) fn add_rows(
    space: &mut RowSpan,
    matrix: &DMatrix<f64>,
    rows: std::ops::Range<usize>,
    fixed: &[bool],
    share: f64,
) {
    let columns = || {
        let columns = matrix.as_slice().chunks_exact(matrix.nrows().max(1));
        columns.zip(fixed)
    };
    let moving = columns().filter(|(_, fixed)| !**fixed);
    let squared: f64 =
        (moving.map(|(column, _)| dot(&column[rows.clone()], &column[rows.clone()]))).sum();
    for row in rows {
        let entries = columns().map(|(column, fixed)| if *fixed { 0.0 } else { column[row] });
        space.add(row, entries, share * squared.sqrt());
    }
}

/// A missed rank's L: its own residual, and the multipliers of the others.
fn lagrangian<'a>(
    descent: &DescentProblem<'_, '_>,
    ranks: &[HeldRank],
    missed: &HeldRank,
    multipliers: &'a [f64],
    (residual, all): (usize, usize),
) -> Weighted<'a> {
    let (multipliers, edges) = multipliers[missed.rank * all..][..all].split_at(residual);
    Weighted {
        share: Share::above(ranks.len()),
        multipliers,
        edges,
        own: descent.question.problem.ranks().rows_of(missed.rank),
    }
}
