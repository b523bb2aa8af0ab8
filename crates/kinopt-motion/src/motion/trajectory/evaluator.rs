//! Cost, gradient and Hessian of consecutive samples.

use nalgebra::DMatrix;

use super::block_banded::BlockBanded;
use super::contact_springs::ContactSprings;
use super::frame_residuals::FrameResiduals;
use super::stretch::SampleSpan;
use super::{MotionCounts, MotionError, MotionProblem};
use kinopt_solver::solver::{InnerProducts, dot, half_squared};

/// Step of finite differences, relative to a variable's unit.
const DIFFERENCE_STEP: f64 = 1e-6;

/// Evaluator of samples of one trajectory, with its memory.
pub(super) struct SampleEvaluator<'a> {
    motion: &'a MotionProblem,
    residuals: FrameResiduals<'a>,
    residual: Vec<f64>,
    jacobian: DMatrix<f64>,
    products: InnerProducts,
    gram: Vec<f64>,
    all_variables: Vec<usize>,
    differences: Vec<f64>,
    /// True for the full Hessian of each sample, false for JᵀJ.
    pub(super) curved: bool,
    pub(super) contact_springs: ContactSprings<'a>,
    pub(super) counts: MotionCounts,
}

impl<'a> SampleEvaluator<'a> {
    pub(super) fn new(motion: &'a MotionProblem) -> Self {
        let problem = &motion.problem;
        let (n, rows) = (problem.variables(), problem.rows());
        let mut products = InnerProducts::default();
        products.reserve(n);
        Self {
            residuals: FrameResiduals::new(motion).by_variables(),
            residual: vec![0.0; rows],
            jacobian: DMatrix::zeros(rows, n),
            products,
            gram: vec![0.0; n * n],
            all_variables: (0..n).collect(),
            differences: Vec::new(),
            curved: false,
            contact_springs: ContactSprings::new(motion),
            counts: MotionCounts::default(),
            motion,
        }
    }

    /// Returns each task's rows at a sample, without the sample's weights.
    pub(super) fn unweighted(&mut self, frame: usize, x: &[f64]) -> &[f64] {
        self.residuals.unweighted(frame, x, &mut self.residual);
        &self.residual
    }

    /// Writes Jᵀr of a sample's tasks, by a step.
    fn frame_gradient(&mut self, frame: usize, x: &[f64], gradient: &mut [f64]) {
        self.counts.gradients += 1;
        self.residuals.residual(frame, x, &mut self.residual);
        let (residual, jacobian) = (&mut self.residual, &mut self.jacobian);
        self.residuals
            .gradient(frame, x, residual, gradient, jacobian);
        self.motion.space.by_steps(x, 1, gradient);
    }

    /// Computes the symmetric Hessian of ½‖r‖² of a sample's tasks by a step, from differences of its exact gradient.
    fn frame_hessian(&mut self, frame: usize, x: &[f64], gradient: &[f64]) {
        let n = x.len();
        let mut offset = vec![0.0; n];
        let mut moved = vec![0.0; n];
        let mut slopes = vec![0.0; n];
        self.gram.fill(0.0);
        for k in 0..n {
            offset[k] = DIFFERENCE_STEP * self.motion.unit(k);
            self.motion.space.integrate(x, 1.0, &offset, &mut moved);
            self.frame_gradient(frame, &moved, &mut slopes);
            for (row, (slope, before)) in slopes.iter().zip(gradient).enumerate() {
                let half = 0.5 * (slope - before) / offset[k];
                self.gram[row * n + k] += half;
                self.gram[k * n + row] += half;
            }
            offset[k] = 0.0;
        }
    }

    /// Returns ½‖r‖² of a sample's tasks, and of its loops.
    pub(super) fn frame_cost(&mut self, frame: usize, x: &[f64]) -> [f64; 2] {
        self.counts.residuals += 1;
        self.residuals.residual(frame, x, &mut self.residual);
        let (tasks, loops) = self.residual.split_at(self.residuals.task_rows());
        [half_squared(tasks), half_squared(loops)]
    }

    /// Updates the multipliers of loops at samples that are not fixed. Returns the largest closure error.
    pub(super) fn update_loop_multipliers(
        &mut self,
        stretch: SampleSpan,
        x: &[f64],
        fixed: &[bool],
    ) -> f64 {
        let n = self.motion.variables();
        let frames = x.chunks_exact(n).zip(fixed).enumerate();
        let mut max_error = 0.0_f64;
        for (local, (x, _)) in frames.filter(|(_, (_, fixed))| !**fixed) {
            let error =
                self.residuals
                    .update_multipliers(stretch.first + local, x, &mut self.residual);
            max_error = max_error.max(error);
        }
        self.residuals.increase_penalty(max_error);
        max_error
    }

    /// Resets the multipliers for other samples.
    pub(super) fn reset(&mut self, frames: usize) {
        self.contact_springs.reset(frames);
        self.residuals.reset();
    }

    /// Returns the cost of tasks and rates, and the penalty of contacts and loops.
    pub(super) fn cost(&mut self, stretch: SampleSpan, x: &[f64]) -> [f64; 2] {
        let n = self.motion.variables();
        let (mut tasks, mut loops) = (0.0, 0.0);
        for (frame, x) in x.chunks_exact(n).enumerate().skip(stretch.fixed_count) {
            let [task_cost, loop_cost] = self.frame_cost(stretch.first + frame, x);
            tasks += task_cost;
            loops += loop_cost;
        }
        [
            tasks + self.rates(stretch, x),
            self.contact_springs.cost(stretch, x) + loops,
        ]
    }

    /// Returns the cost of rates, and stores the differences between samples.
    pub(super) fn rates(&mut self, stretch: SampleSpan, x: &[f64]) -> f64 {
        let n = self.motion.variables();
        let frames = x.len() / n;
        self.differences.resize((frames - 1) * n, 0.0);
        let pairs = x.chunks_exact(n).zip(x[n..].chunks_exact(n));
        for ((from, to), difference) in pairs.zip(self.differences.chunks_exact_mut(n)) {
            self.motion.space.difference(to, from, difference);
        }
        let costs = self.motion.rate_costs.iter();
        costs
            .map(|cost| {
                cost.cost(
                    &self.differences,
                    stretch.fixed_count.saturating_sub(cost.order),
                )
            })
            .sum()
    }

    /// Returns the same costs, and adds the gradient and Hessian of their sum.
    ///
    /// # Errors
    /// Returns an error if a sample has a number that is not finite.
    pub(super) fn linearise(
        &mut self,
        stretch: SampleSpan,
        x: &[f64],
        hessian: &mut BlockBanded,
        gradient: &mut [f64],
    ) -> Result<[f64; 2], MotionError> {
        let n = self.motion.variables();
        hessian.clear();
        gradient.fill(0.0);
        let (mut tasks, mut loops) = (0.0, 0.0);
        let mut gradient_copy = Vec::with_capacity(n);
        for (local, x) in x.chunks_exact(n).enumerate().skip(stretch.fixed_count) {
            let frame = stretch.first + local;
            let [cost, loop_cost] = self.frame_cost(frame, x);
            self.differentiate(frame, x);
            let sample_gradient = &mut gradient[local * n..(local + 1) * n];
            let slopes = self.jacobian.column_iter();
            for (slope, column) in sample_gradient.iter_mut().zip(slopes) {
                *slope += dot(column.as_slice(), &self.residual);
            }
            if !((cost + loop_cost).is_finite()
                && sample_gradient.iter().all(|slope| slope.is_finite()))
            {
                return Err(MotionError::NotFinite { frame });
            }
            match self.curved {
                false => (self.products).fill(&self.jacobian, &self.all_variables, &mut self.gram),
                true => {
                    sample_gradient.clone_into(&mut gradient_copy);
                    self.frame_hessian(frame, x, &gradient_copy);
                }
            }
            for row in 0..n {
                let entries = &mut hessian.row_mut(local, row)[row..];
                for (column, entry) in entries.iter_mut().enumerate() {
                    *entry += self.gram[(row + column) * n + row];
                }
            }
            tasks += cost;
            loops += loop_cost;
        }
        let rates = self.rates(stretch, x);
        for cost in &self.motion.rate_costs {
            let first = stretch.fixed_count.saturating_sub(cost.order);
            cost.add_to(
                &self.motion.space,
                x,
                &self.differences,
                first,
                hessian,
                gradient,
            );
        }
        let contacts = self
            .contact_springs
            .linearise(stretch, x, hessian, gradient);
        Ok([tasks + rates, contacts + loops])
    }

    /// Computes J of a sample's tasks by steps of its variables.
    fn differentiate(&mut self, frame: usize, x: &[f64]) {
        self.counts.jacobians += 1;
        self.residuals.jacobian(frame, x, &mut self.jacobian);
        let rows = self.jacobian.nrows();
        let entries = self.jacobian.as_mut_slice();
        self.motion.space.by_steps(x, rows, entries);
    }
}
