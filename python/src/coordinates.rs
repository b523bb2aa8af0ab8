//! Names, limits and units of the numbers of a configuration.

use kinopt_bindings::coordinates;
use numpy::PyArray1;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arrays;
use crate::pickling;

/// Names, limits and units of the numbers of a configuration, in its order.
#[pyclass(frozen, eq, module = "kinopt")]
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Coordinates {
    /// Names: of the joints, with the component for a ball's quaternion, as in "hip w".
    #[pyo3(get)]
    pub(crate) names: Vec<String>,
    /// Units: "rad" or "m", "units" for an unknown unit of length, "" for the component of a quaternion.
    #[pyo3(get)]
    units: Vec<String>,
    /// Lower limits; JSON has no infinity.
    lower: Vec<Option<f64>>,
    upper: Vec<Option<f64>>,
}

impl Coordinates {
    /// Coordinates of a model.
    pub(crate) fn of_model(model: &kinopt::Model) -> Self {
        let joints = model.moving_joints().iter();
        Self::new(
            coordinates::names(model),
            joints.map(|&id| coordinates::unit(model, id)),
            model.limits().map(|limits| (limits.lower, limits.upper)),
        )
    }

    /// Coordinates of an arm of a model.
    pub(crate) fn of_arm(arm: &kinopt::Arm, model: &kinopt::Model) -> Self {
        let ids = arm.joint_ids().iter();
        Self::new(
            arm.joints().map(str::to_owned).collect(),
            ids.map(|&id| coordinates::unit(model, id)),
            arm.limits().map(|limits| (limits.lower, limits.upper)),
        )
    }

    /// Coordinates with names only.
    pub(crate) fn named(names: Vec<String>) -> Self {
        let count = names.len();
        let free = (f64::NEG_INFINITY, f64::INFINITY);
        Self::new(
            names,
            std::iter::repeat_n("", count),
            std::iter::repeat_n(free, count),
        )
    }

    fn new(
        names: Vec<String>,
        units: impl Iterator<Item = &'static str>,
        limits: impl Iterator<Item = (f64, f64)>,
    ) -> Self {
        let finite = |limit: f64| Some(limit).filter(|limit| limit.is_finite());
        let (lower, upper) = limits
            .map(|(lower, upper)| (finite(lower), finite(upper)))
            .unzip();
        Self {
            names,
            units: units.map(str::to_owned).collect(),
            lower,
            upper,
        }
    }
}

#[pymethods]
impl Coordinates {
    /// Lower limits, shape (nq,), radians or metres; -inf for none.
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let limits = self.lower.iter();
        arrays::frozen(py, limits.map(|limit| limit.unwrap_or(f64::NEG_INFINITY)))
    }

    /// Upper limits, shape (nq,), radians or metres; inf for none.
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let limits = self.upper.iter();
        arrays::frozen(py, limits.map(|limit| limit.unwrap_or(f64::INFINITY)))
    }

    fn __len__(&self) -> usize {
        self.names.len()
    }

    fn __repr__(&self) -> String {
        format!("Coordinates({})", self.names.join(", "))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_json::<Self>(py, self)
    }

    #[staticmethod]
    fn _rebuild(json: &str) -> PyResult<Self> {
        pickling::of_json(json)
    }
}
