//! The targets of tasks: what each kind takes for one, and how it is moved there.

use kinopt::spatial::{Matrix3, Placement};
use kinopt::task::{
    Distance, LimitCentring, LookAt, Numeric, Orientation, Pixel, Plane, Point, Pose, Posture, Ray,
    Residual, Smoothness, Within,
};
use pyo3::prelude::*;

use super::python_residual::PythonResidual;
use crate::arrays;
use crate::error::invalid;
use crate::placement;

/// A residual whose target Python can move.
pub(crate) trait Target: Residual {
    /// The target, without Python.
    type Value: Send + Sync;

    /// Reads a target, of which messages speak as `what`.
    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Self::Value>;

    /// Moves the target, or says what is wrong in words that follow its name.
    fn aim(&mut self, target: &Self::Value) -> Result<(), String>;
}

impl Target for Point {
    type Value = [f64; 3];

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<[f64; 3]> {
        arrays::array(value, what)
    }

    fn aim(&mut self, target: &[f64; 3]) -> Result<(), String> {
        self.set_target(*target);
        Ok(())
    }
}

impl Target for Pose {
    type Value = Placement<f64>;

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Placement<f64>> {
        placement::placement(value, what)
    }

    fn aim(&mut self, target: &Placement<f64>) -> Result<(), String> {
        self.set_target(*target);
        Ok(())
    }
}

impl Target for Orientation {
    type Value = Matrix3<f64>;

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Matrix3<f64>> {
        placement::rotation(value, what)
    }

    fn aim(&mut self, target: &Matrix3<f64>) -> Result<(), String> {
        self.set_target(*target);
        Ok(())
    }
}

impl Target for LookAt {
    type Value = [f64; 3];

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<[f64; 3]> {
        arrays::array(value, what)
    }

    fn aim(&mut self, target: &[f64; 3]) -> Result<(), String> {
        self.set_target(*target);
        Ok(())
    }
}

impl Target for Distance {
    type Value = f64;

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<f64> {
        arrays::number(value, what)
    }

    fn aim(&mut self, distance: &f64) -> Result<(), String> {
        self.set_distance(*distance);
        Ok(())
    }
}

impl Target for Plane {
    type Value = [[f64; 3]; 2];

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<[[f64; 3]; 2]> {
        arrays::table(value, what)
    }

    fn aim(&mut self, [point, normal]: &[[f64; 3]; 2]) -> Result<(), String> {
        self.set_plane(*point, *normal);
        Ok(())
    }
}

impl Target for Ray {
    type Value = [[f64; 3]; 2];

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<[[f64; 3]; 2]> {
        arrays::table(value, what)
    }

    fn aim(&mut self, [eye, through]: &[[f64; 3]; 2]) -> Result<(), String> {
        self.set_line(*eye, *through);
        Ok(())
    }
}

impl Target for Pixel {
    type Value = [f64; 2];

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<[f64; 2]> {
        arrays::array(value, what)
    }

    fn aim(&mut self, pixel: &[f64; 2]) -> Result<(), String> {
        self.set_target(*pixel);
        Ok(())
    }
}

/// A value for each joint, none missing.
fn of_joints(joints: usize, given: &[f64]) -> Result<(), String> {
    match given.len() == joints {
        true => Ok(()),
        false => Err(format!(
            "has shape ({},), expected ({joints},)",
            given.len()
        )),
    }
}

impl Target for Posture {
    type Value = Vec<f64>;

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f64>> {
        Ok(arrays::vector(value, what)?.to_vec())
    }

    fn aim(&mut self, reference: &Vec<f64>) -> Result<(), String> {
        of_joints(self.joints().len(), reference)?;
        self.set_reference(reference);
        Ok(())
    }
}

impl Target for Smoothness {
    type Value = Vec<f64>;

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f64>> {
        Ok(arrays::vector(value, what)?.to_vec())
    }

    fn aim(&mut self, previous: &Vec<f64>) -> Result<(), String> {
        of_joints(self.joints().len(), previous)?;
        self.set_previous(previous);
        Ok(())
    }
}

impl Target for LimitCentring {
    type Value = ();

    fn read(_value: &Bound<'_, PyAny>, what: &str) -> PyResult<()> {
        Err(invalid(format!("{what}: limit centring has no target")))
    }

    fn aim(&mut self, _target: &()) -> Result<(), String> {
        Ok(())
    }
}

impl Target for Numeric<PythonResidual> {
    type Value = Py<PyAny>;

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Py<PyAny>> {
        match value.is_callable() {
            true => Ok(value.clone().unbind()),
            false => Err(invalid(format!(
                "{what} must be a function: the target of a residual in Python is its own affair"
            ))),
        }
    }

    fn aim(&mut self, function: &Py<PyAny>) -> Result<(), String> {
        self.0 = self.0.with_function(function);
        Ok(())
    }
}

impl<R: Target> Target for Within<R> {
    type Value = R::Value;

    fn read(value: &Bound<'_, PyAny>, what: &str) -> PyResult<R::Value> {
        R::read(value, what)
    }

    fn aim(&mut self, target: &R::Value) -> Result<(), String> {
        self.residual_mut().aim(target)
    }
}
