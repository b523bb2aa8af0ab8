//! Constraints of a descent: the levels above it stay at the results of their own searches.
//!
//! The constraint of a reached level is J Δ = 0, and Newton's method corrects second-order errors of a step. An
//! unreached level is at its lowest cost within the levels above it. Its Jacobian loses rank at a stretched limb,
//! although bending the limb would raise the cost. The [curvature](super::curvature) of its cost therefore replaces the
//! Jacobian: a step that keeps the cost gradient at zero keeps the cost.

use nalgebra::DMatrix;

use super::curvature::{Curvature, NEW, NEW_CURVATURE, add_rows};
use super::descent_problem::DescentProblem;
use super::inequalities::LevelInequalities;
use crate::problem::{Evaluation, Problem, TaskSubset};
use crate::solver::{RowSpan, half_squared, negligible_slope};

/// Relative increase of an unreached level's cost that is tolerated.
pub(super) const SAME_MISS: f64 = 1e-9;
/// Smallest relative decrease of the cost that justifies a step.
const WORTHWHILE: f64 = 1e-9;
/// As `WORTHWHILE`, below an unreached level, whose constraints are less accurate.
const WORTHWHILE_BELOW_A_MISS: f64 = 1e-7;

/// Results of the levels above.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum HigherLevels {
    /// All levels are reached.
    #[default]
    Reached,
    /// There is one level, and it is unreached.
    FirstMissed,
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
    let mut reached = ranks.iter().filter(|held| held.reached);
    reached.any(|held| problem.ranks().rows_of(held.rank).contains(&row))
}

/// Constraints from the levels above one level, with scratch memory.
#[derive(Clone, Debug, Default)]
pub(super) struct Held {
    pub(super) ranks: Vec<LevelConstraint>,
    pub(super) above: HigherLevels,
    /// Residual after the searches of these levels.
    pub(super) kept: Vec<f64>,
    /// Change of the residual at a trial, followed by the violations of inequalities.
    pub(super) now: Vec<f64>,
    /// Constraint Jacobian of reached levels: residual rows, then one row per inequality.
    pub(super) jacobian: DMatrix<f64>,
    pub(super) of_residual: DMatrix<f64>,
    pub(super) inequalities: LevelInequalities,
    pub(super) curvature: Curvature,
    /// Variables before a correction, and the correction.
    pub(super) uncorrected: Vec<f64>,
    pub(super) back: Vec<f64>,
}

impl Held {
    /// Resizes for the levels above `rank`. Returns the maximum number of constraint rows.
    pub(super) fn fit(&mut self, problem: &Problem, rank: usize) -> usize {
        let n = problem.variables();
        let rows = problem.rows_of(TaskSubset::above(rank));
        self.kept.resize(rows, 0.0);
        let edges = problem.edges_above(rank);
        self.now.resize(rows + edges, 0.0);
        self.inequalities.fit(edges, rows, n);
        self.uncorrected.resize(n, 0.0);
        self.back.resize(n, 0.0);
        for (matrix, rows) in [
            (&mut self.jacobian, rows + edges),
            (&mut self.of_residual, if edges > 0 { rows } else { 0 }),
        ] {
            if matrix.shape() != (rows, n) {
                *matrix = DMatrix::zeros(rows, n);
            }
        }
        self.ranks.clear();
        self.ranks.reserve(rank);
        (rows + edges).max(self.curvature.fit(problem, rank))
    }

    pub(super) fn share(&self) -> TaskSubset {
        TaskSubset::above(self.ranks.len())
    }

    /// Returns the smallest relative decrease of the cost that justifies a step.
    pub(super) fn worthwhile(&self) -> f64 {
        match self.above {
            HigherLevels::Reached => WORTHWHILE,
            HigherLevels::FirstMissed | HigherLevels::Mixed => WORTHWHILE_BELOW_A_MISS,
        }
    }

    /// Constrains the levels above `rank` to their residual at x, and fixes the variables at bounds that an unreached
    /// level pushes against. Returns whether all levels are reached.
    pub(super) fn take(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        rank: usize,
        x: &[f64],
        residual: &[f64],
        fixed: &mut [bool],
    ) -> bool {
        let problem = descent.question.problem;
        self.kept.copy_from_slice(residual);
        self.ranks.clear();
        self.ranks.extend((0..rank).map(|rank| {
            let own = &residual[problem.ranks().rows_of(rank)];
            let binds = rank < problem.ranks().levels();
            LevelConstraint {
                rank,
                reached: binds && problem.is_reached_by(TaskSubset::rank(rank), own),
                cost: half_squared(own),
            }
        }));
        let missed = self.ranks.iter().filter(|rank| !rank.reached).count();
        self.above = match missed {
            0 => HigherLevels::Reached,
            1 if rank == 1 => HigherLevels::FirstMissed,
            _ => HigherLevels::Mixed,
        };
        self.inequalities.take(descent, &self.ranks, x);
        fixed.fill(false);
        match self.above {
            HigherLevels::Reached => {}
            HigherLevels::FirstMissed => self.fix_for_a_missed_first(descent, x, fixed),
            HigherLevels::Mixed => {
                self.take_jacobian(descent, x, false);
                let here = (&self.jacobian, &self.kept[..]);
                let (ranks, inequalities) = (&self.ranks, &mut self.inequalities);
                self.curvature
                    .fix(descent, (ranks, inequalities), x, here, fixed);
            }
        }
        self.above == HigherLevels::Reached
    }

    /// Sets the constrained residual of the first rows, and returns its previous values.
    pub(super) fn keep(&mut self, values: &[f64]) -> Vec<f64> {
        let own = &mut self.kept[..values.len()];
        let before = own.to_vec();
        own.copy_from_slice(values);
        before
    }

    fn fix_for_a_missed_first(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        x: &[f64],
        fixed: &mut [bool],
    ) {
        let share = self.share();
        let mut goals = Evaluation::of(share, descent.question, descent.scratch);
        let (slope, column_norm) = descent.memory.slope_at(&mut goals, x, &self.kept);
        let cost = half_squared(&self.kept);
        let negligible = negligible_slope(column_norm, cost, &descent.stopping);
        for (j, fixed) in fixed.iter_mut().enumerate() {
            *fixed = descent.question.space().holds(x, j, slope[j], negligible);
        }
    }

    /// Computes the constraint Jacobian C at x, with the active inequalities. Steps satisfy C Δ = 0.
    pub(super) fn take_rows(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        x: &[f64],
        fixed: &[bool],
        has_stepped: bool,
    ) {
        if self.above == HigherLevels::FirstMissed {
            return self.curvature.of_first(descent, x, &[]);
        }
        self.take_jacobian(descent, x, has_stepped);
        if self.above == HigherLevels::Mixed {
            let rows = self.kept.len();
            descent.residual(self.share(), x, &mut self.now[..rows]);
            let here = (&self.jacobian, &self.now[..rows]);
            let (ranks, inequalities) = (&self.ranks, &self.inequalities);
            self.curvature
                .of_all(descent, (ranks, inequalities), x, here, fixed);
        }
    }

    /// Computes the rows of reached levels and of the active inequalities.
    fn take_jacobian(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        x: &[f64],
        has_stepped: bool,
    ) {
        let share = self.share();
        if self.inequalities.len() == 0 {
            return descent.held_jacobian(share, x, &mut self.jacobian);
        }
        descent.held_jacobian(share, x, &mut self.of_residual);
        self.inequalities.stand(descent, self.ranks.len(), x);
        self.inequalities.work(has_stepped);
        self.inequalities
            .complete(&self.of_residual, &mut self.jacobian);
    }

    /// Removes an inequality that is pulled inward from C. Returns whether there was one.
    pub(super) fn let_go(&mut self, multipliers: &[f64]) -> bool {
        let Some(edge) = self.inequalities.let_go(multipliers) else {
            return false;
        };
        let row = self.kept.len() + edge;
        let whole = match self.above {
            HigherLevels::Mixed => self.curvature.rows_mut(),
            HigherLevels::Reached | HigherLevels::FirstMissed => &mut self.jacobian,
        };
        whole.row_mut(row).fill(0.0);
        true
    }

    /// Last computed constraint Jacobian C.
    pub(super) fn rows(&self) -> &DMatrix<f64> {
        match self.above {
            HigherLevels::Reached => &self.jacobian,
            HigherLevels::FirstMissed | HigherLevels::Mixed => self.curvature.rows(),
        }
    }

    /// Adds the rows of C, restricted to the variables that are not fixed, to a span.
    pub(super) fn span(&self, problem: &Problem, span: &mut RowSpan, fixed: &[bool]) {
        let (rows, n) = (self.jacobian.nrows(), fixed.len());
        for held in &self.ranks {
            let (own, share) = match (self.above, held.reached) {
                (HigherLevels::FirstMissed, _) => (0..n, NEW_CURVATURE),
                (_, true) => (problem.ranks().rows_of(held.rank), NEW),
                (_, false) => {
                    let first = rows + held.rank * n;
                    (first..first + n, NEW_CURVATURE)
                }
            };
            add_rows(span, self.rows(), own, fixed, share);
            for edge in self.inequalities.locked_of(held.rank) {
                let row = self.kept.len() + edge;
                add_rows(span, self.rows(), row..row + 1, fixed, NEW);
            }
        }
    }

    /// Adds the rows of the active set.
    pub(super) fn span_working(&self, span: &mut RowSpan, fixed: &[bool]) {
        for edge in self.inequalities.working() {
            let row = self.kept.len() + edge;
            add_rows(span, self.rows(), row..row + 1, fixed, NEW);
        }
    }

    /// Adds the span's part of a gradient to it, and writes the multipliers of inequalities and of rows of reached
    /// levels.
    pub(super) fn multiply(
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
            match row.checked_sub(self.kept.len()) {
                None if is_of_reached(problem, &self.ranks, row) => weights[row] = multiplier,
                Some(edge) if edge < self.inequalities.len() => edges[edge] = multiplier,
                _ => {}
            }
        }
    }
}
