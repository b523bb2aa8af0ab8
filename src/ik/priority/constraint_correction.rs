//! Correction of a trial point back to the constraints.

use super::descent_problem::DescentProblem;
use super::level_constraints::{Held, HigherLevels, SAME_MISS};
use crate::problem::{Evaluation, Problem, TaskSubset};
use crate::solver::{AnyMethod, HeldStep, LevenbergMarquardt, Silent, StepBounds, half_squared};

/// Maximum number of corrections of a trial.
const CORRECTIONS: usize = 6;
/// Maximum number of iterations that re-solve an unreached first level.
const SETTLING: usize = 20;

impl Held {
    /// Moves a trial back to the constraints. Returns whether it satisfies them.
    pub(super) fn bring_back(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        trial: &mut [f64],
        step: &mut HeldStep,
        fixed: &[bool],
    ) -> bool {
        match self.above {
            HigherLevels::Reached | HigherLevels::Mixed => {
                self.correct(descent, trial, step, fixed)
            }
            HigherLevels::FirstMissed => self.settle(descent, trial),
        }
    }

    /// Applies Newton's method to the changed residuals of reached levels and gradients of unreached ones.
    fn correct(
        &mut self,
        descent: &mut DescentProblem<'_, '_>,
        trial: &mut [f64],
        step: &mut HeldStep,
        fixed: &[bool],
    ) -> bool {
        let question = descent.question;
        let (share, rows, rank) = (self.share(), self.kept.len(), self.ranks.len());
        for round in 0..=CORRECTIONS {
            descent.residual(share, trial, &mut self.now[..rows]);
            let stands = self.stand(question.problem);
            if self.above == HigherLevels::Mixed && round < CORRECTIONS {
                self.curvature.slopes(descent, &self.ranks, trial, fixed);
            }
            for (now, kept) in self.now.iter_mut().zip(&self.kept) {
                *now -= kept;
            }
            let change = self.now.split_at_mut(rows);
            self.inequalities
                .change(descent, (rank, trial), round == 0, change);
            // At least one correction: second-order errors of a step can exceed its decrease.
            if round > 0 && stands && self.is_kept(question.problem) {
                return true;
            }
            if round == CORRECTIONS || !self.now.iter().all(|v| v.is_finite()) {
                break;
            }
            self.take_jacobian_there(descent, trial);
            let (held, miss) = match self.above {
                HigherLevels::Mixed => {
                    self.curvature
                        .system(descent, &self.ranks, &self.jacobian, &self.now)
                }
                _ => (&self.jacobian, &self.now[..]),
            };
            let within = StepBounds {
                x: trial,
                space: question.space(),
                fixed,
            };
            step.restore(held, miss, &within, &mut self.back);
            self.uncorrected.copy_from_slice(trial);
            let space = question.space();
            space.integrate(&self.uncorrected, &self.back, trial);
            space.project(trial);
        }
        false
    }

    /// Computes the constraint Jacobian at a trial.
    fn take_jacobian_there(&mut self, descent: &mut DescentProblem<'_, '_>, trial: &[f64]) {
        let share = self.share();
        if self.inequalities.len() == 0 {
            return descent.held_jacobian(share, trial, &mut self.jacobian);
        }
        descent.held_jacobian(share, trial, &mut self.of_residual);
        let at = (self.ranks.len(), trial);
        self.inequalities
            .complete_there(descent, at, &self.of_residual, &mut self.jacobian);
    }

    /// Returns whether every level is as good as before by the current residual: reached, or unreached at no higher
    /// cost.
    fn stand(&self, problem: &Problem) -> bool {
        self.ranks.iter().all(|held| {
            let own = &self.now[problem.ranks().rows_of(held.rank)];
            match held.reached {
                true => problem.is_reached_by(TaskSubset::rank(held.rank), own),
                false => half_squared(own) <= held.cost * (1.0 + SAME_MISS),
            }
        })
    }

    /// Returns whether reached levels have kept their residual within tolerance.
    fn is_kept(&self, problem: &Problem) -> bool {
        let mut reached = self.ranks.iter().filter(|held| held.reached);
        let edges = &self.now[self.kept.len()..];
        self.inequalities.are_kept(edges)
            && reached.all(|held| {
                let own = &self.now[problem.ranks().rows_of(held.rank)];
                problem.is_kept(TaskSubset::rank(held.rank), own)
            })
    }

    /// Re-solves an unreached first level from the trial. Returns whether its cost is as low as before.
    fn settle(&mut self, descent: &mut DescentProblem<'_, '_>, trial: &mut [f64]) -> bool {
        let stopping = descent.stopping.with_max_iterations(SETTLING);
        let share = self.share();
        let memory = &mut *descent.memory;
        LevenbergMarquardt::default().minimise(
            &mut Evaluation::of(share, descent.question, descent.scratch),
            trial,
            &stopping,
            descent.deadline,
            &mut Silent,
            memory,
        );
        descent.counts += memory.counts();
        trial.copy_from_slice(memory.x());
        memory.cost() <= half_squared(&self.kept) * (1.0 + SAME_MISS)
    }
}
