//! Constraints of a descent: the levels above it stay at the results of their own searches.
//!
//! The constraint of a reached level is J Δ = 0, and Newton's method corrects second-order errors of a step. An
//! unreached level is at its lowest cost within the levels above it. Its Jacobian loses rank at a stretched limb,
//! although bending the limb would raise the cost. The [curvature](super::curvature) of its cost therefore replaces the
//! Jacobian: a step that keeps the cost gradient at zero keeps the cost.

use nalgebra::DMatrix;

use super::curvature::{LevelCurvature, MIN_INDEPENDENT_CURVATURE, MIN_INDEPENDENT_PART, add_rows};
use super::descent_problem::DescentProblem;
use super::inequalities::LevelInequalities;
use crate::problem::{Evaluation, Problem, TaskSubset};
use crate::solver::{RowSpan, half_squared, negligible_slope};

/// Relative increase of an unreached level's cost that is tolerated.
pub(super) const COST_TOLERANCE: f64 = 1e-9;
/// Smallest relative decrease of the cost that justifies a step.
const MIN_RELATIVE_DECREASE: f64 = 1e-9;
/// As `MIN_RELATIVE_DECREASE`, below an unreached level, whose constraints are less accurate.
const MIN_RELATIVE_DECREASE_BELOW_UNREACHED: f64 = 1e-7;

/// Results of the levels above.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum HigherLevels {
    /// All levels are reached.
    #[default]
    Reached,
    /// There is one level, and it is unreached.
    FirstUnreached,
    /// Some levels are reached, some are not.
    Mixed,
}

/// Constraint from one level.
#[derive(Clone, Copy, Debug)]
pub(super) struct LevelConstraint {
    pub(super) rank: usize,
    pub(super) reached: bool,
    /// Cost ½‖r‖² after its own search.
    pub(super) cost: f64,
}

/// Returns whether a residual row belongs to a reached level.
pub(super) fn is_of_reached(problem: &Problem, ranks: &[LevelConstraint], row: usize) -> bool {
    let mut reached = ranks.iter().filter(|level| level.reached);
    reached.any(|level| problem.ranks().rows_of(level.rank).contains(&row))
}

/// Constraints from the levels above one level, with scratch memory.
#[derive(Clone, Debug, Default)]
pub(super) struct LevelConstraints {
    pub(super) ranks: Vec<LevelConstraint>,
    pub(super) higher_levels: HigherLevels,
    /// Residual after the searches of these levels.
    pub(super) held_residual: Vec<f64>,
    /// Change of the residual at a trial, followed by the violations of inequalities.
    pub(super) residual_change: Vec<f64>,
    /// Constraint Jacobian of reached levels: residual rows, then one row per inequality.
    pub(super) jacobian: DMatrix<f64>,
    pub(super) residual_jacobian: DMatrix<f64>,
    pub(super) inequalities: LevelInequalities,
    pub(super) curvature: LevelCurvature,
    /// Variables before a correction, and the correction.
    pub(super) uncorrected: Vec<f64>,
    pub(super) correction: Vec<f64>,
}

impl LevelConstraints {
    /// Resizes for the levels above `rank`. Returns the maximum number of constraint rows.
    pub(super) fn fit(&mut self, problem: &Problem, rank: usize) -> usize {
        let n = problem.variables();
        let rows = problem.rows_of(TaskSubset::above(rank));
        self.held_residual.resize(rows, 0.0);
        let edges = problem.slacks_above(rank);
        self.residual_change.resize(rows + edges, 0.0);
        self.inequalities.fit(edges, rows, n);
        self.uncorrected.resize(n, 0.0);
        self.correction.resize(n, 0.0);
        for (matrix, rows) in [
            (&mut self.jacobian, rows + edges),
            (
                &mut self.residual_jacobian,
                if edges > 0 { rows } else { 0 },
            ),
        ] {
            if matrix.shape() != (rows, n) {
                *matrix = DMatrix::zeros(rows, n);
            }
        }
        self.ranks.clear();
        self.ranks.reserve(rank);
        (rows + edges).max(self.curvature.fit(problem, rank))
    }

    pub(super) fn subset(&self) -> TaskSubset {
        TaskSubset::above(self.ranks.len())
    }

    /// Returns the smallest relative decrease of the cost that justifies a step.
    pub(super) fn min_relative_decrease(&self) -> f64 {
        match self.higher_levels {
            HigherLevels::Reached => MIN_RELATIVE_DECREASE,
            HigherLevels::FirstUnreached | HigherLevels::Mixed => {
                MIN_RELATIVE_DECREASE_BELOW_UNREACHED
            }
        }
    }

    /// Constrains the levels above `rank` to their residual at x, and fixes the variables at bounds that an unreached
    /// level pushes against. Returns whether all levels are reached.
    pub(super) fn constrain_to(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        rank: usize,
        x: &[f64],
        residual: &[f64],
        fixed: &mut [bool],
    ) -> bool {
        let problem = descent.instance.problem;
        self.held_residual.copy_from_slice(residual);
        self.ranks.clear();
        self.ranks.extend((0..rank).map(|rank| {
            let level_residual = &residual[problem.ranks().rows_of(rank)];
            let is_required = rank < problem.ranks().levels();
            LevelConstraint {
                rank,
                reached: is_required
                    && problem.is_reached_by(TaskSubset::rank(rank), level_residual),
                cost: half_squared(level_residual),
            }
        }));
        let unreached = self.ranks.iter().filter(|rank| !rank.reached).count();
        self.higher_levels = match unreached {
            0 => HigherLevels::Reached,
            1 if rank == 1 => HigherLevels::FirstUnreached,
            _ => HigherLevels::Mixed,
        };
        self.inequalities.select(descent, &self.ranks, x);
        fixed.fill(false);
        match self.higher_levels {
            HigherLevels::Reached => {}
            HigherLevels::FirstUnreached => self.fix_first_level_bounds(descent, x, fixed),
            HigherLevels::Mixed => {
                self.compute_jacobian(descent, x, false);
                let jacobian_and_residual = (&self.jacobian, &self.held_residual[..]);
                let (ranks, inequalities) = (&self.ranks, &mut self.inequalities);
                self.curvature.fix_active_bounds(
                    descent,
                    (ranks, inequalities),
                    x,
                    jacobian_and_residual,
                    fixed,
                );
            }
        }
        self.higher_levels == HigherLevels::Reached
    }

    /// Sets the constrained residual of the first rows, and returns its previous values.
    pub(super) fn set_held_residual(&mut self, values: &[f64]) -> Vec<f64> {
        let residual = &mut self.held_residual[..values.len()];
        let previous = residual.to_vec();
        residual.copy_from_slice(values);
        previous
    }

    fn fix_first_level_bounds(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        x: &[f64],
        fixed: &mut [bool],
    ) {
        let subset = self.subset();
        let mut evaluation = Evaluation::of(subset, descent.instance, descent.scratch);
        let (gradient, column_norm) =
            descent
                .state
                .slope_at(&mut evaluation, x, &self.held_residual);
        let cost = half_squared(&self.held_residual);
        let negligible = negligible_slope(column_norm, cost, &descent.stopping);
        for (j, fixed) in fixed.iter_mut().enumerate() {
            *fixed = descent
                .instance
                .space()
                .holds(x, j, gradient[j], negligible);
        }
    }

    /// Computes the constraint Jacobian C at x, with the active inequalities. Steps satisfy C Δ = 0.
    pub(super) fn compute_rows(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        x: &[f64],
        fixed: &[bool],
        has_stepped: bool,
    ) {
        if self.higher_levels == HigherLevels::FirstUnreached {
            return self.curvature.compute_first_level(descent, x, &[]);
        }
        self.compute_jacobian(descent, x, has_stepped);
        if self.higher_levels == HigherLevels::Mixed {
            let rows = self.held_residual.len();
            descent.residual(self.subset(), x, &mut self.residual_change[..rows]);
            let jacobian_and_residual = (&self.jacobian, &self.residual_change[..rows]);
            let (ranks, inequalities) = (&self.ranks, &self.inequalities);
            self.curvature.compute_all_levels(
                descent,
                (ranks, inequalities),
                x,
                jacobian_and_residual,
                fixed,
            );
        }
    }

    /// Computes the rows of reached levels and of the active inequalities.
    fn compute_jacobian(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        x: &[f64],
        has_stepped: bool,
    ) {
        let subset = self.subset();
        if self.inequalities.len() == 0 {
            return descent.constraint_jacobian(subset, x, &mut self.jacobian);
        }
        descent.constraint_jacobian(subset, x, &mut self.residual_jacobian);
        self.inequalities.evaluate(descent, self.ranks.len(), x);
        self.inequalities.choose_active_set(has_stepped);
        self.inequalities
            .write_constraint_jacobian(&self.residual_jacobian, &mut self.jacobian);
    }

    /// Removes an inequality that is pulled inward from C. Returns whether there was one.
    pub(super) fn drop_inward(&mut self, multipliers: &[f64]) -> bool {
        let Some(edge) = self.inequalities.drop_inward(multipliers) else {
            return false;
        };
        let row = self.held_residual.len() + edge;
        let jacobian = match self.higher_levels {
            HigherLevels::Mixed => self.curvature.rows_mut(),
            HigherLevels::Reached | HigherLevels::FirstUnreached => &mut self.jacobian,
        };
        jacobian.row_mut(row).fill(0.0);
        true
    }

    /// Last computed constraint Jacobian C.
    pub(super) fn rows(&self) -> &DMatrix<f64> {
        match self.higher_levels {
            HigherLevels::Reached => &self.jacobian,
            HigherLevels::FirstUnreached | HigherLevels::Mixed => self.curvature.rows(),
        }
    }

    /// Adds the rows of C, restricted to the variables that are not fixed, to a span.
    pub(super) fn add_to_span(&self, problem: &Problem, span: &mut RowSpan, fixed: &[bool]) {
        let (rows, n) = (self.jacobian.nrows(), fixed.len());
        for level in &self.ranks {
            let (row_range, min_part) = match (self.higher_levels, level.reached) {
                (HigherLevels::FirstUnreached, _) => (0..n, MIN_INDEPENDENT_CURVATURE),
                (_, true) => (problem.ranks().rows_of(level.rank), MIN_INDEPENDENT_PART),
                (_, false) => {
                    let first = rows + level.rank * n;
                    (first..first + n, MIN_INDEPENDENT_CURVATURE)
                }
            };
            add_rows(span, self.rows(), row_range, fixed, min_part);
            for edge in self.inequalities.locked_of(level.rank) {
                let row = self.held_residual.len() + edge;
                add_rows(span, self.rows(), row..row + 1, fixed, MIN_INDEPENDENT_PART);
            }
        }
    }

    /// Adds the rows of the active set.
    pub(super) fn add_active_to_span(&self, span: &mut RowSpan, fixed: &[bool]) {
        for edge in self.inequalities.active_set() {
            let row = self.held_residual.len() + edge;
            add_rows(span, self.rows(), row..row + 1, fixed, MIN_INDEPENDENT_PART);
        }
    }

    /// Adds the span's part of a gradient to it, and writes the multipliers of inequalities and of rows of reached
    /// levels.
    pub(super) fn apply_multipliers(
        &self,
        problem: &Problem,
        span: &mut RowSpan,
        slope: &mut [f64],
        (weights, edges): (&mut [f64], &mut [f64]),
    ) {
        let rows = self.rows();
        for (row, multiplier) in span.multipliers(slope) {
            let columns = rows.as_slice().chunks_exact(rows.nrows().max(1));
            for (slope, column) in slope.iter_mut().zip(columns) {
                *slope += multiplier * column[row];
            }
            match row.checked_sub(self.held_residual.len()) {
                None if is_of_reached(problem, &self.ranks, row) => weights[row] = multiplier,
                Some(edge) if edge < self.inequalities.len() => edges[edge] = multiplier,
                _ => {}
            }
        }
    }
}
