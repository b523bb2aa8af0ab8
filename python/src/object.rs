//! Python objects as values and named arguments of `kinopt-bindings`.

use std::time::Duration;

use kinopt::SizeMismatch;
use kinopt::spatial::{Matrix3, Placement, Vector3};
use kinopt_bindings::names::quantity;
use kinopt_bindings::placement::PoseTarget;
use kinopt_bindings::{Arguments, ErrorKind, QuantityValues, Value};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping};

use crate::arrays;
use crate::error::{OrRaise, invalid, raise};
use crate::goal::pose_bounds;
use crate::placement;
use crate::problem::Camera;

/// A Python object.
pub(crate) struct Object(pub(crate) Py<PyAny>);

impl Object {
    pub(crate) fn of(value: &Bound<'_, PyAny>) -> Self {
        Self(value.clone().unbind())
    }

    /// Calls a function with the object.
    pub(crate) fn with<T>(&self, read: impl FnOnce(&Bound<'_, PyAny>) -> T) -> T {
        Python::attach(|py| read(self.0.bind(py)))
    }
}

impl Value for Object {
    type Error = PyErr;

    fn error(kind: ErrorKind, message: String) -> PyErr {
        raise(kind, message)
    }

    fn label(name: &str) -> String {
        match name {
            "time_step" => "time_step_s".to_owned(),
            _ => name.to_owned(),
        }
    }

    fn wrong_length(what: &str, mismatch: &SizeMismatch) -> PyErr {
        let SizeMismatch {
            given, expected, ..
        } = mismatch;
        invalid(format!(
            "{what} has shape ({given},), expected ({expected},)"
        ))
    }

    fn no_target(what: &str, task: &str) -> PyErr {
        invalid(format!("{what}: {task} has no target"))
    }

    fn is_missing(&self) -> bool {
        self.with(|value| value.is_none())
    }

    fn as_text(&self) -> Option<String> {
        self.with(|value| value.extract().ok())
    }

    fn as_number(&self) -> Option<f64> {
        self.with(|value| {
            let is_scalar = arrays::axes(value).is_ok_and(|axes| axes == 0);
            value.extract().ok().filter(|_| is_scalar)
        })
    }

    fn is_map(&self) -> bool {
        self.with(|value| value.cast::<PyMapping>().is_ok())
    }

    fn number(&self, what: &str) -> PyResult<f64> {
        self.with(|value| arrays::number(value, what))
    }

    fn whole(&self, what: &str, max: u64) -> PyResult<u64> {
        self.with(|value| {
            let number = value.extract().ok().filter(|number| *number <= max);
            number.ok_or_else(|| {
                invalid(format!(
                    "{what} must be a whole number of at least 0, not {value}"
                ))
            })
        })
    }

    fn switch(&self, what: &str) -> PyResult<bool> {
        self.with(|value| {
            let switch = value.extract();
            switch.map_err(|_| invalid(format!("{what} must be True or False, not {value}")))
        })
    }

    fn time_limit(&self, what: &str) -> PyResult<Duration> {
        let seconds = self.number(what)?;
        Duration::try_from_secs_f64(seconds).map_err(|_| {
            invalid(format!(
                "{what} is {seconds} s, allowed: a finite number of at least 0"
            ))
        })
    }

    fn name(&self, what: &str) -> PyResult<String> {
        self.with(|value| arrays::name(value, what))
    }

    fn word(&self, _what: &str) -> PyResult<String> {
        self.with(|value| Ok(value.str()?.to_string()))
    }

    fn names(&self, what: &str) -> PyResult<Vec<String>> {
        let names = self.with(|value| value.extract());
        names.map_err(|_| invalid(format!("{what} must be a list of names of joints")))
    }

    fn numbers(&self, what: &str) -> PyResult<Vec<f64>> {
        self.with(|value| Ok(arrays::vector(value, what)?.to_vec()))
    }

    fn vector(&self, what: &str, length: usize) -> PyResult<Vec<f64>> {
        self.with(|value| Ok(arrays::vector_of(value, what, length)?.to_vec()))
    }

    fn two_points(&self, what: &str) -> PyResult<[[f64; 3]; 2]> {
        self.with(|value| arrays::table(value, what))
    }

    fn points(&self, what: &str) -> PyResult<Vec<Vector3<f64>>> {
        self.with(|value| {
            let rows = arrays::rows(value, what, 3)?;
            let points = rows.chunks_exact(3).map(|p| Vector3::new(p[0], p[1], p[2]));
            Ok(points.collect())
        })
    }

    fn placement(&self, what: &str) -> PyResult<Placement<f64>> {
        self.with(|value| placement::placement(value, what))
    }

    fn pose_target(&self, what: &str) -> PyResult<PoseTarget> {
        self.with(|value| placement::pose_target(value, what))
    }

    fn rotation(&self, what: &str) -> PyResult<Matrix3<f64>> {
        self.with(|value| placement::rotation(value, what))
    }

    fn pose_bounds(&self, what: &str) -> PyResult<kinopt::task::PoseBounds> {
        self.with(|value| pose_bounds(value, what))
    }

    fn camera(&self, _what: &str) -> PyResult<kinopt::task::Camera> {
        self.with(|value| Ok(value.cast::<Camera>()?.get().inner))
    }

    fn mass(&self, _what: &str) -> PyResult<(f64, [f64; 3])> {
        self.with(|value| {
            let (mass, at): (f64, Bound<'_, PyAny>) = value.extract()?;
            Ok((mass, arrays::array(&at, "where a mass is")?))
        })
    }

    fn entries(&self, what: &str) -> PyResult<Vec<(String, Self)>> {
        self.with(|value| {
            let entries = arrays::items(Some(value), what)?.into_iter();
            let keys = format!("a key of {what}");
            entries
                .map(|(key, value)| Ok((arrays::name(&key, &keys)?, Self::of(&value))))
                .collect()
        })
    }

    fn numbers_by_name(&self, what: &str, keys: &str) -> PyResult<Vec<(String, f64)>> {
        self.with(|value| {
            let entries = arrays::items(Some(value), what);
            let entries =
                entries.map_err(|_| invalid(format!("{what} must be a dict {{joint: value}}")))?;
            let read = |(key, value): (Bound<'_, PyAny>, Bound<'_, PyAny>)| {
                let key = arrays::name(&key, keys)?;
                let value = arrays::number(&value, &format!("{what}[{key:?}]"))?;
                Ok((key, value))
            };
            entries.into_iter().map(read).collect()
        })
    }

    fn quantity_values(&self, what: &str) -> PyResult<QuantityValues> {
        self.with(|value| quantity_values(value, what))
    }
}

/// Reads a number for all quantities, or a dict of numbers by quantity.
pub(crate) fn quantity_values(value: &Bound<'_, PyAny>, what: &str) -> PyResult<QuantityValues> {
    if value.is_none() {
        return Ok(QuantityValues::Each(Vec::new()));
    }
    if let Ok(number) = value.extract() {
        return Ok(QuantityValues::All(number));
    }
    let Ok(mapping) = value.cast::<PyMapping>() else {
        return Err(invalid(format!(
            "{what} must be a number, or a dict of numbers by quantity, such as {{\"metres\": 1.0}}"
        )));
    };
    let mut each = Vec::new();
    for item in mapping.items()?.iter() {
        let (name, number): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
        let name = arrays::name(&name, &format!("a quantity of {what}"))?;
        let number = arrays::number(&number, &format!("{what} per {name}"))?;
        each.push((quantity(&name).or_raise()?, number));
    }
    Ok(QuantityValues::Each(each))
}

/// Keywords of a call.
pub(crate) struct Options<'a, 'py>(pub(crate) &'a Bound<'py, PyDict>);

impl Arguments for Options<'_, '_> {
    type Value = Object;

    fn get(&self, name: &str) -> PyResult<Option<Object>> {
        let value = self.0.get_item(name)?;
        Ok(value
            .filter(|value| !value.is_none())
            .map(|value| Object::of(&value)))
    }

    fn required(&self, name: &str) -> PyResult<Object> {
        let missing = || invalid(format!("option `{name}` is missing"));
        self.get(name)?.ok_or_else(missing)
    }
}

/// Fields of a task of `kinopt.tasks`.
pub(crate) struct Fields<'a, 'py>(pub(crate) &'a Bound<'py, PyAny>);

impl Arguments for Fields<'_, '_> {
    type Value = Object;

    fn get(&self, name: &str) -> PyResult<Option<Object>> {
        let value = self.required(name)?;
        Ok(Some(value).filter(|value| !value.is_missing()))
    }

    fn required(&self, name: &str) -> PyResult<Object> {
        match self.0.getattr_opt(Object::label(name))? {
            Some(value) => Ok(Object::of(&value)),
            None => Err(no_task(self.0)?),
        }
    }
}

/// Error for an object that is no task.
pub(crate) fn no_task(object: &Bound<'_, PyAny>) -> PyResult<PyErr> {
    Ok(invalid(format!(
        "tasks holds {}, which is no task of kinopt.tasks",
        object.repr()?
    )))
}
