//! Collision checks of the steps of a search.

use nalgebra::DMatrix;

use crate::model::ParameterMap;
use crate::problem::{AnyClearanceCheck, Evaluation};
use crate::solver::{ConfigurationSpace, LeastSquares};

/// Factor by which a colliding step is shortened.
const SHORTENING_FACTOR: f64 = 0.5;
/// Maximum number of shortened steps.
const MAX_SHORTENINGS: usize = 5;

/// Limit of the steps of a search.
pub(crate) trait StepGuard {
    /// Returns the fraction in [0, 1] of the step from `x` to `to` that is allowed.
    fn allowed_share(&mut self, space: ConfigurationSpace<'_>, x: &[f64], to: &[f64]) -> f64;
}

/// Reborrows an optional guard.
pub(super) fn reborrowed<'b>(
    guard: &'b mut Option<&mut dyn StepGuard>,
) -> Option<&'b mut dyn StepGuard> {
    match guard {
        Some(guard) => Some(&mut **guard),
        None => None,
    }
}

/// Guard that keeps the linear joint-space motion from one configuration to the search point collision-free.
///
/// A frame of a drag moves along that motion, independent of the steps of its search.
#[derive(Debug)]
pub(crate) struct MotionGuard<'a> {
    pub(crate) check: &'a mut dyn AnyClearanceCheck,
    pub(crate) map: &'a ParameterMap,
    /// Start of the motion, as a configuration and as variables.
    pub(crate) from: (&'a [f64], &'a [f64]),
    /// Buffer of the checked configuration.
    pub(crate) q: &'a mut Vec<f64>,
}

impl StepGuard for MotionGuard<'_> {
    fn allowed_share(&mut self, space: ConfigurationSpace<'_>, x: &[f64], to: &[f64]) -> f64 {
        let (q_from, x_from) = self.from;
        self.q.resize(q_from.len(), 0.0);
        self.map.scatter_within_limits(to, self.q);
        if self.check.blocked(q_from, self.q).is_none() {
            return 1.0;
        }
        if x == x_from {
            return self.check.free_share(q_from, self.q);
        }
        let mut step = vec![0.0; x.len()];
        let mut trial = x.to_vec();
        space.difference(to, x, &mut step);
        let mut fraction = 1.0;
        for _ in 0..MAX_SHORTENINGS {
            fraction *= SHORTENING_FACTOR;
            space.integrate_share(x, fraction, &step, &mut trial);
            space.project(&mut trial);
            self.map.scatter_within_limits(&trial, self.q);
            if self.check.blocked(q_from, self.q).is_none() {
                return fraction;
            }
        }
        0.0
    }
}

/// Least-squares problem with guarded steps.
pub(super) struct Guarded<'a, 'q> {
    pub(super) evaluation: &'a mut Evaluation<'q>,
    pub(super) guard: &'a mut dyn StepGuard,
}

impl LeastSquares for Guarded<'_, '_> {
    fn variables(&self) -> usize {
        self.evaluation.variables()
    }

    fn rows(&self) -> usize {
        self.evaluation.rows()
    }

    fn lower(&self) -> &[f64] {
        self.evaluation.lower()
    }

    fn upper(&self) -> &[f64] {
        self.evaluation.upper()
    }

    fn step_scale(&self) -> &[f64] {
        self.evaluation.step_scale()
    }

    fn space(&self) -> ConfigurationSpace<'_> {
        self.evaluation.space()
    }

    fn is_reached(&self, residual: &[f64]) -> bool {
        self.evaluation.is_reached(residual)
    }

    fn stops_when_reached(&self) -> bool {
        self.evaluation.stops_when_reached()
    }

    fn residual(&mut self, x: &[f64], residual: &mut [f64]) {
        self.evaluation.residual(x, residual);
    }

    fn jacobian(&mut self, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.evaluation.jacobian(x, jacobian);
    }

    fn gradient(
        &mut self,
        x: &[f64],
        residual: &[f64],
        gradient: &mut [f64],
        jacobian: &mut DMatrix<f64>,
    ) {
        self.evaluation.gradient(x, residual, gradient, jacobian);
    }

    fn allowed_share(&mut self, from: &[f64], to: &[f64]) -> f64 {
        self.guard.allowed_share(self.evaluation.space(), from, to)
    }
}
