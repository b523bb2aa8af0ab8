//! Primal-dual interior-point method for bounded nonlinear least squares over many samples.
//!
//! Every iterate is strictly feasible. A step solves the Newton equations of the barrier problem F(x) − μ Σ ln s. Its
//! multipliers are z (Nocedal & Wright 2006, "Numerical optimization", 19.3). The parameter μ decreases as fast as a
//! step with μ = 0 predicts (Mehrotra 1992, "On the implementation of a primal-dual interior point method"). The
//! Hessian is that of Gauss-Newton at first.

use std::sync::atomic::{AtomicBool, Ordering};

use super::barrier::Barrier;
use super::block_banded::BlockBanded;
use super::bounds::{Inward, SampleVariables};
use super::evaluator::SampleEvaluator;
use super::stretch::SampleSpan;
use super::{MotionError, MotionProblem, MotionTermination};
use kinopt_kinematics::model::Loop;
use kinopt_solver::solver::dot;

/// Initial Σ s z, relative to the cost.
const INITIAL_GAP_RATIO: f64 = 0.1;
/// Smallest ratio of actual to predicted decrease (Armijo), and maximum number of halvings.
const ARMIJO_RATIO: f64 = 1e-4;
const HALVINGS: usize = 12;
/// First damping after a failed step, relative to the largest diagonal entry, and the factors of its increase and
/// decrease.
const INITIAL_DAMPING: f64 = 1e-6;
const DAMPING_INCREASE: f64 = 10.0;
const DAMPING_DECREASE: f64 = 0.1;
/// Smallest damping, which keeps undetermined variables fixed, and largest damping that is tried.
const MIN_DAMPING: f64 = 1e-13;
const MAX_DAMPING: f64 = 1e3;
/// Smallest ratio of successive values of μ.
const MIN_CENTRING: f64 = 1e-4;
/// Smallest Σ s z relative to the other predicted decrease; keeps the iterates away from bounds at first.
const MIN_GAP_RATIO: f64 = 0.3;
/// Number of Gauss-Newton steps before the full Hessian is used.
const GAUSS_NEWTON_STEPS: usize = 10;
/// Maximum number of multiplier updates; more with loops, whose penalty starts softer.
const MAX_MULTIPLIER_UPDATES: usize = 6;
const MAX_LOOP_MULTIPLIER_UPDATES: usize = 30;

/// Stopping criteria and options.
#[derive(Clone, Copy, Debug)]
pub(super) struct InteriorPointOptions {
    /// Tolerance of the predicted decrease, relative to the cost.
    pub(super) tolerance: f64,
    pub(super) iterations: usize,
    /// True to use the full Hessian after the first steps.
    pub(super) curvature: bool,
    /// Displacement of the start off its bounds.
    pub(super) inward: Inward,
    /// Largest sliding between consecutive samples, metres.
    pub(super) slip_m: f64,
}

/// Consecutive samples that are solved together.
pub(super) struct Window<'a, 'e> {
    pub(super) motion: &'a MotionProblem,
    pub(super) evaluator: &'e mut SampleEvaluator<'a>,
    pub(super) stretch: SampleSpan,
    pub(super) fixed: Vec<bool>,
    /// Flag that cancels the search.
    pub(super) cancelled: Option<&'e AtomicBool>,
}

/// Result of a search. The variables are updated in place.
pub(super) struct InteriorPointOutcome<'a> {
    pub(super) termination: MotionTermination,
    pub(super) iterations: usize,
    pub(super) barrier: Barrier<'a>,
    /// Cost before the last step.
    pub(super) cost: f64,
}

/// Scratch memory of steps.
struct StepWorkspace {
    hessian: BlockBanded,
    factor: BlockBanded,
    gradient: Vec<f64>,
    direction: Vec<f64>,
    buffer: Vec<f64>,
    damping: f64,
    was_shortened: bool,
}

impl<'a> Window<'a, '_> {
    /// Minimises from x, in place.
    pub(super) fn minimise(
        &mut self,
        x: &mut [f64],
        limits: InteriorPointOptions,
    ) -> Result<InteriorPointOutcome<'a>, MotionError> {
        let n = self.motion.variables();
        let frames = self.fixed.len();
        let fixed = &self.fixed;
        let moved = self
            .motion
            .bounds
            .move_inside(&mut SampleVariables { x, fixed }, limits.inward);
        moved.map_err(|too_far| self.too_far(too_far.variable))?;
        self.evaluator.reset(frames);
        let mut barrier = Barrier::new(&self.motion.bounds, &self.fixed);
        if let Some(variable) = barrier.update(x) {
            return Err(self.too_far(variable % n));
        }
        let hessian = BlockBanded::new(frames, n, self.motion.bandwidth());
        let mut step = StepWorkspace {
            factor: hessian.clone(),
            hessian,
            gradient: vec![0.0; frames * n],
            direction: vec![0.0; frames * n],
            buffer: Vec::new(),
            damping: 0.0,
            was_shortened: false,
        };
        let max_updates = match self.motion.has_loops() {
            true => MAX_LOOP_MULTIPLIER_UPDATES,
            false => MAX_MULTIPLIER_UPDATES,
        };
        let (mut iterations, mut updates) = (0, 0);
        let mut termination = MotionTermination::IterationLimit;
        let mut last_cost = f64::INFINITY;
        while iterations < limits.iterations {
            if (self.cancelled).is_some_and(|cancelled| cancelled.load(Ordering::Relaxed)) {
                return Err(MotionError::Cancelled);
            }
            self.evaluator.curved =
                limits.curvature && (step.was_shortened || iterations >= GAUSS_NEWTON_STEPS);
            let costs = self.linearise(x, &mut step)?;
            let cost = costs[0] + costs[1];
            last_cost = costs[0];
            if iterations == 0 && !barrier.is_empty() {
                let min_gap = f64::MIN_POSITIVE.sqrt();
                barrier.centre((INITIAL_GAP_RATIO * cost).max(min_gap) / barrier.len() as f64);
            }
            barrier.add_to(n, &mut step.hessian);
            self.eliminate_fixed(&mut step.hessian);
            iterations += 1;
            let result = self.step(x, cost, &mut barrier, &mut step)?;
            let Some((predicted, gap)) = result else {
                termination = MotionTermination::SmallStep;
                break;
            };
            if predicted + gap <= limits.tolerance * costs[0] {
                let slip = self
                    .evaluator
                    .contact_springs
                    .update_multipliers(self.stretch, x);
                let closure_error =
                    self.evaluator
                        .update_loop_multipliers(self.stretch, x, &self.fixed);
                let within_tolerance = slip <= limits.slip_m && closure_error <= Loop::TOLERANCE;
                if within_tolerance || updates == max_updates {
                    termination = MotionTermination::Stationary;
                    break;
                }
                updates += 1;
            }
        }
        Ok(InteriorPointOutcome {
            termination,
            iterations,
            barrier,
            cost: last_cost,
        })
    }

    fn linearise(&mut self, x: &[f64], step: &mut StepWorkspace) -> Result<[f64; 2], MotionError> {
        let StepWorkspace {
            hessian, gradient, ..
        } = step;
        self.evaluator.linearise(self.stretch, x, hessian, gradient)
    }

    /// Takes one step. Returns its predicted decrease and the new Σ s z, or `None` if no step decreases the merit.
    fn step(
        &mut self,
        x: &mut [f64],
        cost: f64,
        barrier: &mut Barrier<'_>,
        step: &mut StepWorkspace,
    ) -> Result<Option<(f64, f64)>, MotionError> {
        let largest = step.hessian.largest();
        let mut trial = x.to_vec();
        loop {
            self.factorise(step, largest);
            barrier.clear_curvature();
            // The Σ s z after a full step with μ = 0 determines how far μ may decrease.
            let mu = match barrier.is_empty() {
                true => 0.0,
                false => {
                    let predicted_gain = 0.5 * self.solve_step(step, barrier, 0.0);
                    barrier.compute_steps(&step.direction, 0.0);
                    let (slack_fraction, multiplier_fraction) = barrier.max_fractions();
                    let gap = barrier.gap();
                    let ratio = barrier.gap_after(slack_fraction, multiplier_fraction) / gap;
                    let centring = (ratio * ratio * ratio).clamp(MIN_CENTRING, 1.0);
                    (centring * gap).max(MIN_GAP_RATIO * predicted_gain) / barrier.len() as f64
                }
            };
            let mut slope = self.solve_step(step, barrier, mu);
            barrier.compute_steps(&step.direction, mu);
            if barrier.store_curvature() {
                slope = self.solve_curved_step(step, barrier, mu).unwrap_or(slope);
                barrier.compute_steps(&step.direction, mu);
            }
            let (max_fractions, multiplier_fraction) = barrier.max_fractions();
            let merit = cost + mu * barrier.cost(x);
            let mut step_scale = max_fractions;
            for _ in 0..HALVINGS {
                self.move_by(x, step_scale, &step.direction, &mut trial);
                let trial_barrier = mu * barrier.cost(&trial);
                let trial_cost = match trial_barrier.is_finite() {
                    true => {
                        self.evaluator
                            .cost(self.stretch, &trial)
                            .iter()
                            .sum::<f64>()
                            + trial_barrier
                    }
                    false => f64::INFINITY,
                };
                let threshold = merit - ARMIJO_RATIO * step_scale * slope;
                // Steps whose decrease is within rounding are accepted.
                if trial_cost <= threshold + 4.0 * f64::EPSILON * merit.abs() {
                    x.copy_from_slice(&trial);
                    barrier.move_multipliers(multiplier_fraction);
                    if let Some(variable) = barrier.update(x) {
                        return Err(self.too_far(variable % self.motion.variables()));
                    }
                    if step_scale == max_fractions {
                        step.damping *= DAMPING_DECREASE;
                    } else {
                        // JᵀJ overestimated the decrease.
                        step.was_shortened = true;
                    }
                    let predicted = 0.5 * slope.max(0.0) / step_scale;
                    return Ok(Some((predicted, barrier.gap())));
                }
                step_scale *= 0.5;
            }
            if step.damping > MAX_DAMPING {
                return Ok(None);
            }
            step.damping = (DAMPING_INCREASE * step.damping).max(INITIAL_DAMPING);
        }
    }

    /// Factorises the system, with as much damping as needed.
    fn factorise(&mut self, step: &mut StepWorkspace, largest: f64) {
        loop {
            step.factor.copy_from(&step.hessian);
            let damping = step.damping.max(MIN_DAMPING) * largest;
            step.factor.add_to_diagonal(damping);
            self.evaluator.counts.factored_frames += self.fixed.len();
            if step.factor.factorise() || step.damping > MAX_DAMPING {
                return;
            }
            step.damping = (DAMPING_INCREASE * step.damping).max(INITIAL_DAMPING);
        }
    }

    /// Solves for the step with barrier parameter μ. Returns the slope of the barrier problem along it.
    fn solve_step(&self, step: &mut StepWorkspace, barrier: &Barrier<'_>, mu: f64) -> f64 {
        let direction = &mut step.direction;
        for (direction, slope) in direction.iter_mut().zip(&step.gradient) {
            *direction = -slope;
        }
        barrier.add_force(mu, direction);
        self.keep_fixed(direction);
        let rhs = direction.clone();
        step.factor.solve(direction, &mut step.buffer);
        self.keep_fixed(direction);
        dot(&rhs, direction)
    }

    /// Corrects the step for the curvature of length bounds, so that it follows them instead of being cut.
    ///
    /// Returns the slope of the barrier problem along the step. Returns `None` and keeps the step if that is not a
    /// descent direction.
    fn solve_curved_step(
        &self,
        step: &mut StepWorkspace,
        barrier: &mut Barrier<'_>,
        mu: f64,
    ) -> Option<f64> {
        let uncorrected = step.direction.clone();
        let mut steepest: Vec<f64> = step.gradient.iter().map(|slope| -slope).collect();
        barrier.add_force(mu, &mut steepest);
        step.direction.copy_from_slice(&steepest);
        barrier.add_curvature(&mut step.direction);
        self.keep_fixed(&mut step.direction);
        step.factor.solve(&mut step.direction, &mut step.buffer);
        self.keep_fixed(&mut step.direction);
        let slope = dot(&steepest, &step.direction);
        if slope > 0.0 {
            return Some(slope);
        }
        barrier.clear_curvature();
        step.direction.copy_from_slice(&uncorrected);
        None
    }

    fn move_by(&self, x: &[f64], fraction: f64, direction: &[f64], to: &mut [f64]) {
        let n = self.motion.variables();
        let frames = x.chunks_exact(n).zip(direction.chunks_exact(n));
        for (((x, direction), to), fixed) in frames.zip(to.chunks_exact_mut(n)).zip(&self.fixed) {
            match fixed {
                true => to.copy_from_slice(x),
                false => self.motion.space.integrate(x, fraction, direction, to),
            }
        }
    }

    /// Zeroes the entries of fixed samples and of variables with equal bounds.
    fn keep_fixed(&self, direction: &mut [f64]) {
        let is_constant = &self.motion.bounds.is_constant;
        for (direction, &fixed) in direction
            .chunks_exact_mut(is_constant.len())
            .zip(&self.fixed)
        {
            for (direction, &is_constant) in direction.iter_mut().zip(is_constant) {
                if fixed || is_constant {
                    *direction = 0.0;
                }
            }
        }
    }

    fn eliminate_fixed(&self, hessian: &mut BlockBanded) {
        for (frame, &fixed) in self.fixed.iter().enumerate() {
            for (variable, &is_constant) in self.motion.bounds.is_constant.iter().enumerate() {
                if fixed || is_constant {
                    hessian.eliminate(frame, variable);
                }
            }
        }
    }

    fn too_far(&self, variable: usize) -> MotionError {
        MotionError::TooFar {
            joint: self.motion.problem.names().joints[variable].clone(),
        }
    }
}
