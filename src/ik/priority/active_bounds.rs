//! Bounds and inequalities on which unreached levels rest, kept by all levels below.

use nalgebra::DMatrix;

use super::curvature::{Curvature, NEW, add_rows};
use super::descent_problem::DescentProblem;
use super::inequalities::LevelInequalities;
use super::level_constraints::LevelConstraint;
use crate::solver::{dot, half_squared, negligible_slope};

impl Curvature {
    /// Fixes the variables at bounds, and locks the inequalities, that an unreached level pushes against.
    pub(super) fn fix(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        (ranks, inequalities): (&[LevelConstraint], &mut LevelInequalities),
        x: &[f64],
        (jacobian, residual): (&DMatrix<f64>, &[f64]),
        fixed: &mut [bool],
    ) {
        let space = descent.question.space();
        // Multipliers are computed from variables between their bounds.
        let bound: Vec<bool> = (0..x.len())
            .map(|j| !space.is_between_bounds(x, j))
            .collect();
        for held in ranks.iter().filter(|held| !held.reached) {
            let own = descent.question.problem.ranks().rows_of(held.rank);
            self.take_pushes(
                descent,
                (ranks, inequalities),
                held,
                (jacobian, residual),
                &bound,
            );
            let multipliers = &self.multipliers[held.rank * self.first..][..self.first];
            let columns = jacobian.as_slice().chunks_exact(self.first.max(1));
            let mut steepest = 0.0_f64;
            for (slope, column) in self.slope.iter_mut().zip(columns) {
                *slope = dot(column, multipliers);
                let own = &column[own.clone()];
                steepest = steepest.max(dot(own, own).sqrt());
            }
            let cost = half_squared(&residual[own]);
            let negligible = negligible_slope(steepest, cost, &descent.stopping);
            for (j, fixed) in fixed.iter_mut().enumerate() {
                *fixed |= space.holds(x, j, self.slope[j], negligible);
            }
            let pushes = &multipliers[self.residual..];
            for edge in (0..pushes.len()).filter(|&edge| pushes[edge] < 0.0) {
                let row = jacobian.row(self.residual + edge).norm();
                if -pushes[edge] * row > negligible {
                    inequalities.lock(edge);
                }
            }
        }
    }

    /// Computes λ of an unreached level, with the active inequalities of levels above that it pushes against.
    fn take_pushes(
        &mut self,
        descent: &DescentProblem<'_, '_>,
        (ranks, inequalities): (&[LevelConstraint], &LevelInequalities),
        missed: &LevelConstraint,
        (jacobian, residual): (&DMatrix<f64>, &[f64]),
        bound: &[bool],
    ) {
        let mut above = std::mem::take(&mut self.running);
        let mut let_go = Vec::new();
        loop {
            above.clear();
            let higher = ranks
                .iter()
                .filter(|held| held.rank < missed.rank && held.reached);
            for held in higher {
                let own = descent.question.problem.ranks().rows_of(held.rank);
                add_rows(&mut above, jacobian, own, bound, NEW);
                let edges = inequalities.holding_of(held.rank);
                for edge in edges.filter(|edge| !let_go.contains(edge)) {
                    let row = self.residual + edge;
                    add_rows(&mut above, jacobian, row..row + 1, bound, NEW);
                }
            }
            self.take_multipliers(descent, ranks, missed, &mut above, (jacobian, residual));
            let pushes = &self.multipliers[missed.rank * self.first..][self.residual..self.first];
            let hardest = (0..pushes.len()).max_by(|&a, &b| pushes[a].total_cmp(&pushes[b]));
            match hardest.filter(|&edge| pushes[edge] > 0.0) {
                Some(edge) => let_go.push(edge),
                None => break,
            }
        }
        self.running = above;
    }
}
