//! Bounded Gauss-Newton method for problems with a good start.
//!
//! A step minimises the damped model within the bounds by an active set. Variables that would leave their bounds are
//! fixed there, and the rest is solved again. Clamped steps would leave the end effectors of clamped joints off their
//! targets at every sample.

use nalgebra::DMatrix;

use crate::problem::{Evaluation, NormalEquations, Problem};
use crate::solver::{BranchedMatrix, LeastSquares, dot, half_squared};

/// Initial damping, relative to the scale of JᵀJ, its bounds, and its factors after success and failure.
const DAMPING: f64 = 1e-8;
const LEAST_DAMPING: f64 = 1e-10;
const MOST_DAMPING: f64 = 1.0;
/// Damping up to which a step is almost as long as without damping.
const LIGHT_DAMPING: f64 = 1e-7;
const AFTER_SUCCESS: f64 = 0.2;
const AFTER_FAILURE: f64 = 30.0;
/// Maximum number of active set changes per step.
const ROUNDS: usize = 8;
/// Maximum number of second-order corrections of a step before damping increases.
const CORRECTIONS: usize = 2;
/// Relative decrease of the cost below which the descent ends. It also ends if the model predicted the cost this
/// accurately, because the next step would gain no more than the prediction error.
const FLAT: f64 = 1e-4;

/// Scratch memory, and the current damping.
#[derive(Clone, Debug)]
pub(super) struct BoundedDescent {
    residual: Vec<f64>,
    trial_residual: Vec<f64>,
    equations: NormalEquations,
    /// Normal equations at the end of a rejected step.
    equations_there: NormalEquations,
    factor: BranchedMatrix,
    /// Product of JᵀJ and the step.
    curved: Vec<f64>,
    step: Vec<f64>,
    right: Vec<f64>,
    held: Vec<bool>,
    trial: Vec<f64>,
    damping: f64,
    /// Scale of the diagonal of JᵀJ, without stiff rows.
    size: f64,
}

impl BoundedDescent {
    /// Creates the memory for a problem. `size` is about the largest diagonal entry of JᵀJ without stiff rows.
    pub(super) fn new(problem: &Problem, size: f64) -> Self {
        let (rows, n) = (problem.rows(), problem.variables());
        let equations = NormalEquations::new(problem);
        Self {
            residual: vec![0.0; rows],
            trial_residual: vec![0.0; rows],
            factor: equations.matrix().clone(),
            equations_there: equations.clone(),
            equations,
            curved: vec![0.0; n],
            step: vec![0.0; n],
            right: vec![0.0; n],
            held: vec![false; n],
            trial: vec![0.0; n],
            damping: DAMPING,
            size,
        }
    }

    /// Residual r at the end of the last descent.
    pub(super) fn residual(&self) -> &[f64] {
        &self.residual
    }

    /// Descends from x, which must be within the bounds, in at most `steps` steps. Returns false and keeps x if a cost
    /// is not finite.
    pub(super) fn descend(
        &mut self,
        problem: &mut Evaluation<'_>,
        x: &mut [f64],
        steps: usize,
    ) -> bool {
        problem.residual(x, &mut self.residual);
        let mut cost = half_squared(&self.residual);
        for _ in 0..steps {
            if !cost.is_finite() {
                return false;
            }
            problem.normal_equations(x, &self.residual, &mut self.equations);
            let Some((lower, told)) = self.try_steps(problem, x, cost) else {
                break;
            };
            x.copy_from_slice(&self.trial);
            self.residual.copy_from_slice(&self.trial_residual);
            let won = cost - lower;
            cost = lower;
            let was_told = told.is_some_and(|told| (lower - told).abs() < FLAT * cost);
            if won < FLAT * cost || (was_told && self.damping <= LIGHT_DAMPING) {
                break;
            }
        }
        cost.is_finite()
    }

    /// Returns the cost after an accepted step and the cost that the model predicted, if it did. Returns `None` if no
    /// step decreases the cost.
    fn try_steps(
        &mut self,
        problem: &mut Evaluation<'_>,
        x: &[f64],
        cost: f64,
    ) -> Option<(f64, Option<f64>)> {
        let mut is_first = true;
        loop {
            let is_last = self.damping >= MOST_DAMPING;
            if self.solve(problem, x) {
                self.trial.copy_from_slice(x);
                self.step_on(problem);
                let told = cost + self.change_by_step();
                for correction in 0..=CORRECTIONS {
                    if correction > 0 {
                        self.correct(problem, x);
                    }
                    problem.residual(&self.trial, &mut self.trial_residual);
                    let trial_cost = half_squared(&self.trial_residual);
                    if trial_cost < cost {
                        self.damping = (AFTER_SUCCESS * self.damping).max(LEAST_DAMPING);
                        return Some((trial_cost, Some(told)));
                    }
                }
                if is_first || is_last {
                    if let Some(lower) = self.go_on(problem, x, cost) {
                        return Some((lower, None));
                    }
                }
            }
            is_first = false;
            if is_last {
                self.damping = DAMPING;
                return None;
            }
            self.damping = (AFTER_FAILURE * self.damping).min(MOST_DAMPING);
        }
    }

    /// Moves the trial by the step, within the bounds.
    fn step_on(&mut self, problem: &Evaluation<'_>) {
        let bounds = problem.lower().iter().zip(problem.upper());
        for ((trial, step), (lower, upper)) in self.trial.iter_mut().zip(&self.step).zip(bounds) {
            *trial = (*trial + step).max(*lower).min(*upper);
        }
    }

    /// Returns the cost after a second step from the end of the rejected one, if it is lower than at x. This is a
    /// watchdog (Chamberlain, Powell, Lemarechal & Pedersen 1982).
    ///
    /// The second step uses the model at its start. The model at x lacks residuals that act only there, such as the
    /// ground under a foot at its edge. It would repeat the rejected step.
    fn go_on(&mut self, problem: &mut Evaluation<'_>, x: &[f64], cost: f64) -> Option<f64> {
        self.trial.copy_from_slice(x);
        self.step_on(problem);
        problem.residual(&self.trial, &mut self.trial_residual);
        let there = &mut self.equations_there;
        problem.normal_equations(&self.trial, &self.trial_residual, there);
        let at = std::mem::take(&mut self.trial);
        std::mem::swap(&mut self.equations, &mut self.equations_there);
        let is_solved = self.solve(problem, &at);
        std::mem::swap(&mut self.equations, &mut self.equations_there);
        self.trial = at;
        self.step_on(problem);
        problem.residual(&self.trial, &mut self.trial_residual);
        let lower = half_squared(&self.trial_residual);
        (is_solved && lower < cost).then_some(lower)
    }

    /// Returns the change of the model's cost by the step.
    fn change_by_step(&mut self) -> f64 {
        self.equations
            .matrix()
            .multiply(&self.step, &mut self.curved);
        dot(self.equations.gradient(), &self.step) + 0.5 * dot(&self.curved, &self.step)
    }

    /// Corrects the trial with its own residual and the same model (second-order correction).
    ///
    /// Otherwise long steps along stiff rows would be rejected because of curvature (Maratos 1978; Nocedal & Wright
    /// 2006, "Numerical optimization", 18.3).
    fn correct(&mut self, problem: &mut Evaluation<'_>, x: &[f64]) {
        let mut no_memory = DMatrix::zeros(0, 0);
        problem.gradient(x, &self.trial_residual, &mut self.right, &mut no_memory);
        for (right, held) in self.right.iter_mut().zip(&self.held) {
            *right = if *held { 0.0 } else { -*right };
        }
        self.factor.solve(&mut self.right);
        let bounds = problem.lower().iter().zip(problem.upper());
        for ((trial, by), (lower, upper)) in self.trial.iter_mut().zip(&self.right).zip(bounds) {
            *trial = (*trial + by).max(*lower).min(*upper);
        }
    }

    /// Writes the step to the minimum of the damped model within the bounds. Returns false if the model has no minimum.
    fn solve(&mut self, problem: &Evaluation<'_>, x: &[f64]) -> bool {
        let n = x.len();
        let (lower, upper) = (problem.lower(), problem.upper());
        self.step.fill(0.0);
        // Variables at a bound stay there if the gradient pushes outward, until the step of the free variables pulls
        // them inward.
        for (k, held) in self.held.iter_mut().enumerate() {
            let slope = self.equations.gradient()[k];
            *held = (x[k] <= lower[k] && slope > 0.0) || (x[k] >= upper[k] && slope < 0.0);
        }
        for round in 0..ROUNDS {
            if !self.solve_free() {
                return false;
            }
            let mut beyond = round == 0 && self.let_go(x, lower);
            for k in 0..n {
                let (down, up) = (lower[k] - x[k], upper[k] - x[k]);
                if !self.held[k] && (self.step[k] < down || self.step[k] > up) {
                    self.step[k] = self.step[k].max(down).min(up);
                    (self.held[k], beyond) = (true, true);
                }
            }
            if !beyond {
                break;
            }
        }
        self.step.iter().all(|step| step.is_finite())
    }

    /// Releases fixed variables that are pulled inward. Returns whether there were any.
    fn let_go(&mut self, x: &[f64], lower: &[f64]) -> bool {
        if !self.held.contains(&true) {
            return false;
        }
        self.equations
            .matrix()
            .multiply(&self.step, &mut self.curved);
        let mut any = false;
        for (k, held) in self.held.iter_mut().enumerate().filter(|own| *own.1) {
            let slope = self.equations.gradient()[k] + self.curved[k];
            let inward = if x[k] <= lower[k] {
                slope < 0.0
            } else {
                slope > 0.0
            };
            if inward {
                (*held, any) = (false, true);
            }
        }
        any
    }

    /// Writes the step of the variables that are not fixed. Returns false if the model has no minimum.
    fn solve_free(&mut self) -> bool {
        for (right, slope) in self.right.iter_mut().zip(self.equations.gradient()) {
            *right = -slope;
        }
        let damping = self.damping * self.size;
        let held = (self.held.as_slice(), self.step.as_slice());
        let matrix = self.equations.matrix();
        self.factor
            .copy_free(matrix, damping, held, &mut self.right);
        if !self.factor.factorise() {
            return false;
        }
        self.factor.solve(&mut self.right);
        self.step.copy_from_slice(&self.right);
        true
    }
}
