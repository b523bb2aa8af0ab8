//! Constraint rows of unreached levels: derivatives of their cost gradients.
//!
//! An unreached level is at ∇L = 0 in the null space of the levels above. Its Lagrangian is L = ½‖r‖² + λᵀr↑ with the
//! reached levels' residuals r↑ and their multipliers λ (Nocedal & Wright 2006, section 12.5). A step Δ keeps ∇L = 0 to
//! first order if P ∇²L Δ = 0. P is the projection onto the null space of the levels above.

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use super::inequalities::LevelInequalities;
use super::level_constraints::{LevelConstraint, is_of_reached};
use super::slope_differences::{SlopeDifferences, Weighted};
use crate::problem::{Problem, TaskSubset};
use crate::solver::{RowSpan, dot};

/// Part of a row outside the span, relative to its level's rows, above which the row is independent.
pub(super) const NEW: f64 = 1e-9;
/// As `NEW`, for curvature rows, which come from finite differences.
pub(super) const NEW_CURVATURE: f64 = 1e-5;

/// Constraint rows of unreached levels, with scratch memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Curvature {
    /// Constraint Jacobian C: n rows for a lone level, else the residual rows, one row per inequality, and n rows per
    /// level.
    rows: DMatrix<f64>,
    /// Number of residual rows, and number of residual and inequality rows.
    pub(super) residual: usize,
    pub(super) first: usize,
    /// Change of the constrained values.
    change: Vec<f64>,
    pub(super) slope: Vec<f64>,
    differences: SlopeDifferences,
    /// Weights of the row gradients in each unreached level's ∇L, level by level.
    pub(super) multipliers: Vec<f64>,
    /// Row span of the levels above each unreached one.
    above: Vec<RowSpan>,
    pub(super) running: RowSpan,
}

impl Curvature {
    /// Resizes for the levels above one level. Returns the maximum number of rows.
    pub(super) fn fit(&mut self, problem: &Problem, rank: usize) -> usize {
        let n = problem.variables();
        let rows = problem.rows_of(TaskSubset::above(rank));
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

    /// Constraint Jacobian C.
    pub(super) fn rows(&self) -> &DMatrix<f64> {
        &self.rows
    }

    pub(super) fn rows_mut(&mut self) -> &mut DMatrix<f64> {
        &mut self.rows
    }

    /// Computes the Hessian of the cost of a lone level at x.
    pub(super) fn of_first(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        x: &[f64],
        fixed: &[bool],
    ) {
        let n = x.len();
        let of = Weighted {
            share: TaskSubset::rank(0),
            multipliers: &[],
            edges: &[],
            own: 0..0,
        };
        (self.differences).columns(descent, &of, x, fixed, |j, column| {
            self.rows.as_mut_slice()[j * n..(j + 1) * n].copy_from_slice(column);
        });
    }

    /// Computes the rows of all levels at x, from their Jacobian and residual there.
    pub(super) fn of_all(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (ranks, inequalities): (&[LevelConstraint], &LevelInequalities),
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
                for edge in inequalities.locked_of(held.rank) {
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

    /// Computes the weights of all row gradients in an unreached level's ∇L: multipliers, and its own residual.
    pub(super) fn take_multipliers(
        &mut self,
        descent: &DescentProblem<'_, '_>,
        ranks: &[LevelConstraint],
        missed: &LevelConstraint,
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

    /// Computes P ∇L of every unreached level at a trial.
    pub(super) fn slopes(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        ranks: &[LevelConstraint],
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

    /// Computes P ∇²L of an unreached level.
    fn differentiate_slope(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (ranks, missed): (&[LevelConstraint], &LevelConstraint),
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

    /// Returns Newton's system at a trial: constraint rows and changes.
    ///
    /// Reached levels contribute their Jacobian and residual change there. Unreached levels contribute the last
    /// computed rows.
    pub(super) fn system(
        &mut self,
        descent: &DescentProblem<'_, '_>,
        ranks: &[LevelConstraint],
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

/// Adds rows of a matrix, restricted to free variables, if their independent part exceeds `share` of their common norm.
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

/// Returns the gradient weights of an unreached level's L: its own residual and the multipliers of the other rows.
fn lagrangian<'a>(
    descent: &DescentProblem<'_, '_>,
    ranks: &[LevelConstraint],
    missed: &LevelConstraint,
    multipliers: &'a [f64],
    (residual, all): (usize, usize),
) -> Weighted<'a> {
    let (multipliers, edges) = multipliers[missed.rank * all..][..all].split_at(residual);
    Weighted {
        share: TaskSubset::above(ranks.len()),
        multipliers,
        edges,
        own: descent.question.problem.ranks().rows_of(missed.rank),
    }
}
