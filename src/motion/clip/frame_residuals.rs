//! The tasks of one frame of a motion, with its targets and its weights, and the model's loops.
//!
//! Loops close by the method of multipliers: springs that start soft, so that steps may leave the curved valley of closed
//! configurations, whose rests are moved until nothing is open, and that stiffen where this is slow (Nocedal & Wright
//! 2006, "Numerical optimization", 17.3).

use nalgebra::DMatrix;

use super::MotionProblem;
use crate::problem::{Evaluation, Question, Scratch, Targets};
use crate::solver::{ConfigurationSpace, LeastSquares};

/// r and J of frames of a motion, with the memory to evaluate them.
pub(super) struct FrameResiduals<'a> {
    motion: &'a MotionProblem,
    scratch: Scratch,
    targets: Targets,
    /// The frame whose targets those are.
    at: Option<usize>,
    /// Whether derivatives at the edges of balls are by steps that tell those apart, or by the variables.
    edges: bool,
    /// Where the rows that close loops begin …
    rows_of_tasks: usize,
    /// … and, by frame and such row, how far its rest is off zero.
    rests: Vec<f64>,
    /// What a metre or radian that a loop is open costs, as a weight.
    stiffness: f64,
    /// How far loops were open when rests were last moved.
    open: f64,
}

/// How stiff a loop's springs are at first, as a share of what they become at most.
const SOFT: f64 = 0.01;
/// What is open falls to this share when rests are moved, or springs become so much stiffer.
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
        /// How many rows are of tasks; those of loops come after them.
        pub(super) fn rows_of_tasks(&self) -> usize = self.rows_of_tasks;
    }

    setters! {
        /// Derivatives by the variables everywhere.
        pub(super) fn by_variables(mut self) { self.edges = false }
    }

    fn evaluation(&mut self, frame: usize) -> Evaluation<'_> {
        if self.at != Some(frame) {
            self.motion.move_targets(frame, &mut self.targets);
            self.at = Some(frame);
        }
        let question = Question::from(&self.motion.problem).with_targets(&self.targets);
        let question = match self.edges {
            true => question,
            false => question.by_variables(),
        };
        Evaluation::new(question, &mut self.scratch)
    }

    /// Each task's rows, all but its weight in the frame.
    pub(super) fn unweighed(&mut self, frame: usize, x: &[f64], residual: &mut [f64]) {
        self.evaluation(frame).residual(x, residual);
    }

    /// r of a frame.
    pub(super) fn residual(&mut self, frame: usize, x: &[f64], residual: &mut [f64]) {
        self.unweighed(frame, x, residual);
        let loops = &mut residual[self.rows_of_tasks..];
        let rests = &self.rests[frame * loops.len()..];
        for (row, rest) in loops.iter_mut().zip(rests) {
            *row += rest;
        }
        self.weigh(frame, residual);
    }

    /// ∂r/∂x of a frame, by its variables.
    pub(super) fn jacobian(&mut self, frame: usize, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.evaluation(frame).jacobian(x, jacobian);
        let rows = jacobian.nrows();
        if self.motion.weighs(frame) || self.rows_of_tasks < rows {
            for column in jacobian.as_mut_slice().chunks_exact_mut(rows) {
                self.weigh(frame, column);
            }
        }
    }

    /// Writes Jᵀr of a frame by its variables, for its r, which is changed.
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

    /// Lets go of how far loops were open: for other frames.
    pub(super) fn begin(&mut self) {
        self.open = f64::INFINITY;
    }

    /// Stiffens the springs of loops, which keep their pull, where these have not closed fast enough since the last time.
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

    /// Moves the rests of a frame's loops by how far they are open; how far that is at most, in metres and radians.
    pub(super) fn tighten(&mut self, frame: usize, x: &[f64], residual: &mut [f64]) -> f64 {
        self.unweighed(frame, x, residual);
        let loops = &residual[self.rows_of_tasks..];
        let rests = &mut self.rests[frame * loops.len()..];
        for (rest, row) in rests.iter_mut().zip(loops) {
            *rest += row;
        }
        self.motion.open_by(residual)
    }

    /// Multiplies the rows of each task by its weight in a frame.
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

/// One frame by itself, within bounds of its own.
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
        fn step_scale(&self) -> &[f64] = self.residuals.motion.problem.step_scale();
    }

    fn space(&self) -> ConfigurationSpace<'_> {
        let question = Question::from(&self.residuals.motion.problem);
        question.within(self.lower, self.upper, &[]).space()
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        self.residuals.residual(self.frame, x, residual);
    }

    fn jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.residuals.jacobian(self.frame, x, jacobian);
    }
}
