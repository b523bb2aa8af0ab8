//! Levenberg-Marquardt method: (JᵀJ + λI) Δ = −Jᵀr over the free variables.
//!
//! If a large residual makes the search slow, and the learnt [curvature](super::curvature) S predicts better, the
//! matrix is JᵀJ + S + λI.

use super::curvature::{Curvature, GradientDifferences, is_separable};
use super::linear::{CurvedModel, CurvedNormal, DampedNormal};
use super::{Iterate, Method, SolverState, Step};
use kinopt_kinematics::bad_option::{BadOption, POSITIVE};

/// First λ that is tried to make an indefinite model convex, relative to max diag(JᵀJ).
const MIN_CONVEX_DAMPING: f64 = 1e-6;
/// Number of times that this λ is quadrupled: to far above any curvature.
const MAX_CONVEX_TRIALS: usize = 20;

/// Rule for the damping λ.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(
    any(feature = "argmin", feature = "serde"),
    derive(serde::Serialize, serde::Deserialize)
)]
#[non_exhaustive]
pub enum Damping {
    /// By the ratio of actual to predicted decrease (Nielsen 1999, "Damping parameter in Marquardt's method",
    /// IMM-REP-1999-05).
    ///
    /// An accepted step also lowers λ at least as much as the cost. Convergence to a reachable goal is quadratic if λ
    /// falls with the squared error, and linear with Nielsen's factor of a third.
    GainRatio,
    /// λ = μ · cost, which falls quadratically with the error (Chan & Lawrence 1988; Sugihara 2011,
    /// "Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method").
    ErrorProportional,
}

/// Levenberg-Marquardt method with hard bounds.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
pub struct LevenbergMarquardt {
    damping: Damping,
    initial: f64,
}

impl LevenbergMarquardt {
    /// Method with a damping rule and its default initial damping.
    #[must_use]
    pub fn new(damping: Damping) -> Self {
        let initial = match damping {
            Damping::GainRatio => 1e-3,
            Damping::ErrorProportional => 0.1,
        };
        Self { damping, initial }
    }

    /// Sets the initial damping, positive and finite. Default 1e-3 and 0.1.
    ///
    /// For the gain ratio it is τ in λ₀ = τ · max diag(JᵀJ). For the error-proportional rule it is μ in λ = μ ·
    /// cost.
    #[must_use]
    pub fn with_initial_damping(mut self, initial: f64) -> Self {
        self.initial = initial;
        self
    }
}

impl Default for LevenbergMarquardt {
    fn default() -> Self {
        Self::new(Damping::GainRatio)
    }
}

/// State of a search by the Levenberg-Marquardt method.
#[derive(Clone, Debug, Default)]
#[cfg_attr(feature = "argmin", derive(serde::Serialize, serde::Deserialize))]
pub struct LevenbergMarquardtState {
    /// Damping λ.
    damping: f64,
    /// Factor by which a rejected step raises λ (Nielsen's ν).
    growth: f64,
    /// Factor μ in λ = μ · cost.
    per_cost: f64,
    curvature: Curvature,
    #[cfg_attr(feature = "argmin", serde(skip))]
    buffers: Buffers,
}

#[derive(Clone, Debug, Default)]
struct Buffers {
    /// Kept while x stays, so that a rejected step costs one factorisation.
    normal: DampedNormal,
    curved: CurvedNormal,
    differences: GradientDifferences,
}

impl Method for LevenbergMarquardt {
    type State = LevenbergMarquardtState;

    fn name(&self) -> &'static str {
        match self.damping {
            Damping::GainRatio => "levenberg-marquardt",
            Damping::ErrorProportional => "levenberg-marquardt-error",
        }
    }

    fn needs_jacobian(&self) -> bool {
        true
    }

    fn control(&self, state: &Self::State) -> f64 {
        state.damping
    }

    fn fits(&self, state: &Self::State, variables: usize) -> bool {
        state.curvature.fits(variables)
    }

    fn check(&self) -> Result<(), BadOption> {
        BadOption::check("initial_damping", self.initial, POSITIVE)
    }

    fn reserve(&self, state: &mut Self::State, rows: usize, variables: usize) {
        (state.damping, state.growth, state.per_cost) = (0.0, 0.0, 0.0);
        state.curvature.reset(rows, variables);
        state.buffers.reserve(rows, variables);
    }

    fn begin(&self, state: &mut Self::State, at: &SolverState) {
        state.growth = 2.0;
        state.per_cost = self.initial;
        state.damping = match self.damping {
            Damping::GainRatio => self.initial * at.column_norm * at.column_norm,
            Damping::ErrorProportional => self.initial * at.cost,
        };
    }

    fn step(&self, state: &mut Self::State, at: &mut Iterate<'_>) -> Step {
        state.learn_curvature(at);
        if !state.solve_curved(at) {
            state.buffers.normal.step(at.state, state.damping);
        }
        at.project_step();
        let linear_cost = at.model_cost();
        let predicted_decrease =
            at.cost - linear_cost - state.curvature.second_order_cost_in_use(at.state);
        let trial_cost = at.evaluate_trial();
        let decrease = at.cost - trial_cost;
        let accepted = decrease > 0.0;

        match self.damping {
            Damping::GainRatio if accepted => {
                // Projection and curvature may leave a model that predicts no decrease for a step that achieves one.
                // That is no reason to raise λ.
                let ratio = if predicted_decrease > 0.0 {
                    decrease / predicted_decrease
                } else {
                    1.0
                };
                let gain_offset = 2.0 * ratio - 1.0;
                let cube = gain_offset * gain_offset * gain_offset;
                let damping_factor = (1.0 - cube).max(1.0 / 3.0);
                state.damping *= damping_factor.min(trial_cost / at.cost);
                state.growth = 2.0;
            }
            Damping::GainRatio => {
                state.damping *= state.growth;
                state.growth *= 2.0;
            }
            Damping::ErrorProportional => {
                if !accepted {
                    state.per_cost *= 4.0;
                } else if trial_cost < 0.25 * at.cost {
                    state.per_cost *= 0.5;
                }
                state.damping = state.per_cost * trial_cost.min(at.cost);
            }
        }
        if !accepted {
            return Step::Refused;
        }
        state.curvature.record_step(at, linear_cost, trial_cost);
        state.buffers.normal.forget();
        at.accept();
        Step::Taken
    }
}

impl Buffers {
    fn reserve(&mut self, rows: usize, variables: usize) {
        self.normal.reserve(rows, variables);
        self.curved
            .reserve(rows, variables, is_separable(rows, variables));
        self.differences.reserve(rows, variables);
    }
}

impl LevenbergMarquardtState {
    /// Updates S by the last step, or computes it from differences.
    fn learn_curvature(&mut self, iterate: &mut Iterate<'_>) {
        let Iterate { problem, state: at } = iterate;
        if self.curvature.needs_differences(at.cost, at.column_norm) {
            let Buffers {
                differences,
                curved,
                ..
            } = &mut self.buffers;
            let gradient_count = match self.curvature.is_separable() {
                true => {
                    let normal = &mut curved.semiseparable;
                    self.curvature
                        .compute_separable(*problem, at, differences, normal)
                }
                false => self.curvature.compute_dense(*problem, at, differences),
            };
            at.counts.residuals += gradient_count;
            at.counts.gradients += gradient_count;
        } else {
            self.curvature.update(&at.gradient);
        }
    }

    /// Writes the damped step of the curved model. Returns false if S is not in use.
    ///
    /// Raises λ until the model has a minimum, and returns false if it never has one.
    fn solve_curved(&mut self, iterate: &mut Iterate<'_>) -> bool {
        let Some(curvature) = self.curvature.in_use() else {
            return false;
        };
        let state = &mut *iterate.state;
        let model = CurvedModel {
            jacobian: &state.jacobian,
            curvature,
            gradient: &state.gradient,
            free: &state.free,
            scale: &state.step_scale,
            x: &state.x,
            space: iterate.problem.space(),
        };
        let min_damping = MIN_CONVEX_DAMPING * state.column_norm * state.column_norm;
        let mut damping = self.damping;
        for _ in 0..MAX_CONVEX_TRIALS {
            if self
                .buffers
                .curved
                .minimise(&model, damping, &mut state.step)
            {
                self.damping = damping;
                return true;
            }
            damping = (4.0 * damping).max(min_damping);
        }
        false
    }
}
