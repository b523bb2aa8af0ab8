//! Targets of tasks: conversion from Python, and assignment to residuals.

use kinopt::spatial::{Matrix3, Placement};
use kinopt::task::{
    Bounded, CentreOfMass, Distance, FrameVelocity, Gaze, JointCoupling, LimitCentring, LookAt,
    Manipulability, Numeric, Orientation, Pixel, Plane, Point, Pose, Posture, Ray, Residual,
    Smoothness, SupportPolygon,
};
use pyo3::prelude::*;

use super::python_residual::PythonResidual;
use crate::arrays;
use crate::error::invalid;
use crate::placement;

/// A residual with a target that Python can move.
pub(crate) trait Target: Residual {
    /// Target in Rust form.
    type Value: Send + Sync;

    /// Converts a target; `what` names it in messages.
    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Self::Value>;

    /// Sets the target. The error text continues a sentence that begins with the target's name.
    fn aim(&mut self, target: &Self::Value) -> Result<(), String>;
}

/// Implements targets by a conversion function and a setter.
macro_rules! targets {
    ($($residual:ty, $value:ty, $read:path, |$task:ident, $target:pat_param| $set:expr;)*) => {$(
        impl Target for $residual {
            type Value = $value;

            fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<$value> {
                $read(value, what)
            }

            fn aim(&mut self, $target: &$value) -> Result<(), String> {
                let $task = self;
                $set;
                Ok(())
            }
        }
    )*};
}

targets! {
    Point, [f64; 3], arrays::array, |task, target| task.set_target(*target);
    Pose, Placement<f64>, placement::placement, |task, target| task.set_target(*target);
    Orientation, Matrix3<f64>, placement::rotation, |task, target| task.set_target(*target);
    LookAt, [f64; 3], arrays::array, |task, target| task.set_target(*target);
    Distance, f64, arrays::number, |task, distance| task.set_distance(*distance);
    Plane, [[f64; 3]; 2], arrays::table, |task, [point, normal]| task.set_plane(*point, *normal);
    Ray, [[f64; 3]; 2], arrays::table, |task, [eye, through]| task.set_line(*eye, *through);
    Pixel, [f64; 2], arrays::array, |task, pixel| task.set_target(*pixel);
    CentreOfMass, [f64; 3], arrays::array, |task, target| task.set_target(*target);
    Gaze, [f64; 3], arrays::array, |task, target| task.set_target(*target);
    FrameVelocity, Placement<f64>, placement::placement, |task, previous| task.set_previous(*previous);
    JointCoupling, f64, arrays::number, |task, offset| task.set_offset(*offset);
    Manipulability, f64, arrays::number, |task, least| task.set_least(*least);
}

/// Error text for an array of another length than the task's joints.
fn other_shape(error: kinopt::SizeMismatch) -> String {
    let (given, expected) = (error.given, error.expected);
    format!("has shape ({given},), expected ({expected},)")
}

impl Target for Posture {
    type Value = Vec<f64>;

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f64>> {
        Ok(arrays::vector(value, what)?.to_vec())
    }

    fn aim(&mut self, reference: &Vec<f64>) -> Result<(), String> {
        self.set_reference(reference).map_err(other_shape)
    }
}

impl Target for Smoothness {
    type Value = Vec<f64>;

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f64>> {
        Ok(arrays::vector(value, what)?.to_vec())
    }

    fn aim(&mut self, previous: &Vec<f64>) -> Result<(), String> {
        self.set_previous(previous).map_err(other_shape)
    }
}

/// Implements residuals without a target.
macro_rules! untargeted {
    ($($residual:ty, $what:literal;)*) => {$(
        impl Target for $residual {
            type Value = ();

            fn read(_value: &Bound<'_, PyAny>, what: &str) -> PyResult<()> {
                Err(invalid(format!("{what}: {} has no target", $what)))
            }

            fn aim(&mut self, _target: &()) -> Result<(), String> {
                Ok(())
            }
        }
    )*};
}

untargeted! {
    LimitCentring, "limit centring";
    SupportPolygon, "a support polygon";
}

impl Target for Numeric<PythonResidual> {
    type Value = Py<PyAny>;

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Py<PyAny>> {
        match value.is_callable() {
            true => Ok(value.clone().unbind()),
            false => Err(invalid(format!(
                "{what} must be a function, which replaces that of the residual"
            ))),
        }
    }

    fn aim(&mut self, function: &Py<PyAny>) -> Result<(), String> {
        self.0 = self.0.with_function(function);
        Ok(())
    }
}

impl<R: Target> Target for Bounded<R> {
    type Value = R::Value;

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<R::Value> {
        R::read(value, what)
    }

    fn aim(&mut self, target: &R::Value) -> Result<(), String> {
        self.residual_mut().aim(target)
    }
}
