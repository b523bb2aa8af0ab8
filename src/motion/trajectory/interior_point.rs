//! Primal-dual interior-point method for bounded nonlinear least squares over many samples.
//!
//! Every iterate is strictly feasible. A step solves the Newton equations of the barrier problem F(x) − μ Σ ln s. Its
//! multipliers are z (Nocedal & Wright 2006, "Numerical optimization", 19.3). The parameter μ decreases as fast as a
//! step with μ = 0 predicts (Mehrotra 1992, "On the implementation of a primal-dual interior point method"). The
//! Hessian is that of Gauss-Newton at first.

use std::sync::atomic::{AtomicBool, Ordering};

use super::barrier::Barrier;
use super::block_banded::BlockBanded;
use super::bounds::{Frames, Inward};
use super::evaluator::{Evaluator, Stretch};
use super::{MotionError, MotionProblem, MotionTermination};
use crate::model::Loop;
use crate::solver::dot;

/// Initial Σ s z, relative to the cost.
const FIRST_GAP: f64 = 0.1;
/// Smallest ratio of actual to predicted decrease (Armijo), and maximum number of halvings.
const SUFFICIENT: f64 = 1e-4;
const HALVINGS: usize = 12;
/// First damping after a failed step, relative to the largest diagonal entry, and the factors of its increase and
/// decrease.
const FIRST_DAMPING: f64 = 1e-6;
const MORE_DAMPING: f64 = 10.0;
const LESS_DAMPING: f64 = 0.1;
/// Smallest damping, which keeps undetermined variables fixed, and largest damping that is tried.
const LEAST_DAMPING: f64 = 1e-13;
const MOST_DAMPING: f64 = 1e3;
/// Smallest ratio of successive values of μ.
const LEAST_CENTRING: f64 = 1e-4;
/// Smallest Σ s z relative to the other predicted decrease; keeps the iterates away from bounds at first.
const LEAST_GAP: f64 = 0.3;
/// Number of Gauss-Newton steps before the full Hessian is used.
const PLAIN_STEPS: usize = 10;
/// Maximum number of multiplier updates; more with loops, whose penalty starts softer.
const MOST_TIGHTENINGS: usize = 6;
const MOST_TIGHTENINGS_OF_LOOPS: usize = 30;

/// Stopping criteria and options.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits {
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
    pub(super) evaluator: &'e mut Evaluator<'a>,
    pub(super) at: Stretch,
    pub(super) fixed: Vec<bool>,
    /// Flag that cancels the search.
    pub(super) cancelled: Option<&'e AtomicBool>,
}

/// Result of a search. The variables are updated in place.
pub(super) struct Outcome<'a> {
    pub(super) termination: MotionTermination,
    pub(super) iterations: usize,
    pub(super) barrier: Barrier<'a>,
    /// Cost before the last step.
    pub(super) cost: f64,
}

/// Scratch memory of steps.
struct Step {
    hessian: BlockBanded,
    factor: BlockBanded,
    gradient: Vec<f64>,
    way: Vec<f64>,
    room: Vec<f64>,
    damping: f64,
    was_cut: bool,
}

impl<'a> Window<'a, '_> {
    /// Minimises from x, in place.
    pub(super) fn minimise(
        &mut self,
        x: &mut [f64],
        limits: Limits,
    ) -> Result<Outcome<'a>, MotionError> {
        let n = self.motion.variables();
        let frames = self.fixed.len();
        let fixed = &self.fixed;
        let within = self
            .motion
            .bounds
            .draw_within(&mut Frames { x, fixed }, limits.inward);
        within.map_err(|too_far| self.too_far(too_far.variable))?;
        self.evaluator.begin(frames);
        let mut barrier = Barrier::new(&self.motion.bounds, &self.fixed);
        if let Some(at) = barrier.look(x) {
            return Err(self.too_far(at % n));
        }
        let hessian = BlockBanded::new(frames, n, self.motion.bandwidth());
        let mut step = Step {
            factor: hessian.clone(),
            hessian,
            gradient: vec![0.0; frames * n],
            way: vec![0.0; frames * n],
            room: Vec::new(),
            damping: 0.0,
            was_cut: false,
        };
        let most_tightenings = match self.motion.has_loops() {
            true => MOST_TIGHTENINGS_OF_LOOPS,
            false => MOST_TIGHTENINGS,
        };
        let (mut iterations, mut tightenings) = (0, 0);
        let mut termination = MotionTermination::IterationLimit;
        let mut last_cost = f64::INFINITY;
        while iterations < limits.iterations {
            if (self.cancelled).is_some_and(|cancelled| cancelled.load(Ordering::Relaxed)) {
                return Err(MotionError::Cancelled);
            }
            self.evaluator.curved = limits.curvature && (step.was_cut || iterations >= PLAIN_STEPS);
            let costs = self.linearise(x, &mut step)?;
            let cost = costs[0] + costs[1];
            last_cost = costs[0];
            if iterations == 0 && !barrier.is_empty() {
                let least = f64::MIN_POSITIVE.sqrt();
                barrier.centre((FIRST_GAP * cost).max(least) / barrier.len() as f64);
            }
            barrier.add_to(n, &mut step.hessian);
            self.take_out_fixed(&mut step.hessian);
            iterations += 1;
            let won = self.step(x, cost, &mut barrier, &mut step)?;
            let Some((promised, gap)) = won else {
                termination = MotionTermination::SmallStep;
                break;
            };
            if promised + gap <= limits.tolerance * costs[0] {
                let slip = self.evaluator.held.tighten(self.at, x);
                let open = self.evaluator.tighten_loops(self.at, x, &self.fixed);
                let holds = slip <= limits.slip_m && open <= Loop::TOLERANCE;
                if holds || tightenings == most_tightenings {
                    termination = MotionTermination::Stationary;
                    break;
                }
                tightenings += 1;
            }
        }
        Ok(Outcome {
            termination,
            iterations,
            barrier,
            cost: last_cost,
        })
    }

    fn linearise(&mut self, x: &[f64], step: &mut Step) -> Result<[f64; 2], MotionError> {
        let Step {
            hessian, gradient, ..
        } = step;
        self.evaluator.linearise(self.at, x, hessian, gradient)
    }

    /// Takes one step. Returns its predicted decrease and the new Σ s z, or `None` if no step decreases the merit.
    fn step(
        &mut self,
        x: &mut [f64],
        cost: f64,
        barrier: &mut Barrier<'_>,
        step: &mut Step,
    ) -> Result<Option<(f64, f64)>, MotionError> {
        let largest = step.hessian.largest();
        let mut trial = x.to_vec();
        loop {
            self.factorise(step, largest);
            barrier.forget_bends();
            // The Σ s z after a full step with μ = 0 determines how far μ may decrease.
            let mu = match barrier.is_empty() {
                true => 0.0,
                false => {
                    let to_win = 0.5 * self.aim(step, barrier, 0.0);
                    barrier.take_step(&step.way, 0.0);
                    let (of_slacks, of_multipliers) = barrier.longest();
                    let gap = barrier.gap();
                    let left = barrier.gap_after(of_slacks, of_multipliers) / gap;
                    let centring = (left * left * left).clamp(LEAST_CENTRING, 1.0);
                    (centring * gap).max(LEAST_GAP * to_win) / barrier.len() as f64
                }
            };
            let mut downhill = self.aim(step, barrier, mu);
            barrier.take_step(&step.way, mu);
            if barrier.bend() {
                downhill = self.aim_bent(step, barrier, mu).unwrap_or(downhill);
                barrier.take_step(&step.way, mu);
            }
            let (longest, of_multipliers) = barrier.longest();
            let merit = cost + mu * barrier.cost(x);
            let mut share = longest;
            for _ in 0..HALVINGS {
                self.move_by(x, share, &step.way, &mut trial);
                let beyond = mu * barrier.cost(&trial);
                let trial_cost = match beyond.is_finite() {
                    true => self.evaluator.cost(self.at, &trial).iter().sum::<f64>() + beyond,
                    false => f64::INFINITY,
                };
                let enough = merit - SUFFICIENT * share * downhill;
                // Steps whose decrease is within rounding are accepted.
                if trial_cost <= enough + 4.0 * f64::EPSILON * merit.abs() {
                    x.copy_from_slice(&trial);
                    barrier.move_multipliers(of_multipliers);
                    if let Some(at) = barrier.look(x) {
                        return Err(self.too_far(at % self.motion.variables()));
                    }
                    if share == longest {
                        step.damping *= LESS_DAMPING;
                    } else {
                        // JᵀJ overestimated the decrease.
                        step.was_cut = true;
                    }
                    let promised = 0.5 * downhill.max(0.0) / share;
                    return Ok(Some((promised, barrier.gap())));
                }
                share *= 0.5;
            }
            if step.damping > MOST_DAMPING {
                return Ok(None);
            }
            step.damping = (MORE_DAMPING * step.damping).max(FIRST_DAMPING);
        }
    }

    /// Factorises the system, with as much damping as needed.
    fn factorise(&mut self, step: &mut Step, largest: f64) {
        loop {
            step.factor.copy_from(&step.hessian);
            let damping = step.damping.max(LEAST_DAMPING) * largest;
            step.factor.add_to_diagonal(damping);
            self.evaluator.counts.factored_frames += self.fixed.len();
            if step.factor.factorise() || step.damping > MOST_DAMPING {
                return;
            }
            step.damping = (MORE_DAMPING * step.damping).max(FIRST_DAMPING);
        }
    }

    /// Solves for the step with barrier parameter μ. Returns the slope of the barrier problem along it.
    fn aim(&self, step: &mut Step, barrier: &Barrier<'_>, mu: f64) -> f64 {
        let way = &mut step.way;
        for (way, slope) in way.iter_mut().zip(&step.gradient) {
            *way = -slope;
        }
        barrier.add_push(mu, way);
        self.keep_fixed(way);
        let downhill = way.clone();
        step.factor.solve(way, &mut step.room);
        self.keep_fixed(way);
        dot(&downhill, way)
    }

    /// Corrects the step for the curvature of length bounds, so that it follows them instead of being cut.
    ///
    /// Returns the slope of the barrier problem along the step. Returns `None` and keeps the step if that is not a
    /// descent direction.
    fn aim_bent(&self, step: &mut Step, barrier: &mut Barrier<'_>, mu: f64) -> Option<f64> {
        let straight = step.way.clone();
        let mut steepest: Vec<f64> = step.gradient.iter().map(|slope| -slope).collect();
        barrier.add_push(mu, &mut steepest);
        step.way.copy_from_slice(&steepest);
        barrier.add_bends(&mut step.way);
        self.keep_fixed(&mut step.way);
        step.factor.solve(&mut step.way, &mut step.room);
        self.keep_fixed(&mut step.way);
        let downhill = dot(&steepest, &step.way);
        if downhill > 0.0 {
            return Some(downhill);
        }
        barrier.forget_bends();
        step.way.copy_from_slice(&straight);
        None
    }

    fn move_by(&self, x: &[f64], share: f64, way: &[f64], to: &mut [f64]) {
        let n = self.motion.variables();
        let frames = x.chunks_exact(n).zip(way.chunks_exact(n));
        for (((x, way), to), fixed) in frames.zip(to.chunks_exact_mut(n)).zip(&self.fixed) {
            match fixed {
                true => to.copy_from_slice(x),
                false => self.motion.space.integrate(x, share, way, to),
            }
        }
    }

    /// Zeroes the entries of fixed samples and of variables with equal bounds.
    fn keep_fixed(&self, way: &mut [f64]) {
        let still = &self.motion.bounds.still;
        for (way, &fixed) in way.chunks_exact_mut(still.len()).zip(&self.fixed) {
            for (way, &still) in way.iter_mut().zip(still) {
                if fixed || still {
                    *way = 0.0;
                }
            }
        }
    }

    fn take_out_fixed(&self, hessian: &mut BlockBanded) {
        for (frame, &fixed) in self.fixed.iter().enumerate() {
            for (variable, &still) in self.motion.bounds.still.iter().enumerate() {
                if fixed || still {
                    hessian.take_out(frame, variable);
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
