//! Correction of a trial point back to the constraints.

use super::descent_problem::DescentProblem;
use super::level_constraints::{COST_TOLERANCE, HigherLevels, LevelConstraints};
use crate::problem::{Evaluation, Problem, TaskSubset};
use crate::solver::{AnyMethod, HeldStep, LevenbergMarquardt, Silent, StepBounds, half_squared};

/// Maximum number of corrections of a trial.
const MAX_CORRECTIONS: usize = 6;
/// Maximum number of iterations that re-solve an unreached first level.
const MAX_RESOLVE_ITERATIONS: usize = 20;

impl LevelConstraints {
    /// Moves a trial back to the constraints. Returns whether it satisfies them.
    pub(super) fn correct_trial(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        trial: &mut [f64],
        step: &mut HeldStep,
        fixed: &[bool],
    ) -> bool {
        match self.higher_levels {
            HigherLevels::Reached | HigherLevels::Mixed => {
                self.correct_by_newton(descent, trial, step, fixed)
            }
            HigherLevels::FirstUnreached => self.resolve_first_level(descent, trial),
        }
    }

    /// Applies Newton's method to the changed residuals of reached levels and gradients of unreached ones.
    fn correct_by_newton(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        trial: &mut [f64],
        step: &mut HeldStep,
        fixed: &[bool],
    ) -> bool {
        let instance = descent.instance;
        let (subset, rows, rank) = (self.subset(), self.held_residual.len(), self.ranks.len());
        for round in 0..=MAX_CORRECTIONS {
            descent.residual(subset, trial, &mut self.residual_change[..rows]);
            let is_as_good = self.are_levels_as_good(instance.problem);
            if self.higher_levels == HigherLevels::Mixed && round < MAX_CORRECTIONS {
                self.curvature
                    .compute_slopes(descent, &self.ranks, trial, fixed);
            }
            for (value, held_value) in self.residual_change.iter_mut().zip(&self.held_residual) {
                *value -= held_value;
            }
            let change_parts = self.residual_change.split_at_mut(rows);
            self.inequalities
                .write_violations(descent, (rank, trial), round == 0, change_parts);
            // At least one correction: second-order errors of a step can exceed its decrease.
            if round > 0 && is_as_good && self.is_within_tolerance(instance.problem) {
                return true;
            }
            if round == MAX_CORRECTIONS || !self.residual_change.iter().all(|v| v.is_finite()) {
                break;
            }
            self.compute_trial_jacobian(descent, trial);
            let (constraint_rows, changes) = match self.higher_levels {
                HigherLevels::Mixed => self.curvature.system(
                    descent,
                    &self.ranks,
                    &self.jacobian,
                    &self.residual_change,
                ),
                _ => (&self.jacobian, &self.residual_change[..]),
            };
            let bounds = StepBounds {
                x: trial,
                space: instance.space(),
                fixed,
            };
            step.restore(constraint_rows, changes, &bounds, &mut self.correction);
            self.uncorrected.copy_from_slice(trial);
            let space = instance.space();
            space.integrate(&self.uncorrected, &self.correction, trial);
            space.project(trial);
        }
        false
    }

    /// Computes the constraint Jacobian at a trial.
    fn compute_trial_jacobian(&mut self, descent: &mut DescentProblem<'_, '_>, trial: &[f64]) {
        let subset = self.subset();
        if self.inequalities.len() == 0 {
            return descent.constraint_jacobian(subset, trial, &mut self.jacobian);
        }
        descent.constraint_jacobian(subset, trial, &mut self.residual_jacobian);
        let rank_and_trial = (self.ranks.len(), trial);
        self.inequalities.write_trial_jacobian(
            descent,
            rank_and_trial,
            &self.residual_jacobian,
            &mut self.jacobian,
        );
    }

    /// Returns whether every level is as good as before by the current residual: reached, or unreached at no higher
    /// cost.
    fn are_levels_as_good(&self, problem: &Problem) -> bool {
        self.ranks.iter().all(|level| {
            let residual = &self.residual_change[problem.ranks().rows_of(level.rank)];
            match level.reached {
                true => problem.is_reached_by(TaskSubset::rank(level.rank), residual),
                false => half_squared(residual) <= level.cost * (1.0 + COST_TOLERANCE),
            }
        })
    }

    /// Returns whether reached levels have kept their residual within tolerance.
    fn is_within_tolerance(&self, problem: &Problem) -> bool {
        let mut reached = self.ranks.iter().filter(|level| level.reached);
        let edges = &self.residual_change[self.held_residual.len()..];
        self.inequalities.are_within_tolerance(edges)
            && reached.all(|level| {
                let residual = &self.residual_change[problem.ranks().rows_of(level.rank)];
                problem.is_kept(TaskSubset::rank(level.rank), residual)
            })
    }

    /// Re-solves an unreached first level from the trial. Returns whether its cost is as low as before.
    fn resolve_first_level(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        trial: &mut [f64],
    ) -> bool {
        let stopping = descent.stopping.with_max_iterations(MAX_RESOLVE_ITERATIONS);
        let subset = self.subset();
        let state = &mut *descent.state;
        LevenbergMarquardt::default().minimise(
            &mut Evaluation::of(subset, descent.instance, descent.scratch),
            trial,
            &stopping,
            descent.deadline,
            &mut Silent,
            state,
        );
        descent.counts += state.counts();
        trial.copy_from_slice(state.x());
        state.cost() <= half_squared(&self.held_residual) * (1.0 + COST_TOLERANCE)
    }
}
