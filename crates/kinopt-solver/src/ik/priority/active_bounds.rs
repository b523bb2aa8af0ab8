//! Bounds and inequalities on which unreached levels rest, kept by all levels below.

use nalgebra::DMatrix;

use super::curvature::{LevelCurvature, MIN_INDEPENDENT_PART, add_rows};
use super::descent_problem::DescentProblem;
use super::inequalities::LevelInequalities;
use super::level_constraints::LevelConstraint;
use crate::solver::{dot, half_squared, negligible_slope};

impl LevelCurvature {
    /// Fixes the variables at bounds, and locks the inequalities, that an unreached level pushes against.
    pub(super) fn fix_active_bounds(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (ranks, inequalities): (&[LevelConstraint], &mut LevelInequalities),
        x: &[f64],
        (jacobian, residual): (&DMatrix<f64>, &[f64]),
        fixed: &mut [bool],
    ) {
        let space = descent.instance.space();
        // Multipliers are computed from variables between their bounds.
        let is_at_bound: Vec<bool> = (0..x.len())
            .map(|j| !space.is_between_bounds(x, j))
            .collect();
        for level in ranks.iter().filter(|level| !level.reached) {
            let row_range = descent.instance.problem.ranks().rows_of(level.rank);
            self.compute_pushing_multipliers(
                descent,
                (ranks, inequalities),
                level,
                (jacobian, residual),
                &is_at_bound,
            );
            let multipliers =
                &self.multipliers[level.rank * self.constraint_rows..][..self.constraint_rows];
            let columns = jacobian
                .as_slice()
                .chunks_exact(self.constraint_rows.max(1));
            let mut max_column_norm = 0.0_f64;
            for (slope, column) in self.slope.iter_mut().zip(columns) {
                *slope = dot(column, multipliers);
                let entries = &column[row_range.clone()];
                max_column_norm = max_column_norm.max(dot(entries, entries).sqrt());
            }
            let cost = half_squared(&residual[row_range]);
            let negligible = negligible_slope(max_column_norm, cost, &descent.stopping);
            for (j, fixed) in fixed.iter_mut().enumerate() {
                *fixed |= space.holds(x, j, self.slope[j], negligible);
            }
            let push_multipliers = &multipliers[self.residual_rows..];
            for edge in (0..push_multipliers.len()).filter(|&edge| push_multipliers[edge] < 0.0) {
                let row = jacobian.row(self.residual_rows + edge).norm();
                if -push_multipliers[edge] * row > negligible {
                    inequalities.lock(edge);
                }
            }
        }
    }

    /// Computes λ of an unreached level, with the active inequalities of levels above that it pushes against.
    fn compute_pushing_multipliers(
        &mut self,
        descent: &DescentProblem<'_, '_>,
        (ranks, inequalities): (&[LevelConstraint], &LevelInequalities),
        unreached: &LevelConstraint,
        (jacobian, residual): (&DMatrix<f64>, &[f64]),
        is_at_bound: &[bool],
    ) {
        let mut span = std::mem::take(&mut self.span);
        let mut dropped = Vec::new();
        loop {
            span.clear();
            let higher = ranks
                .iter()
                .filter(|level| level.rank < unreached.rank && level.reached);
            for level in higher {
                let row_range = descent.instance.problem.ranks().rows_of(level.rank);
                add_rows(
                    &mut span,
                    jacobian,
                    row_range,
                    is_at_bound,
                    MIN_INDEPENDENT_PART,
                );
                let edges = inequalities.equations_of(level.rank);
                for edge in edges.filter(|edge| !dropped.contains(edge)) {
                    let row = self.residual_rows + edge;
                    add_rows(
                        &mut span,
                        jacobian,
                        row..row + 1,
                        is_at_bound,
                        MIN_INDEPENDENT_PART,
                    );
                }
            }
            self.compute_multipliers(descent, ranks, unreached, &mut span, (jacobian, residual));
            let push_multipliers = &self.multipliers[unreached.rank * self.constraint_rows..]
                [self.residual_rows..self.constraint_rows];
            let most_inward = (0..push_multipliers.len())
                .max_by(|&a, &b| push_multipliers[a].total_cmp(&push_multipliers[b]));
            match most_inward.filter(|&edge| push_multipliers[edge] > 0.0) {
                Some(edge) => dropped.push(edge),
                None => break,
            }
        }
        self.span = span;
    }
}
