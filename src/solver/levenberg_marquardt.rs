//! Levenberg-Marquardt: (JᵀJ + λI) Δ = −Jᵀr over the free variables.
//!
//! Where that is slow, which is where large residuals stay, the true second derivative of the cost
//! takes the place of JᵀJ (see `curvature`).

use super::{LeastSquares, Memory, Method, Step};

/// A step that leaves more than this share of the cost is slow.
const SLOW: f64 = 0.95;
/// After so many slow steps in a row the true second derivative is worth its price.
const SLOW_STEPS: usize = 10;

/// A residual below this share of the largest column norm of J (both per radian) bends the cost by
/// no more than that share of JᵀJ: searches that are slow there are slow because J is singular, and
/// fare better with JᵀJ.
const LARGE_RESIDUAL: f64 = 1e-3;

/// How λ follows the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
pub enum Damping {
    /// From the ratio of won to promised decrease (Nielsen 1999, "Damping parameter in
    /// Marquardt's method", IMM-REP-1999-05).
    GainRatio,
    /// λ = μ · cost, which falls off quadratically with the error (Chan & Lawrence 1988; Sugihara
    /// 2011, "Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method").
    ErrorProportional,
}

/// Levenberg-Marquardt with hard bounds.
///
/// With [`Damping::GainRatio`] the true second derivative of the cost takes the place of JᵀJ after ten
/// slow steps in a row while the residual is large; such a step takes a gradient for every
/// free variable.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
pub struct LevenbergMarquardt {
    damping: Damping,
    initial: f64,
}

impl LevenbergMarquardt {
    /// With a damping rule and its default first value.
    #[must_use]
    pub fn new(damping: Damping) -> Self {
        let initial = match damping {
            Damping::GainRatio => 1e-3,
            Damping::ErrorProportional => 0.1,
        };
        Self { damping, initial }
    }

    /// The first damping: τ in λ₀ = τ · max diag(JᵀJ) for the gain ratio, μ in λ = μ · cost for
    /// the error-proportional rule. Must be positive and finite; anything else changes nothing.
    #[must_use]
    pub fn with_initial_damping(mut self, initial: f64) -> Self {
        if initial > 0.0 && initial.is_finite() {
            self.initial = initial;
        }
        self
    }
}

impl Default for LevenbergMarquardt {
    fn default() -> Self {
        Self::new(Damping::GainRatio)
    }
}

impl Method for LevenbergMarquardt {
    fn name(&self) -> &'static str {
        match self.damping {
            Damping::GainRatio => "levenberg-marquardt",
            Damping::ErrorProportional => "levenberg-marquardt-error",
        }
    }

    fn needs_jacobian(&self) -> bool {
        true
    }

    fn begin(&self, memory: &mut Memory) {
        memory.damping_growth = 2.0;
        memory.damping_per_cost = self.initial;
        memory.damping = match self.damping {
            Damping::GainRatio => self.initial * memory.column_norm * memory.column_norm,
            Damping::ErrorProportional => self.initial * memory.cost,
        };
    }

    fn step(&self, problem: &mut dyn LeastSquares, memory: &mut Memory) -> Step {
        let curved = self.damping == Damping::GainRatio
            && memory.slow_steps >= SLOW_STEPS
            && memory.residual_is_large();
        let promised = if curved {
            memory.solve_curved(problem);
            memory.project_step(problem);
            let (slope, free) = (&memory.gradient, &memory.free);
            memory.curvature.promised(slope, free, &memory.step)
        } else {
            memory.solve_damped();
            memory.project_step(problem);
            memory.cost - memory.model_cost()
        };
        let trial_cost = memory.evaluate_projected_trial(problem);
        let won = memory.cost - trial_cost;
        let accepted = won > 0.0;

        match self.damping {
            Damping::GainRatio if accepted => {
                let ratio = if promised > 0.0 { won / promised } else { 1.0 };
                memory.damping *= (1.0 - (2.0 * ratio - 1.0).powi(3)).max(1.0 / 3.0);
                memory.damping_growth = 2.0;
            }
            Damping::GainRatio => {
                memory.damping *= memory.damping_growth;
                memory.damping_growth *= 2.0;
            }
            Damping::ErrorProportional => {
                if !accepted {
                    memory.damping_per_cost *= 4.0;
                } else if trial_cost < 0.25 * memory.cost {
                    memory.damping_per_cost *= 0.5;
                }
                memory.damping = memory.damping_per_cost * trial_cost.min(memory.cost);
            }
        }
        if accepted {
            let slow = trial_cost > SLOW * memory.cost;
            memory.slow_steps = if slow { memory.slow_steps + 1 } else { 0 };
            memory.accept_trial(trial_cost);
            Step::Taken
        } else {
            Step::Refused
        }
    }
}

impl Memory {
    /// Puts the damped step over the free variables into `step`.
    pub(super) fn solve_damped(&mut self) {
        let Self {
            jacobian,
            free,
            residual,
            step,
            normal,
            ..
        } = self;
        step.fill(0.0);
        normal.factorise(jacobian, free, self.damping);
        normal.solve(jacobian, free, residual, step);
    }

    fn residual_is_large(&self) -> bool {
        (2.0 * self.cost).sqrt() > LARGE_RESIDUAL * self.column_norm
    }

    /// As [`solve_damped`](Self::solve_damped), with the true second derivative for JᵀJ, and with
    /// λ raised as far as that needs to be positive definite. The Jacobian may be overwritten.
    fn solve_curved(&mut self, problem: &mut dyn LeastSquares) {
        let Self {
            curvature,
            x,
            gradient,
            free,
            jacobian,
            step,
            ..
        } = self;
        let taken = curvature.differentiate(problem, x, free, jacobian);
        self.counts.residuals += taken;
        self.counts.gradients += taken;
        step.fill(0.0);
        self.damping = curvature.solve(gradient, free, self.damping, step);
    }

    /// Puts the projected x + Δ into `trial` and what is left of Δ into `step`.
    fn project_step(&mut self, problem: &dyn LeastSquares) {
        for ((trial, &x), &step) in self.trial.iter_mut().zip(&self.x).zip(&self.step) {
            *trial = x + step;
        }
        self.project_trial(problem);
    }
}
