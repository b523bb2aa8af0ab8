//! The rows that hold missed ranks: by how much a step would tilt their costs.
//!
//! A missed rank stands where ∇L = 0 along what the ranks above leave free, for L = ½‖r‖² + λᵀr↑ with the
//! reached ranks' residuals r↑ and their multipliers λ (Nocedal & Wright 2006, section 12.5). A step Δ leaves it
//! there, in first order, where P ∇²L Δ = 0, P the projection onto what the ranks above leave free.

use nalgebra::DMatrix;

use super::asked::Asked;
use super::held::{HeldRank, is_of_reached};
use super::slope_differences::{SlopeDifferences, Weighted};
use crate::problem::{Problem, Share};
use crate::solver::{RowSpan, dot, half_squared, negligible_slope};

/// A row adds to those above it if so much of it is new, as a share of its rank's length, …
pub(super) const NEW: f64 = 1e-9;
/// … and a row of a curvature, which is a difference.
pub(super) const NEW_CURVATURE: f64 = 1e-5;

/// The rows that hold missed ranks, and room to take them.
#[derive(Clone, Debug, Default)]
pub(super) struct Curvature {
    /// What a step may not change: of missed ranks alone n rows; of several the rows of all, then n for each
    /// missed one.
    rows: DMatrix<f64>,
    /// By how much it has changed.
    change: Vec<f64>,
    slope: Vec<f64>,
    differences: SlopeDifferences,
    /// What multiplies the gradients of the rows in each missed rank's L, rank by rank.
    multipliers: Vec<f64>,
    /// What the ranks above each missed one take, and leave.
    above: Vec<RowSpan>,
    running: RowSpan,
}

impl Curvature {
    /// Makes room for the ranks above one; how many rows that may be.
    pub(super) fn fit(&mut self, problem: &Problem, rank: usize) -> usize {
        let n = problem.variables();
        let rows = problem.rows_of(Share::above(rank));
        self.slope.resize(n, 0.0);
        self.differences.fit(n, rows);
        let own = match rank {
            1 => n,
            _ => rows + n * rank,
        };
        if self.rows.shape() != (own, n) {
            self.rows = DMatrix::zeros(own, n);
        }
        if rank > 1 {
            self.change.resize(own, 0.0);
            self.multipliers.resize(rows * rank, 0.0);
            self.above.resize_with(rank, RowSpan::default);
        }
        own
    }

    /// C: what a step may not change.
    pub(super) fn rows(&self) -> &DMatrix<f64> {
        &self.rows
    }

    /// The second derivative of a lone rank's cost at x.
    pub(super) fn of_first(&mut self, asked: &mut Asked<'_, '_>, x: &[f64], fixed: &[bool]) {
        let n = x.len();
        let Self {
            rows, differences, ..
        } = self;
        let of = Weighted {
            share: Share::rank(0),
            multipliers: &[],
            own: 0..0,
        };
        differences.columns(asked, &of, x, fixed, |j, column| {
            rows.as_mut_slice()[j * n..(j + 1) * n].copy_from_slice(column);
        });
    }

    /// The rows of all ranks at x, by their Jacobian and residual there.
    pub(super) fn of_all(
        &mut self,
        asked: &mut Asked<'_, '_>,
        ranks: &[HeldRank],
        x: &[f64],
        (jacobian, residual): (&DMatrix<f64>, &[f64]),
        fixed: &[bool],
    ) {
        self.rows.as_mut_slice().fill(0.0);
        let mut above = std::mem::take(&mut self.running);
        above.clear();
        for held in ranks {
            let own = asked.question.problem.ranks().rows_of(held.rank);
            if held.reached {
                self.copy_rows(jacobian, own.clone());
                add_rows(&mut above, jacobian, own, fixed, NEW);
                continue;
            }
            self.take_multipliers(asked, ranks, held, &mut above, (jacobian, residual));
            self.above[held.rank].clone_from(&above);
            self.differentiate_slope(asked, (ranks, held), x, fixed);
            let first = residual.len() + held.rank * x.len();
            let own = first..first + x.len();
            add_rows(&mut above, &self.rows, own, fixed, NEW_CURVATURE);
        }
        self.running = above;
    }

    /// Whether a row of a reached rank has a say in where a missed one stands.
    pub(super) fn weighs(&self, ranks: &[HeldRank], row: usize) -> bool {
        let rows = self.change.len() - ranks.len() * self.slope.len();
        let mut missed = ranks.iter().filter(|held| !held.reached);
        missed.any(|held| {
            let own = &self.multipliers[held.rank * rows..(held.rank + 1) * rows];
            let most = own.iter().fold(0.0_f64, |most, m| most.max(m.abs()));
            own[row].abs() > NEW * most
        })
    }

    /// Fixes the variables that stand on a bound for a missed rank's sake.
    pub(super) fn fix(
        &mut self,
        asked: &mut Asked<'_, '_>,
        ranks: &[HeldRank],
        x: &[f64],
        jacobian: &DMatrix<f64>,
        residual: &[f64],
        fixed: &mut [bool],
    ) {
        let space = asked.question.space();
        // Multipliers are sought with what may go both ways.
        let bound: Vec<bool> = (0..x.len())
            .map(|j| !space.is_between_bounds(x, j))
            .collect();
        let mut above = std::mem::take(&mut self.running);
        above.clear();
        for held in ranks {
            let own = asked.question.problem.ranks().rows_of(held.rank);
            if held.reached {
                add_rows(&mut above, jacobian, own, &bound, NEW);
                continue;
            }
            self.take_multipliers(asked, ranks, held, &mut above, (jacobian, residual));
            let rows = residual.len();
            let multipliers = &self.multipliers[held.rank * rows..(held.rank + 1) * rows];
            let columns = jacobian.as_slice().chunks_exact(residual.len().max(1));
            let mut steepest = 0.0_f64;
            for (slope, column) in self.slope.iter_mut().zip(columns) {
                *slope = dot(column, multipliers);
                let own = &column[own.clone()];
                steepest = steepest.max(dot(own, own).sqrt());
            }
            let cost = half_squared(&residual[own]);
            let negligible = negligible_slope(steepest, cost, &asked.stopping);
            for (j, fixed) in fixed.iter_mut().enumerate() {
                *fixed |= space.holds(x, j, self.slope[j], negligible);
            }
        }
        self.running = above;
    }

    /// λ of a missed rank, with its own residual where its rows are: what multiplies all rows' gradients in ∇L.
    fn take_multipliers(
        &mut self,
        asked: &Asked<'_, '_>,
        ranks: &[HeldRank],
        missed: &HeldRank,
        above: &mut RowSpan,
        (jacobian, residual): (&DMatrix<f64>, &[f64]),
    ) {
        let rows = residual.len();
        let own = asked.question.problem.ranks().rows_of(missed.rank);
        let slope = &mut self.slope;
        let columns = jacobian.as_slice().chunks_exact(rows.max(1));
        for (slope, column) in slope.iter_mut().zip(columns) {
            *slope = dot(&column[own.clone()], &residual[own.clone()]);
        }
        let multipliers = &mut self.multipliers[missed.rank * rows..(missed.rank + 1) * rows];
        multipliers.fill(0.0);
        for (row, multiplier) in above.multipliers(slope) {
            if is_of_reached(asked.question.problem, ranks, row) {
                multipliers[row] = multiplier;
            }
        }
        multipliers[own.clone()].copy_from_slice(&residual[own]);
    }

    /// P ∇L of every missed rank at a trial.
    pub(super) fn slopes(
        &mut self,
        asked: &mut Asked<'_, '_>,
        ranks: &[HeldRank],
        trial: &[f64],
        fixed: &[bool],
    ) {
        let (rows, n) = (self.change.len() - ranks.len() * trial.len(), trial.len());
        for missed in ranks.iter().filter(|held| !held.reached) {
            let Self {
                change,
                differences,
                multipliers,
                above,
                ..
            } = self;
            let of = lagrangian(asked, ranks, missed, multipliers, rows);
            let slope = differences.slope(asked, &of, trial, fixed);
            above[missed.rank].project_out(slope);
            let first = rows + missed.rank * n;
            change[first..first + n].copy_from_slice(slope);
        }
    }

    /// P ∇²L of a missed rank.
    fn differentiate_slope(
        &mut self,
        asked: &mut Asked<'_, '_>,
        (ranks, missed): (&[HeldRank], &HeldRank),
        x: &[f64],
        fixed: &[bool],
    ) {
        let n = x.len();
        let Self {
            rows: to,
            differences,
            multipliers,
            above,
            ..
        } = self;
        let order = to.nrows();
        let rows = order - ranks.len() * n;
        let of = lagrangian(asked, ranks, missed, multipliers, rows);
        differences.columns(asked, &of, x, fixed, |j, column| {
            above[missed.rank].project_out(column);
            let first = j * order + rows + missed.rank * n;
            to.as_mut_slice()[first..first + n].copy_from_slice(column);
        });
    }

    /// Newton's system at a trial: the rows there, of reached ranks by their Jacobian and of missed ones as they
    /// were taken, and what has changed, of reached ranks their residual.
    pub(super) fn system(
        &mut self,
        asked: &Asked<'_, '_>,
        ranks: &[HeldRank],
        jacobian: &DMatrix<f64>,
        residual_change: &[f64],
    ) -> (&DMatrix<f64>, &[f64]) {
        for held in ranks {
            let own = asked.question.problem.ranks().rows_of(held.rank);
            match held.reached {
                true => {
                    self.change[own.clone()].copy_from_slice(&residual_change[own.clone()]);
                    self.copy_rows(jacobian, own);
                }
                false => self.change[own].fill(0.0),
            }
        }
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
    asked: &Asked<'_, '_>,
    ranks: &[HeldRank],
    missed: &HeldRank,
    multipliers: &'a [f64],
    rows: usize,
) -> Weighted<'a> {
    Weighted {
        share: Share::above(ranks.len()),
        multipliers: &multipliers[missed.rank * rows..(missed.rank + 1) * rows],
        own: asked.question.problem.ranks().rows_of(missed.rank),
    }
}
