//! Rotation curves of Euler angles.

use kinopt::animation::EulerCurve as Angles;
use kinopt::animation::rotation::EulerOrder;
use kinopt::glam::Quat;
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::keyed::{KeyedCurve, Values};
use super::sampled;
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::transforms::{Order, quaternion, quaternion_argument};

/// A rotation before * R(angles), with angles along a curve; for motion authored in angles, which may exceed whole
/// turns.
///
/// A curve of `angles`, vectors in radians in the order of the axes of `order` ("xyz", "zxz", ...; intrinsic
/// rotations), after a rotation, shape (4,), of unit length.
///
/// Raises `UnknownNameError` for an order.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct EulerCurve {
    pub(crate) inner: Angles,
}

impl EulerCurve {
    fn sampled<'py>(
        &self,
        times: &Bound<'py, PyAny>,
        order: Order,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        sampled(times, &[4], |time, buffer| {
            buffer.copy_from_slice(&order.to_array(self.inner.at(time)));
        })
    }
}

#[pymethods]
impl EulerCurve {
    #[new]
    #[pyo3(signature = (order, angles, *, before_xyzw = None, before_wxyz = None))]
    fn new(
        order: &str,
        angles: &Bound<'_, KeyedCurve>,
        before_xyzw: Option<&Bound<'_, PyAny>>,
        before_wxyz: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let names = EulerOrder::ALL.map(|name| format!("{name:?}").to_lowercase());
        let index = names.iter().position(|name| name == order);
        let euler_order = index.map(|index| EulerOrder::ALL[index]).ok_or_else(|| {
            kinopt::model::UnknownName::new("order", order, names.iter().map(String::as_str))
        });
        let Values::Vectors(angles) = &angles.get().inner else {
            return Err(invalid("angles must be a curve of vectors"));
        };
        let before = match quaternion_argument(before_xyzw, before_wxyz, "rotations")? {
            Some((q, order)) => quaternion(q, order)?.as_dquat().normalize().as_quat(),
            None => Quat::IDENTITY,
        };
        if !before.is_finite() {
            return Err(invalid(
                "the rotation before the angles is zero or not finite",
            ));
        }
        Ok(Self {
            inner: Angles {
                order: euler_order.or_raise()?,
                before,
                angles: angles.clone(),
            },
        })
    }

    /// Axes of the angles.
    #[getter]
    fn order(&self) -> String {
        format!("{:?}", self.inner.order).to_lowercase()
    }

    /// Curve of the angles.
    #[getter]
    fn angles(&self) -> KeyedCurve {
        let inner = Values::Vectors(self.inner.angles.clone());
        KeyedCurve { inner }
    }

    /// Rotation at one time, shape (4,), or at N, (N, 4), float32: x, y, z, w.
    ///
    /// Raises `InvalidValueError` for times that are not finite.
    fn at_xyzw<'py>(&self, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.sampled(times, Order::Xyzw)
    }

    /// Rotation at one time, shape (4,), or at N, (N, 4), float32: w, x, y, z.
    ///
    /// Raises `InvalidValueError` for times that are not finite.
    fn at_wxyz<'py>(&self, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.sampled(times, Order::Wxyz)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_json::<Self>(py, &self.inner)
    }

    #[staticmethod]
    fn _rebuild(text: &str) -> PyResult<Self> {
        Ok(Self {
            inner: pickling::of_json(text)?,
        })
    }

    fn __repr__(&self) -> String {
        format!(
            "EulerCurve({:?}, {} keys)",
            self.order(),
            self.inner.angles.times().len()
        )
    }
}
