//! Constraint rows of unreached levels: derivatives of their cost gradients.
//!
//! An unreached level is at ∇L = 0 in the null space of the levels above. Its Lagrangian is L = ½‖r‖² + λᵀr↑ with the
//! reached levels' residuals r↑ and their multipliers λ (Nocedal & Wright 2006, section 12.5). A step Δ keeps ∇L = 0 to
//! first order if P ∇²L Δ = 0. P is the projection onto the null space of the levels above.

use nalgebra::DMatrix;

use super::descent_problem::DescentProblem;
use super::inequalities::LevelInequalities;
use super::level_constraints::{LevelConstraint, is_of_reached};
use super::slope_differences::{SlopeDifferences, WeightedGradient};
use crate::problem::{Problem, TaskSubset};
use crate::solver::{RowSpan, dot};

/// Part of a row outside the span, relative to its level's rows, above which the row is independent.
pub(super) const MIN_INDEPENDENT_PART: f64 = 1e-9;
/// As `MIN_INDEPENDENT_PART`, for curvature rows, which come from finite differences.
pub(super) const MIN_INDEPENDENT_CURVATURE: f64 = 1e-5;

/// Constraint rows of unreached levels, with scratch memory.
#[derive(Clone, Debug, Default)]
pub(super) struct LevelCurvature {
    /// Constraint Jacobian C: n rows for a lone level, else the residual rows, one row per inequality, and n rows per
    /// level.
    rows: DMatrix<f64>,
    /// Number of residual rows, and number of residual and inequality rows.
    pub(super) residual_rows: usize,
    pub(super) constraint_rows: usize,
    /// Change of the constrained values.
    change: Vec<f64>,
    pub(super) slope: Vec<f64>,
    differences: SlopeDifferences,
    /// Weights of the row gradients in each unreached level's ∇L, level by level.
    pub(super) multipliers: Vec<f64>,
    /// Row span of the levels above each unreached one.
    higher_spans: Vec<RowSpan>,
    pub(super) span: RowSpan,
}

impl LevelCurvature {
    /// Resizes for the levels above one level. Returns the maximum number of rows.
    pub(super) fn fit(&mut self, problem: &Problem, rank: usize) -> usize {
        let n = problem.variables();
        let rows = problem.rows_of(TaskSubset::above(rank));
        self.slope.resize(n, 0.0);
        self.differences.fit(n, rows);
        let edges = problem.slacks_above(rank);
        (self.residual_rows, self.constraint_rows) = (rows, rows + edges);
        let total_rows = match rank {
            1 => n,
            _ => rows + edges + n * rank,
        };
        if self.rows.shape() != (total_rows, n) {
            self.rows = DMatrix::zeros(total_rows, n);
        }
        if rank > 1 {
            self.change.resize(total_rows, 0.0);
            self.multipliers.resize((rows + edges) * rank, 0.0);
            self.higher_spans.resize_with(rank, RowSpan::default);
        }
        total_rows
    }

    /// Constraint Jacobian C.
    pub(super) fn rows(&self) -> &DMatrix<f64> {
        &self.rows
    }

    pub(super) fn rows_mut(&mut self) -> &mut DMatrix<f64> {
        &mut self.rows
    }

    /// Computes the Hessian of the cost of a lone level at x.
    pub(super) fn compute_first_level(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        x: &[f64],
        fixed: &[bool],
    ) {
        let n = x.len();
        let cost = WeightedGradient {
            subset: TaskSubset::rank(0),
            multipliers: &[],
            inequality_multipliers: &[],
            residual_rows: 0..0,
        };
        (self.differences).columns(descent, &cost, x, fixed, |j, column| {
            self.rows.as_mut_slice()[j * n..(j + 1) * n].copy_from_slice(column);
        });
    }

    /// Computes the rows of all levels at x, from their Jacobian and residual there.
    pub(super) fn compute_all_levels(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (ranks, inequalities): (&[LevelConstraint], &LevelInequalities),
        x: &[f64],
        (jacobian, residual): (&DMatrix<f64>, &[f64]),
        fixed: &[bool],
    ) {
        self.rows.as_mut_slice().fill(0.0);
        self.copy_rows(jacobian, self.residual_rows..self.constraint_rows);
        let mut span = std::mem::take(&mut self.span);
        span.clear();
        for level in ranks {
            let row_range = descent.instance.problem.ranks().rows_of(level.rank);
            if level.reached {
                self.copy_rows(jacobian, row_range.clone());
                add_rows(&mut span, jacobian, row_range, fixed, MIN_INDEPENDENT_PART);
                for edge in inequalities.locked_of(level.rank) {
                    let row = self.residual_rows + edge;
                    add_rows(
                        &mut span,
                        jacobian,
                        row..row + 1,
                        fixed,
                        MIN_INDEPENDENT_PART,
                    );
                }
                continue;
            }
            self.compute_multipliers(descent, ranks, level, &mut span, (jacobian, residual));
            self.higher_spans[level.rank].clone_from(&span);
            self.differentiate_slope(descent, (ranks, level), x, fixed);
            let first = self.constraint_rows + level.rank * x.len();
            let row_range = first..first + x.len();
            add_rows(
                &mut span,
                &self.rows,
                row_range,
                fixed,
                MIN_INDEPENDENT_CURVATURE,
            );
        }
        self.span = span;
    }

    /// Computes the weights of all row gradients in an unreached level's ∇L: multipliers, and its own residual.
    pub(super) fn compute_multipliers(
        &mut self,
        descent: &DescentProblem<'_, '_>,
        ranks: &[LevelConstraint],
        unreached: &LevelConstraint,
        span: &mut RowSpan,
        (jacobian, residual): (&DMatrix<f64>, &[f64]),
    ) {
        let (rows, first) = (self.constraint_rows, self.residual_rows);
        let row_range = descent.instance.problem.ranks().rows_of(unreached.rank);
        let slope = &mut self.slope;
        let columns = jacobian.as_slice().chunks_exact(rows.max(1));
        for (slope, column) in slope.iter_mut().zip(columns) {
            *slope = dot(&column[row_range.clone()], &residual[row_range.clone()]);
        }
        let multipliers = &mut self.multipliers[unreached.rank * rows..(unreached.rank + 1) * rows];
        multipliers.fill(0.0);
        for (row, multiplier) in span.multipliers(slope) {
            let is_edge = (first..rows).contains(&row);
            if is_edge || is_of_reached(descent.instance.problem, ranks, row) {
                multipliers[row] = multiplier;
            }
        }
        multipliers[row_range.clone()].copy_from_slice(&residual[row_range]);
    }

    /// Computes P ∇L of every unreached level at a trial.
    pub(super) fn compute_slopes(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        ranks: &[LevelConstraint],
        trial: &[f64],
        fixed: &[bool],
    ) {
        let (rows, n) = ((self.residual_rows, self.constraint_rows), trial.len());
        for unreached in ranks.iter().filter(|level| !level.reached) {
            let weighted = lagrangian(descent, ranks, unreached, &self.multipliers, rows);
            let slope = self.differences.slope(descent, &weighted, trial, fixed);
            self.higher_spans[unreached.rank].project_out(slope);
            let first = rows.1 + unreached.rank * n;
            self.change[first..first + n].copy_from_slice(slope);
        }
    }

    /// Computes P ∇²L of an unreached level.
    fn differentiate_slope(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (ranks, unreached): (&[LevelConstraint], &LevelConstraint),
        x: &[f64],
        fixed: &[bool],
    ) {
        let n = x.len();
        let (order, rows) = (
            self.rows.nrows(),
            (self.residual_rows, self.constraint_rows),
        );
        let weighted = lagrangian(descent, ranks, unreached, &self.multipliers, rows);
        (self.differences).columns(descent, &weighted, x, fixed, |j, column| {
            self.higher_spans[unreached.rank].project_out(column);
            let first = j * order + rows.1 + unreached.rank * n;
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
        for level in ranks {
            let row_range = descent.instance.problem.ranks().rows_of(level.rank);
            match level.reached {
                true => {
                    self.change[row_range.clone()]
                        .copy_from_slice(&residual_change[row_range.clone()]);
                    self.copy_rows(jacobian, row_range);
                }
                false => self.change[row_range].fill(0.0),
            }
        }
        let edges = self.residual_rows..self.constraint_rows;
        self.change[edges.clone()].copy_from_slice(&residual_change[edges.clone()]);
        self.copy_rows(jacobian, edges);
        (&self.rows, &self.change)
    }

    fn copy_rows(&mut self, jacobian: &DMatrix<f64>, row_range: std::ops::Range<usize>) {
        let (order, rows) = (self.rows.nrows(), jacobian.nrows());
        let columns = self.rows.as_mut_slice().chunks_exact_mut(order.max(1));
        for (to, from) in columns.zip(jacobian.as_slice().chunks_exact(rows.max(1))) {
            to[row_range.clone()].copy_from_slice(&from[row_range.clone()]);
        }
    }
}

/// Adds rows of a matrix, restricted to free variables, if their independent part exceeds `min_part` of their common
/// norm.
pub(super) fn add_rows(
    space: &mut RowSpan,
    matrix: &DMatrix<f64>,
    rows: std::ops::Range<usize>,
    fixed: &[bool],
    min_part: f64,
) {
    let columns = || {
        let columns = matrix.as_slice().chunks_exact(matrix.nrows().max(1));
        columns.zip(fixed)
    };
    let free_columns = columns().filter(|(_, fixed)| !**fixed);
    let squared: f64 =
        (free_columns.map(|(column, _)| dot(&column[rows.clone()], &column[rows.clone()]))).sum();
    for row in rows {
        let entries = columns().map(|(column, fixed)| if *fixed { 0.0 } else { column[row] });
        space.add(row, entries, min_part * squared.sqrt());
    }
}

/// Returns the gradient weights of an unreached level's L: its own residual and the multipliers of the other rows.
fn lagrangian<'a>(
    descent: &DescentProblem<'_, '_>,
    ranks: &[LevelConstraint],
    unreached: &LevelConstraint,
    multipliers: &'a [f64],
    (residual_rows, constraint_rows): (usize, usize),
) -> WeightedGradient<'a> {
    let (multipliers, edges) =
        multipliers[unreached.rank * constraint_rows..][..constraint_rows].split_at(residual_rows);
    WeightedGradient {
        subset: TaskSubset::above(ranks.len()),
        multipliers,
        inequality_multipliers: edges,
        residual_rows: descent.instance.problem.ranks().rows_of(unreached.rank),
    }
}
