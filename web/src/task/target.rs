//! Targets of tasks: conversion from JavaScript, and assignment to residuals.

use kinopt::ik::Drag;
use kinopt::problem::{ProblemError, Targets, TaskId};
#[cfg(feature = "bodies")]
use kinopt::task::{
    Bounded, CentreOfMass, FrameVelocity, JointCoupling, Manipulability, SupportPolygon,
};
use kinopt::task::{
    Distance, Gaze, LimitCentring, LookAt, Orientation, Pixel, Plane, Point, Pose, Posture, Ray,
    Residual, Smoothness,
};
use wasm_bindgen::prelude::*;

use crate::{arguments, placement, raise};

/// Object whose targets move.
pub(crate) enum Aimed<'a> {
    Targets(&'a mut Targets),
    Drag(&'a mut Drag),
}

impl Aimed<'_> {
    fn residual<R: Residual>(&mut self, task: TaskId<R>) -> Result<&mut R, ProblemError> {
        match self {
            Self::Targets(targets) => targets.get_mut(task),
            Self::Drag(drag) => drag.target_mut(task),
        }
    }
}

/// A task of a problem.
pub(crate) trait AimableTask {
    /// Moves its target; `what` names it in messages. Numbers that are not finite and matrices that are not rotations
    /// leave it unchanged.
    fn aim(&self, aimed: &mut Aimed<'_>, value: &JsValue, what: &str) -> Result<(), JsError>;
}

impl<R: Target> AimableTask for TaskId<R> {
    fn aim(&self, aimed: &mut Aimed<'_>, value: &JsValue, what: &str) -> Result<(), JsError> {
        let current = aimed.residual(*self).map_err(raise)?;
        let mut moved = current.clone();
        moved.aim(value, what)?;
        let checked = moved.validate();
        checked.map_err(|error| JsError::new(&format!("{what}: {error}")))?;
        *current = moved;
        Ok(())
    }
}

/// A residual whose target JavaScript can move.
pub(crate) trait Target: Residual {
    /// Moves the target.
    fn aim(&mut self, value: &JsValue, what: &str) -> Result<(), JsError>;
}

/// Implements targets by a conversion function and a setter.
macro_rules! targets {
    ($($residual:ty, $read:path, |$task:ident, $target:pat_param| $set:expr;)*) => {$(
        impl Target for $residual {
            fn aim(&mut self, value: &JsValue, what: &str) -> Result<(), JsError> {
                let $task = self;
                let $target = $read(value, what)?;
                $set;
                Ok(())
            }
        }
    )*};
}

targets! {
    Point, arguments::vector::<3>, |task, target| task.set_target(target);
    Pose, placement::of, |task, target| task.set_target(target);
    Orientation, placement::of, |task, target| task.set_target(target.rotation);
    LookAt, arguments::vector::<3>, |task, target| task.set_target(target);
    Distance, arguments::number, |task, distance| task.set_distance(distance);
    Plane, two, |task, [point, normal]| task.set_plane(point, normal);
    Ray, two, |task, [eye, through]| task.set_line(eye, through);
    Pixel, arguments::vector::<2>, |task, pixel| task.set_target(pixel);
    Gaze, arguments::vector::<3>, |task, target| task.set_target(target);
}

#[cfg(feature = "bodies")]
targets! {
    CentreOfMass, arguments::vector::<3>, |task, target| task.set_target(target);
    FrameVelocity, placement::of, |task, previous| task.set_previous(previous);
    JointCoupling, arguments::number, |task, offset| task.set_offset(offset);
    Manipulability, arguments::number, |task, least| task.set_least(least);
}

/// Reads two positions in one list.
fn two(value: &JsValue, what: &str) -> Result<[[f64; 3]; 2], JsError> {
    let [a, b, c, d, e, f] = arguments::vector::<6>(value, what)?;
    Ok([[a, b, c], [d, e, f]])
}

/// Implements residuals without a target.
macro_rules! untargeted {
    ($($residual:ty),*) => {$(
        impl Target for $residual {
            fn aim(&mut self, _value: &JsValue, what: &str) -> Result<(), JsError> {
                Err(JsError::new(&format!("{what}: this task has no target")))
            }
        }
    )*};
}

untargeted!(LimitCentring);
#[cfg(feature = "bodies")]
untargeted!(SupportPolygon);

/// Error for an array of another length than the task's joints.
fn other_count(what: &str, error: &kinopt::SizeMismatch) -> JsError {
    let (count, expected) = (error.given, error.expected);
    JsError::new(&format!("{what} has {count} numbers, expected {expected}"))
}

impl Target for Posture {
    fn aim(&mut self, value: &JsValue, what: &str) -> Result<(), JsError> {
        let set = self.set_reference(&arguments::numbers(value, what)?);
        set.map_err(|error| other_count(what, &error))
    }
}

impl Target for Smoothness {
    fn aim(&mut self, value: &JsValue, what: &str) -> Result<(), JsError> {
        let set = self.set_previous(&arguments::numbers(value, what)?);
        set.map_err(|error| other_count(what, &error))
    }
}

#[cfg(feature = "bodies")]
impl<R: Target> Target for Bounded<R> {
    fn aim(&mut self, value: &JsValue, what: &str) -> Result<(), JsError> {
        self.residual_mut().aim(value, what)
    }
}
