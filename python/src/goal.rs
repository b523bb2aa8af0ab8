//! Goal bounds: components of a pose that are constrained.

use kinopt_bindings::names::{self, AXES, named};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple, PyType};

use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::pickling;

/// Allowed offset of a frame's pose from its target, for each component, along the target's axes. Tolerances are added
/// to it.
///
/// Created by `PoseBounds.pose()`, `PoseBounds.position()`, `PoseBounds.free_about("z")`, `PoseBounds.free_along("x")`
/// or `PoseBounds.within(half_widths)`. Raises `InvalidValueError`, which lists these, if it is called itself.
#[pyclass(frozen, eq, module = "kinopt")]
#[derive(Clone, Copy, PartialEq)]
pub(crate) struct PoseBounds {
    pub(crate) inner: kinopt::task::PoseBounds,
}

impl From<kinopt::task::PoseBounds> for PoseBounds {
    fn from(inner: kinopt::task::PoseBounds) -> Self {
        Self { inner }
    }
}

/// Reads goal bounds: a `PoseBounds`, "pose" or "position".
pub(crate) fn pose_bounds(
    value: &Bound<'_, PyAny>,
    what: &str,
) -> PyResult<kinopt::task::PoseBounds> {
    if let Ok(goal) = value.cast::<PoseBounds>() {
        return Ok(goal.get().inner);
    }
    match value.extract::<String>() {
        Ok(name) => names::goal(&name).or_raise(),
        Err(_) => Err(invalid(format!(
            "{what} must be a kinopt.PoseBounds, \"pose\" or \"position\", not {}",
            arrays::shown(value)
        ))),
    }
}

#[pymethods]
impl PoseBounds {
    #[new]
    #[pyo3(signature = (*_arguments, **_keywords))]
    fn new(
        _arguments: &Bound<'_, PyTuple>,
        _keywords: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        Err(invalid(
            "PoseBounds has no arguments: use PoseBounds.pose(), PoseBounds.position(), PoseBounds.free_about(axis), \
             PoseBounds.free_along(axis) or PoseBounds.within(half_widths)",
        ))
    }

    /// Position and orientation, exactly.
    #[classmethod]
    fn pose(_class: &Bound<'_, PyType>) -> Self {
        kinopt::task::PoseBounds::pose().into()
    }

    /// Exact position, any orientation.
    #[classmethod]
    fn position(_class: &Bound<'_, PyType>) -> Self {
        kinopt::task::PoseBounds::position().into()
    }

    /// The full pose except for rotations about one axis of the frame, "x", "y" or "z", which are free. Examples are a
    /// drill, a pen and a suction cup.
    ///
    /// Raises `UnknownNameError` for another axis.
    #[classmethod]
    fn free_about(_class: &Bound<'_, PyType>, axis: &str) -> PyResult<Self> {
        Ok(kinopt::task::PoseBounds::free_about(named("axis", axis, &AXES).or_raise()?).into())
    }

    /// The full pose except for translations along one axis of the frame, "x", "y" or "z", which are free.
    ///
    /// Raises `UnknownNameError` for another axis.
    #[classmethod]
    fn free_along(_class: &Bound<'_, PyType>, axis: &str) -> PyResult<Self> {
        Ok(kinopt::task::PoseBounds::free_along(named("axis", axis, &AXES).or_raise()?).into())
    }

    /// An interval of plus and minus a half width for each component. `half_widths` has shape (6,), three in metres
    /// along the axes x, y, z, three in radians about them. 0 is exact; inf is free, and so are angles of pi or more.
    /// Negative numbers and NaN raise `InvalidValueError`.
    #[classmethod]
    fn within(_class: &Bound<'_, PyType>, half_widths: &Bound<'_, PyAny>) -> PyResult<Self> {
        let half_widths = arrays::array(half_widths, "half_widths")?;
        let bad = |value: &f64| value.is_nan() || *value < 0.0;
        match half_widths.iter().find(|value| bad(value)) {
            None => Ok(kinopt::task::PoseBounds::within(half_widths).into()),
            Some(value) => Err(invalid(format!(
                "half_widths holds {value}, which is no number of at least 0"
            ))),
        }
    }

    /// Half widths: three in metres, three in radians; inf for a free component.
    #[getter]
    fn half_widths(&self) -> [f64; 6] {
        self.inner.half_widths()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let class = py.get_type::<Self>();
        pickling::by_method(class.as_any(), "within", (self.half_widths(),))
    }

    fn __hash__(&self) -> u64 {
        let mut hash = 0_u64;
        for width in self.half_widths() {
            // Equal numbers have equal bits except for the sign of zero.
            hash = hash.rotate_left(7) ^ (width + 0.0).to_bits();
        }
        hash
    }

    fn __repr__(&self) -> String {
        format!("PoseBounds.within({:?})", self.half_widths())
    }
}
