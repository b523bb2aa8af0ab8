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
    at: Option<usize>,
    /// True for derivatives by steps that respect the limits of ball joints, false for derivatives by the variables.
    edges: bool,
    /// Index of the first loop row.
    rows_of_tasks: usize,
    /// Scaled multiplier (offset) of each loop row, sample by sample.
    rests: Vec<f64>,
    /// Weight of a closure error, per metre or radian.
    stiffness: f64,
    /// Largest closure error at the last multiplier update.
    open: f64,
}

/// Initial penalty of loops, relative to its maximum.
const SOFT: f64 = 0.01;
/// Ratio of closure errors above which the penalty increases, and the factor of the increase.
const FAST: f64 = 0.25;
const STIFFEN: f64 = 10.0;

impl<'a> FrameResiduals<'a> {
    pub(super) fn new(motion: &'a MotionProblem) -> Self {
        Self {
            scratch: motion.problem.scratch(),
            targets: motion.problem.targets(),
            at: None,
            edges: true,
            rows_of_tasks: motion.rows_of_tasks(),
            rests: vec![0.0; motion.frames * (motion.problem.rows() - motion.rows_of_tasks())],
            stiffness: SOFT * motion.stiffness,
            open: f64::INFINITY,
            motion,
        }
    }

    getters! {
        /// Number of task rows. Loop rows follow them.
        pub(super) fn rows_of_tasks(&self) -> usize = self.rows_of_tasks;
    }

    setters! {
        /// Selects derivatives by the variables everywhere.
        pub(super) fn by_variables(mut self) { self.edges = false }
    }

    fn evaluation(&mut self, frame: usize) -> Evaluation<'_> {
        if self.at != Some(frame) {
            self.motion.move_targets(frame, &mut self.targets);
            self.at = Some(frame);
        }
        let question = ProblemInstance::from(&self.motion.problem).with_targets(&self.targets);
        let question = match self.edges {
            true => question,
            false => question.by_variables(),
        };
        Evaluation::new(question, &mut self.scratch)
    }

    /// Writes each task's rows, without the sample's weights.
    pub(super) fn unweighed(&mut self, frame: usize, x: &[f64], residual: &mut [f64]) {
        self.evaluation(frame).residual(x, residual);
    }

    /// Writes r of a sample.
    pub(super) fn residual(&mut self, frame: usize, x: &[f64], residual: &mut [f64]) {
        self.unweighed(frame, x, residual);
        let loops = &mut residual[self.rows_of_tasks..];
        let rests = &self.rests[frame * loops.len()..];
        for (row, rest) in loops.iter_mut().zip(rests) {
            *row += rest;
        }
        self.weigh(frame, residual);
    }

    /// Writes ∂r/∂x of a sample, by its variables.
    pub(super) fn jacobian(&mut self, frame: usize, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.evaluation(frame).jacobian(x, jacobian);
        let rows = jacobian.nrows();
        if self.motion.weighs(frame) || self.rows_of_tasks < rows {
            for column in jacobian.as_mut_slice().chunks_exact_mut(rows) {
                self.weigh(frame, column);
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
        self.weigh(frame, residual);
        self.evaluation(frame)
            .gradient(x, residual, gradient, jacobian);
    }

    /// Resets the last closure error for other samples.
    pub(super) fn begin(&mut self) {
        self.open = f64::INFINITY;
    }

    /// Increases the penalty of loops if the closure error has not decreased fast enough. The forces stay unchanged.
    pub(super) fn stiffen(&mut self, open: f64) {
        if open > FAST * self.open {
            let stiffer = (STIFFEN * self.stiffness).min(self.motion.stiffness);
            let softer = self.stiffness / stiffer;
            self.rests
                .iter_mut()
                .for_each(|rest| *rest *= softer * softer);
            self.stiffness = stiffer;
        }
        self.open = open;
    }

    /// Updates the multipliers of a sample's loops. Returns the largest closure error, metres or radians.
    pub(super) fn tighten(&mut self, frame: usize, x: &[f64], residual: &mut [f64]) -> f64 {
        self.unweighed(frame, x, residual);
        let loops = &residual[self.rows_of_tasks..];
        let rests = &mut self.rests[frame * loops.len()..];
        for (rest, row) in rests.iter_mut().zip(loops) {
            *rest += row;
        }
        self.motion.open_by(residual)
    }

    /// Multiplies the rows of each task by its weight at a sample.
    fn weigh(&self, frame: usize, rows: &mut [f64]) {
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
pub(super) struct FrameAlone<'r, 'a> {
    pub(super) residuals: &'r mut FrameResiduals<'a>,
    pub(super) frame: usize,
    pub(super) lower: &'r [f64],
    pub(super) upper: &'r [f64],
}

impl LeastSquares for FrameAlone<'_, '_> {
    answers! {
        fn variables(&self) -> usize = self.residuals.motion.variables();
        fn rows(&self) -> usize = self.residuals.motion.problem.rows();
        fn lower(&self) -> &[f64] = self.lower;
        fn upper(&self) -> &[f64] = self.upper;
    }

    fn space(&self) -> ConfigurationSpace<'_> {
        let question = ProblemInstance::from(&self.residuals.motion.problem);
        question.within(self.lower, self.upper, &[]).space()
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        self.residuals.residual(self.frame, x, residual);
    }

    fn jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.residuals.jacobian(self.frame, x, jacobian);
    }
}
