//! Cost, gradient and Hessian of consecutive samples.

use nalgebra::DMatrix;

use super::block_banded::BlockBanded;
use super::frame_residuals::FrameResiduals;
use super::held_points::HeldPoints;
use super::{MotionCounts, MotionError, MotionProblem};
use crate::solver::{InnerProducts, dot, half_squared};

/// Step of finite differences, relative to a variable's unit.
const ASIDE: f64 = 1e-6;

/// Evaluator of samples of one trajectory, with its memory.
pub(super) struct Evaluator<'a> {
    motion: &'a MotionProblem,
    residuals: FrameResiduals<'a>,
    residual: Vec<f64>,
    jacobian: DMatrix<f64>,
    products: InnerProducts,
    gram: Vec<f64>,
    all: Vec<usize>,
    ways: Vec<f64>,
    /// True for the full Hessian of each sample, false for JᵀJ.
    pub(super) curved: bool,
    pub(super) held: HeldPoints<'a>,
    pub(super) counts: MotionCounts,
}

/// Consecutive samples, the first of which only contribute to differences.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    /// Index of the first sample in the trajectory.
    pub(super) first: usize,
    /// Number of leading samples that stay fixed.
    pub(super) held: usize,
}

impl<'a> Evaluator<'a> {
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
            all: (0..n).collect(),
            ways: Vec::new(),
            curved: false,
            held: HeldPoints::new(motion),
            counts: MotionCounts::default(),
            motion,
        }
    }

    /// Returns each task's rows at a sample, without the sample's weights.
    pub(super) fn unweighed(&mut self, frame: usize, x: &[f64]) -> &[f64] {
        self.residuals.unweighed(frame, x, &mut self.residual);
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
        let mut aside = vec![0.0; n];
        let mut moved = vec![0.0; n];
        let mut slopes = vec![0.0; n];
        self.gram.fill(0.0);
        for k in 0..n {
            aside[k] = ASIDE * self.motion.unit(k);
            self.motion.space.integrate(x, 1.0, &aside, &mut moved);
            self.frame_gradient(frame, &moved, &mut slopes);
            for (row, (slope, before)) in slopes.iter().zip(gradient).enumerate() {
                let half = 0.5 * (slope - before) / aside[k];
                self.gram[row * n + k] += half;
                self.gram[k * n + row] += half;
            }
            aside[k] = 0.0;
        }
    }

    /// Returns ½‖r‖² of a sample's tasks, and of its loops.
    pub(super) fn frame_cost(&mut self, frame: usize, x: &[f64]) -> [f64; 2] {
        self.counts.residuals += 1;
        self.residuals.residual(frame, x, &mut self.residual);
        let (tasks, loops) = self.residual.split_at(self.residuals.rows_of_tasks());
        [half_squared(tasks), half_squared(loops)]
    }

    /// Updates the multipliers of loops at samples that are not fixed. Returns the largest closure error.
    pub(super) fn tighten_loops(&mut self, at: Stretch, x: &[f64], fixed: &[bool]) -> f64 {
        let n = self.motion.variables();
        let frames = x.chunks_exact(n).zip(fixed).enumerate();
        let mut most = 0.0_f64;
        for (local, (x, _)) in frames.filter(|(_, (_, fixed))| !**fixed) {
            let open = self
                .residuals
                .tighten(at.first + local, x, &mut self.residual);
            most = most.max(open);
        }
        self.residuals.stiffen(most);
        most
    }

    /// Resets the multipliers for other samples.
    pub(super) fn begin(&mut self, frames: usize) {
        self.held.begin(frames);
        self.residuals.begin();
    }

    /// Returns the cost of tasks and rates, and the penalty of contacts and loops.
    pub(super) fn cost(&mut self, at: Stretch, x: &[f64]) -> [f64; 2] {
        let n = self.motion.variables();
        let (mut tasks, mut loops) = (0.0, 0.0);
        for (frame, x) in x.chunks_exact(n).enumerate().skip(at.held) {
            let [own, open] = self.frame_cost(at.first + frame, x);
            tasks += own;
            loops += open;
        }
        [tasks + self.rates(at, x), self.held.cost(at, x) + loops]
    }

    /// Returns the cost of rates, and stores the differences between samples.
    pub(super) fn rates(&mut self, at: Stretch, x: &[f64]) -> f64 {
        let n = self.motion.variables();
        let frames = x.len() / n;
        self.ways.resize((frames - 1) * n, 0.0);
        let pairs = x.chunks_exact(n).zip(x[n..].chunks_exact(n));
        for ((from, to), way) in pairs.zip(self.ways.chunks_exact_mut(n)) {
            self.motion.space.difference(to, from, way);
        }
        let costs = self.motion.rate_costs.iter();
        costs
            .map(|cost| cost.cost(&self.ways, at.held.saturating_sub(cost.order)))
            .sum()
    }

    /// Returns the same costs, and adds the gradient and Hessian of their sum.
    ///
    /// # Errors
    /// Returns an error if a sample has a number that is not finite.
    pub(super) fn linearise(
        &mut self,
        at: Stretch,
        x: &[f64],
        hessian: &mut BlockBanded,
        gradient: &mut [f64],
    ) -> Result<[f64; 2], MotionError> {
        let n = self.motion.variables();
        hessian.clear();
        gradient.fill(0.0);
        let (mut tasks, mut loops) = (0.0, 0.0);
        let mut slopes_of_frame = Vec::with_capacity(n);
        for (local, x) in x.chunks_exact(n).enumerate().skip(at.held) {
            let frame = at.first + local;
            let [cost, open] = self.frame_cost(frame, x);
            self.differentiate(frame, x);
            let own = &mut gradient[local * n..(local + 1) * n];
            let slopes = self.jacobian.column_iter();
            for (slope, column) in own.iter_mut().zip(slopes) {
                *slope += dot(column.as_slice(), &self.residual);
            }
            if !((cost + open).is_finite() && own.iter().all(|slope| slope.is_finite())) {
                return Err(MotionError::NotFinite { frame });
            }
            match self.curved {
                false => (self.products).fill(&self.jacobian, &self.all, &mut self.gram),
                true => {
                    own.clone_into(&mut slopes_of_frame);
                    self.frame_hessian(frame, x, &slopes_of_frame);
                }
            }
            for row in 0..n {
                let entries = &mut hessian.row_mut(local, row)[row..];
                for (column, entry) in entries.iter_mut().enumerate() {
                    *entry += self.gram[(row + column) * n + row];
                }
            }
            tasks += cost;
            loops += open;
        }
        let rates = self.rates(at, x);
        for cost in &self.motion.rate_costs {
            let first = at.held.saturating_sub(cost.order);
            cost.add_to(&self.motion.space, x, &self.ways, first, hessian, gradient);
        }
        let held = self.held.linearise(at, x, hessian, gradient);
        Ok([tasks + rates, held + loops])
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
