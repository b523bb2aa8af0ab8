//! Levenberg-Marquardt: (JᵀJ + λI) Δ = −Jᵀr over the free variables, and JᵀJ + S + λI where a large
//! residual makes the search creep and the learnt [curvature](super::curvature) S foretells better.

use super::linear::CurvedModel;
use super::{LeastSquares, Memory, Method, Step};

/// The first λ, as a share of max diag(JᵀJ), that is tried to make an indefinite model convex, and
/// how often it is quadrupled: to far above any curvature.
const LEAST_CONVEX_DAMPING: f64 = 1e-6;
const MOST_CONVEX_TRIALS: usize = 20;

/// How λ follows the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Damping {
    /// From the ratio of won to promised decrease (Nielsen 1999, "Damping parameter in
    /// Marquardt's method", IMM-REP-1999-05).
    GainRatio,
    /// λ = μ · cost, which falls off quadratically with the error (Chan & Lawrence 1988; Sugihara
    /// 2011, "Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method").
    ErrorProportional,
}

/// Levenberg-Marquardt with hard bounds.
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
        memory.learn_curvature(problem);
        if !memory.solve_curved(problem) {
            memory.solve_damped();
        }
        memory.project_step(problem);
        let linear = memory.model_cost();
        let promised = memory.cost - linear - memory.curvature.bend_in_use(&memory.step);
        let trial_cost = memory.evaluate_projected_trial(problem);
        let won = memory.cost - trial_cost;
        let accepted = won > 0.0;

        match self.damping {
            Damping::GainRatio if accepted => {
                let ratio = if promised > 0.0 { won / promised } else { 1.0 };
                let beyond_half = 2.0 * ratio - 1.0;
                let cubed = beyond_half * beyond_half * beyond_half;
                let kept = (1.0 - cubed).max(1.0 / 3.0);
                memory.damping *= kept.min(trial_cost / memory.cost);
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
            memory.curvature.note(
                &memory.jacobian,
                &memory.gradient,
                &memory.step,
                &memory.trial_residual,
                (linear, memory.cost, trial_cost),
            );
            memory.accept_trial(trial_cost);
            Step::Taken
        } else {
            Step::Refused
        }
    }
}

impl Memory {
    /// Lets S learn from the last step, or takes it anew.
    fn learn_curvature(&mut self, problem: &mut dyn LeastSquares) {
        if self
            .curvature
            .wants_differences(self.cost, self.column_norm)
        {
            let (x, free, room) = (&self.x, &self.free, &mut self.differences);
            let taken = self.curvature.take(problem, x, free, &self.jacobian, room);
            self.counts.residuals += taken;
            self.counts.gradients += taken;
        } else {
            self.curvature.learn(&self.gradient);
        }
    }

    /// Puts the damped step of the curved model into `step`, if S is in use and the model has a
    /// minimum once λ is large enough.
    fn solve_curved(&mut self, problem: &dyn LeastSquares) -> bool {
        let Some(curvature) = self.curvature.in_use() else {
            return false;
        };
        let model = CurvedModel {
            jacobian: &self.jacobian,
            curvature,
            gradient: &self.gradient,
            free: &self.free,
            x: &self.x,
            bounds: (problem.lower(), problem.upper()),
        };
        let least = LEAST_CONVEX_DAMPING * self.column_norm * self.column_norm;
        let mut damping = self.damping;
        for _ in 0..MOST_CONVEX_TRIALS {
            if self.curved.minimise(&model, damping, &mut self.step) {
                self.damping = damping;
                return true;
            }
            damping = (4.0 * damping).max(least);
        }
        false
    }

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

    /// Puts the projected x + Δ into `trial` and what is left of Δ into `step`.
    fn project_step(&mut self, problem: &dyn LeastSquares) {
        for ((trial, &x), &step) in self.trial.iter_mut().zip(&self.x).zip(&self.step) {
            *trial = x + step;
        }
        self.project_trial(problem);
    }
}
