//! Read-only shapes of links.

use kinopt_bindings::shape::{self, Measure};
use numpy::PyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::placement;

/// A shape of a link: a box, cylinder, capsule, sphere, ellipsoid or mesh; lengths in metres.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Shape {
    inner: kinopt::robot::GeometryObject,
}

impl Shape {
    pub(super) fn of(shape: &kinopt::robot::GeometryObject) -> Self {
        let inner = shape.clone();
        Self { inner }
    }
}

#[pymethods]
impl Shape {
    /// Name of the shape; None without one.
    #[getter]
    fn name(&self) -> Option<&str> {
        self.inner.name.as_deref()
    }

    /// Placement of the shape relative to the link, shape (4, 4).
    #[getter]
    fn link_from_shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        placement::to_array(py, &self.inner.link_from_shape)
    }

    /// "box", "cylinder", "capsule", "sphere", "ellipsoid" or "mesh".
    #[getter]
    fn kind(&self) -> &'static str {
        shape::kind(&self.inner.geometry)
    }

    /// Dimensions by name. A box has `size` (full lengths along x, y, z). A cylinder and a capsule have `radius` and
    /// `length` (along z; for a capsule without its caps). A sphere has `radius`, an ellipsoid `radii`, a mesh `file`
    /// (as written in the robot's file) and `scale`.
    #[getter]
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let measures = PyDict::new(py);
        for (name, measure) in shape::measures(&self.inner.geometry) {
            match measure {
                Measure::Number(number) => measures.set_item(name, number)?,
                Measure::Numbers(numbers) => measures.set_item(name, numbers)?,
                Measure::Text(text) => measures.set_item(name, text)?,
            }
        }
        Ok(measures)
    }

    fn __repr__(&self) -> String {
        format!(
            "Shape({}, {:?})",
            self.kind(),
            self.inner.name.as_deref().unwrap_or("")
        )
    }
}
