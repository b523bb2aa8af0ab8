//! Residuals of one sample of a trajectory: tasks with their targets and weights, and the model's loops.
//!
//! Loops are closed by the method of multipliers. Their penalty starts soft, so that steps can leave the curved set of
//! closed configurations. The multipliers move until nothing is open, and the penalty increases if that is slow
//! (Nocedal & Wright 2006, "Numerical optimization", 17.3).

use nalgebra::DMatrix;

use super::MotionProblem;
use crate::problem::{Evaluation, ProblemInstance, Scratch, Targets};
use crate::solver::{ConfigurationSpace, LeastSquares};

/// Evaluator of r and J of samples of a trajectory.
pub(super) struct FrameResiduals<'a> {
    motion: &'a MotionProblem,
    scratch: Scratch,
    targets: Targets,
    /// Sample of the current targets.
    current_frame: Option<usize>,
    /// True for derivatives by steps that respect the limits of ball joints, false for derivatives by the variables.
    respects_limits: bool,
    /// Index of the first loop row.
    task_rows: usize,
    /// Scaled multiplier (offset) of each loop row, sample by sample.
    offsets: Vec<f64>,
    /// Weight of a closure error, per metre or radian.
    stiffness: f64,
    /// Largest closure error at the last multiplier update.
    closure_error: f64,
}

/// Initial penalty of loops, relative to its maximum.
const INITIAL_PENALTY_RATIO: f64 = 0.01;
/// Ratio of closure errors above which the penalty increases, and the factor of the increase.
const MAX_ERROR_RATIO: f64 = 0.25;
const PENALTY_FACTOR: f64 = 10.0;

impl<'a> FrameResiduals<'a> {
    pub(super) fn new(motion: &'a MotionProblem) -> Self {
        Self {
            scratch: motion.problem.scratch(),
            targets: motion.problem.targets(),
            current_frame: None,
            respects_limits: true,
            task_rows: motion.task_rows(),
            offsets: vec![0.0; motion.frames * (motion.problem.rows() - motion.task_rows())],
            stiffness: INITIAL_PENALTY_RATIO * motion.stiffness,
            closure_error: f64::INFINITY,
            motion,
        }
    }

    /// Number of task rows. Loop rows follow them.
    #[must_use]
    pub(super) fn task_rows(&self) -> usize {
        self.task_rows
    }

    /// Selects derivatives by the variables everywhere.
    #[must_use]
    pub(super) fn by_variables(mut self) -> Self {
        self.respects_limits = false;
        self
    }

    fn evaluation(&mut self, frame: usize) -> Evaluation<'_> {
        if self.current_frame != Some(frame) {
            self.motion.set_targets(frame, &mut self.targets);
            self.current_frame = Some(frame);
        }
        let instance = ProblemInstance::from(&self.motion.problem).with_targets(&self.targets);
        let instance = match self.respects_limits {
            true => instance,
            false => instance.by_variables(),
        };
        Evaluation::new(instance, &mut self.scratch)
    }

    /// Writes each task's rows, without the sample's weights.
    pub(super) fn unweighted(&mut self, frame: usize, x: &[f64], residual: &mut [f64]) {
        self.evaluation(frame).residual(x, residual);
    }

    /// Writes r of a sample.
    pub(super) fn residual(&mut self, frame: usize, x: &[f64], residual: &mut [f64]) {
        self.unweighted(frame, x, residual);
        let loops = &mut residual[self.task_rows..];
        let offsets = &self.offsets[frame * loops.len()..];
        for (row, offset) in loops.iter_mut().zip(offsets) {
            *row += offset;
        }
        self.apply_weights(frame, residual);
    }

    /// Writes ∂r/∂x of a sample, by its variables.
    pub(super) fn jacobian(&mut self, frame: usize, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.evaluation(frame).jacobian(x, jacobian);
        let rows = jacobian.nrows();
        if self.motion.has_weights(frame) || self.task_rows < rows {
            for column in jacobian.as_mut_slice().chunks_exact_mut(rows) {
                self.apply_weights(frame, column);
            }
        }
    }

    /// Writes Jᵀr of a sample by its variables. `residual` is r, and is modified.
    pub(super) fn gradient(
        &mut self,
        frame: usize,
        x: &[f64],
        residual: &mut [f64],
        gradient: &mut [f64],
        jacobian: &mut DMatrix<f64>,
    ) {
        self.apply_weights(frame, residual);
        self.evaluation(frame)
            .gradient(x, residual, gradient, jacobian);
    }

    /// Resets the last closure error for other samples.
    pub(super) fn reset(&mut self) {
        self.closure_error = f64::INFINITY;
    }

    /// Increases the penalty of loops if the closure error has not decreased fast enough. The forces stay unchanged.
    pub(super) fn increase_penalty(&mut self, closure_error: f64) {
        if closure_error > MAX_ERROR_RATIO * self.closure_error {
            let increased = (PENALTY_FACTOR * self.stiffness).min(self.motion.stiffness);
            let ratio = self.stiffness / increased;
            self.offsets
                .iter_mut()
                .for_each(|offset| *offset *= ratio * ratio);
            self.stiffness = increased;
        }
        self.closure_error = closure_error;
    }

    /// Updates the multipliers of a sample's loops. Returns the largest closure error, metres or radians.
    pub(super) fn update_multipliers(
        &mut self,
        frame: usize,
        x: &[f64],
        residual: &mut [f64],
    ) -> f64 {
        self.unweighted(frame, x, residual);
        let loops = &residual[self.task_rows..];
        let offsets = &mut self.offsets[frame * loops.len()..];
        for (offset, row) in offsets.iter_mut().zip(loops) {
            *offset += row;
        }
        self.motion.max_closure_error(residual)
    }

    /// Multiplies the rows of each task by its weight at a sample.
    fn apply_weights(&self, frame: usize, rows: &mut [f64]) {
        for (index, task) in self.motion.problem.compiled_tasks().iter().enumerate() {
            let weight = match task.is_loop {
                true => self.stiffness,
                false => self.motion.weight(index, frame),
            };
            if weight != 1.0 {
                let rows = &mut rows[task.rows.clone()];
                rows.iter_mut().for_each(|row| *row *= weight);
            }
        }
    }
}

/// Least-squares problem of a single sample with its own bounds.
pub(super) struct SingleFrame<'r, 'a> {
    pub(super) residuals: &'r mut FrameResiduals<'a>,
    pub(super) frame: usize,
    pub(super) lower: &'r [f64],
    pub(super) upper: &'r [f64],
}

impl LeastSquares for SingleFrame<'_, '_> {
    fn variables(&self) -> usize {
        self.residuals.motion.variables()
    }

    fn rows(&self) -> usize {
        self.residuals.motion.problem.rows()
    }

    fn lower(&self) -> &[f64] {
        self.lower
    }

    fn upper(&self) -> &[f64] {
        self.upper
    }

    fn step_scale(&self) -> &[f64] {
        self.residuals.motion.problem.step_scale()
    }

    fn space(&self) -> ConfigurationSpace<'_> {
        let instance = ProblemInstance::from(&self.residuals.motion.problem);
        instance.within(self.lower, self.upper, &[]).space()
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        self.residuals.residual(self.frame, x, residual);
    }

    fn jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.residuals.jacobian(self.frame, x, jacobian);
    }
}
