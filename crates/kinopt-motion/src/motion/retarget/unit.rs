//! Scaling of models without a known unit of length.
//!
//! Tolerances, weights and steps of retargeting are in metres for a body of human size. A rig has no unit of length. A
//! model in [`LengthUnit::Own`] is therefore scaled to human leg length, solved, and the result scaled back.

use std::borrow::Cow;

use super::limbs::Limbs;
use super::{BodyMap, FootShapes, RetargetError};
use crate::motion::contact::NOMINAL_LEG_LENGTH_M;
use kinopt_kinematics::model::{LengthUnit, Model};
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::Placement;
use kinopt_robot::robot::Robot;
use kinopt_solver::problem::{ClearanceCheck, Collision, CollisionAvoidance};
use kinopt_solver::task::{
    Description, Extensions, Inequality, InequalityResidual, Inputs, Quantity, Residual, RowBlock,
    Task,
};

/// Ratio of lengths of the solved body to lengths of the model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit(f64);

impl Unit {
    /// Returns the ratio for a model with these limbs.
    pub(super) fn of(model: &Model, limbs: &Limbs) -> Self {
        let [model_length, solved] = match limbs.leg > 0.0 {
            true => [limbs.leg, NOMINAL_LEG_LENGTH_M],
            false => [model.reach(), 1.0],
        };
        match model.length_unit() {
            LengthUnit::Own if model_length > 0.0 && model_length.is_finite() => {
                Self(solved / model_length)
            }
            _ => Self(1.0),
        }
    }

    /// True if the model is solved at its own size.
    pub(super) fn is_identity(self) -> bool {
        self.0 == 1.0
    }

    /// Factor from the model's unit to the unit of the solved body.
    pub(super) fn scale(self) -> f64 {
        self.0
    }

    /// Factor from the unit of the solved body to the model's unit.
    pub(super) fn inverse_scale(self) -> f64 {
        1.0 / self.0
    }

    /// Returns the solved robot.
    pub(super) fn body(self, robot: &Robot) -> Result<Cow<'_, Robot>, RetargetError> {
        Ok(match self.is_identity() {
            true => Cow::Borrowed(robot),
            false => Cow::Owned(robot.scaled(self.0)?),
        })
    }

    /// Returns the map and the foot shapes of the solved body.
    pub(super) fn map_and_shapes(
        self,
        map: &BodyMap,
        shapes: &FootShapes,
    ) -> (BodyMap, FootShapes) {
        let (mut map, mut shapes) = (map.clone(), shapes.clone());
        for drive in &mut map.drives {
            drive.offset = drive.offset * self.0;
        }
        for ball in &mut shapes.balls {
            ball.at = ball.at * self.0;
            ball.radius *= self.0;
        }
        (map, shapes)
    }
}

/// Collision avoidance of the solved body, from that of the model.
#[derive(Clone, Debug)]
pub(super) struct ScaledObstacles<C> {
    inner: C,
    unit: Unit,
    model: Model,
}

impl<C> ScaledObstacles<C> {
    /// Wraps a checker. `model` is that of the checker.
    pub(super) fn new(inner: C, unit: Unit, model: &Model) -> Self {
        let model = model.clone();
        Self { inner, unit, model }
    }
}

impl<C: CollisionAvoidance> CollisionAvoidance for ScaledObstacles<C> {
    type Clearance = ScaledClearance<C::Clearance>;
    type Check = ScaledCheck<C::Check>;

    fn configuration_len(&self) -> usize {
        self.inner.configuration_len()
    }

    fn clearance(&self) -> Task<Self::Clearance> {
        let task = self.inner.clearance();
        let mut tolerances = task.tolerances;
        for (quantity, tolerance) in &mut tolerances {
            if *quantity == Quantity::Metres {
                *tolerance *= self.unit.scale();
            }
        }
        Task {
            residual: ScaledClearance {
                inner: task.residual,
                unit: self.unit,
            },
            name: task.name,
            weights: task.weights,
            factor: task.factor,
            tolerances,
            role: task.role,
            level: task.level,
        }
    }

    fn check(&self) -> Self::Check {
        ScaledCheck {
            inner: self.inner.check(),
            unit: self.unit,
            model: self.model.clone(),
        }
    }
}

/// Clearance in the unit of the solved body.
#[derive(Clone, Debug)]
pub(super) struct ScaledClearance<R> {
    inner: R,
    unit: Unit,
}

impl<R> ScaledClearance<R> {
    fn to_model_unit<S: Scalar>(&self, frames: &[Placement<S>]) -> Vec<Placement<S>> {
        let inverse_scale = S::constant(self.unit.inverse_scale());
        let placements = frames.iter().map(|frame| {
            let translation = frame.translation * inverse_scale;
            Placement::new(frame.rotation, translation)
        });
        placements.collect()
    }
}

impl<R: InequalityResidual> Residual for ScaledClearance<R> {
    const EXTENSIONS: Extensions<Self> = Extensions::NONE.with_inequalities();

    fn inputs(&self) -> Inputs {
        self.inner.inputs()
    }

    fn rows(&self) -> Vec<RowBlock> {
        self.inner.rows()
    }

    fn evaluate<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], residual: &mut [S]) {
        self.inner
            .evaluate(&self.to_model_unit(frames), joints, residual);
        let scale = S::constant(self.unit.scale());
        residual.iter_mut().for_each(|row| *row *= scale);
    }

    fn description(&self) -> Description {
        self.inner.description()
    }
}

impl<R: InequalityResidual> InequalityResidual for ScaledClearance<R> {
    fn inequalities(&self) -> Vec<Inequality> {
        self.inner.inequalities()
    }

    fn slacks<S: Scalar>(&self, frames: &[Placement<S>], joints: &[S], slacks: &mut [S]) {
        self.inner
            .slacks(&self.to_model_unit(frames), joints, slacks);
        let scale = S::constant(self.unit.scale());
        slacks.iter_mut().for_each(|row| *row *= scale);
    }
}

/// Collision check of configurations of the solved body.
#[derive(Clone, Debug)]
pub(super) struct ScaledCheck<C> {
    inner: C,
    unit: Unit,
    model: Model,
}

impl<C> ScaledCheck<C> {
    fn to_model_unit(&self, q: &[f64]) -> Vec<f64> {
        let mut scaled = q.to_vec();
        self.model
            .scale_slides(self.unit.inverse_scale(), &mut scaled);
        scaled
    }
}

impl<C: ClearanceCheck> ClearanceCheck for ScaledCheck<C> {
    fn collisions(&mut self, q: &[f64]) -> Vec<Collision> {
        self.inner.collisions(&self.to_model_unit(q))
    }

    fn is_free(&mut self, q: &[f64]) -> bool {
        self.inner.is_free(&self.to_model_unit(q))
    }

    fn blocked(&mut self, from: &[f64], to: &[f64]) -> Option<Collision> {
        let [from, to] = [self.to_model_unit(from), self.to_model_unit(to)];
        self.inner.blocked(&from, &to)
    }

    fn free_share(&mut self, from: &[f64], to: &[f64]) -> f64 {
        let [from, to] = [self.to_model_unit(from), self.to_model_unit(to)];
        self.inner.free_share(&from, &to)
    }
}
