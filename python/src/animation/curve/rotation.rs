//! Curves of rotations.

use kinopt::animation::rotation::RotationCurve as Rotations;
use kinopt::glam::Quat;
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyType;

use super::easing::read_easings;
use super::{sampled, times_of};
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::transforms::{Order, quaternion_argument, quaternion_rates, quaternions, shaped};

/// A curve through rotations at key times. `step`, `slerp`, `eased`, `squad`, `smooth` and `cubic` create it from
/// `times`, shape (K,), seconds, ascending, and quaternions, shape (K, 4), given as `xyzw` or as `wxyz`, of any length
/// above 0. Invalid keys raise `InvalidValueError`.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct RotationCurve {
    pub(crate) inner: Rotations,
}

impl RotationCurve {
    fn make(
        times: &Bound<'_, PyAny>,
        xyzw: Option<&Bound<'_, PyAny>>,
        wxyz: Option<&Bound<'_, PyAny>>,
        make: impl FnOnce(Vec<f32>, Vec<Quat>, Order) -> PyResult<Rotations>,
    ) -> PyResult<Self> {
        let (rotations, order) = quaternion_argument(xyzw, wxyz, "rotations")?
            .ok_or_else(|| invalid("rotations are given as xyzw or as wxyz"))?;
        let inner = make(times_of(times)?, quaternions(rotations, order)?, order)?;
        Ok(Self { inner })
    }

    fn keys<'py>(&self, py: Python<'py>, order: Order) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let keys = self.inner.rotations();
        let numbers = keys.iter().flat_map(|&q| order.to_array(q)).collect();
        shaped(py, numbers, &[keys.len(), 4])
    }

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
impl RotationCurve {
    /// Step interpolation: each key's rotation holds until the next (glTF's STEP).
    ///
    /// Quaternions are x, y, z, w as `xyzw`, or w, x, y, z as `wxyz`, shape (K, 4).
    ///
    /// Raises `InvalidValueError`, which names the key: times that do not ascend, numbers that are not finite, other
    /// shapes; a quaternion of length 0.
    #[classmethod]
    #[pyo3(signature = (times, *, xyzw = None, wxyz = None))]
    fn step(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        xyzw: Option<&Bound<'_, PyAny>>,
        wxyz: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        Self::make(times, xyzw, wxyz, |t, q, _| {
            Rotations::step(t, q).or_raise()
        })
    }

    /// Spherical linear interpolation along the shorter arc (glTF's LINEAR).
    ///
    /// Quaternions are x, y, z, w as `xyzw`, or w, x, y, z as `wxyz`, shape (K, 4).
    ///
    /// Raises `InvalidValueError`, which names the key: times that do not ascend, numbers that are not finite, other
    /// shapes; a quaternion of length 0.
    #[classmethod]
    #[pyo3(signature = (times, *, xyzw = None, wxyz = None))]
    fn slerp(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        xyzw: Option<&Bound<'_, PyAny>>,
        wxyz: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        Self::make(times, xyzw, wxyz, |t, q, _| {
            Rotations::slerp(t, q).or_raise()
        })
    }

    /// Spherical linear interpolation with an easing (see `easing`) for the segment after each key.
    ///
    /// Quaternions are x, y, z, w as `xyzw`, or w, x, y, z as `wxyz`, shape (K, 4).
    ///
    /// Raises `InvalidValueError`, which names the key: times that do not ascend, numbers that are not finite, other
    /// shapes, an unknown easing.
    #[classmethod]
    #[pyo3(signature = (times, easings, *, xyzw = None, wxyz = None))]
    fn eased(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        easings: Vec<Bound<'_, PyAny>>,
        xyzw: Option<&Bound<'_, PyAny>>,
        wxyz: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let easings = read_easings(&easings)?;
        Self::make(times, xyzw, wxyz, |t, q, _| {
            Rotations::eased(t, q, easings).or_raise()
        })
    }

    /// Squad interpolation: smooth for uniform key times.
    ///
    /// Quaternions are x, y, z, w as `xyzw`, or w, x, y, z as `wxyz`, shape (K, 4).
    ///
    /// Raises `InvalidValueError`, which names the key: times that do not ascend, numbers that are not finite, other
    /// shapes; a quaternion of length 0.
    #[classmethod]
    #[pyo3(signature = (times, *, xyzw = None, wxyz = None))]
    fn squad(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        xyzw: Option<&Bound<'_, PyAny>>,
        wxyz: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        Self::make(times, xyzw, wxyz, |t, q, _| {
            Rotations::squad(t, q).or_raise()
        })
    }

    /// Hermite segments with mean angular velocities: smooth for non-uniform key times.
    ///
    /// Quaternions are x, y, z, w as `xyzw`, or w, x, y, z as `wxyz`, shape (K, 4).
    ///
    /// Raises `InvalidValueError`, which names the key: times that do not ascend, numbers that are not finite, other
    /// shapes; a quaternion of length 0.
    #[classmethod]
    #[pyo3(signature = (times, *, xyzw = None, wxyz = None))]
    fn smooth(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        xyzw: Option<&Bound<'_, PyAny>>,
        wxyz: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        Self::make(times, xyzw, wxyz, |t, q, _| {
            Rotations::smooth(t, q).or_raise()
        })
    }

    /// Cubic interpolation of the components, normalised, with in- and out-`tangents` per second, shape (K, 2, 4), in
    /// the order of the quaternions (glTF's CUBICSPLINE).
    ///
    /// Quaternions are x, y, z, w as `xyzw`, or w, x, y, z as `wxyz`, shape (K, 4).
    ///
    /// Raises `InvalidValueError`, which names the key: times that do not ascend, numbers that are not finite, other
    /// shapes; a quaternion of length 0.
    #[classmethod]
    #[pyo3(signature = (times, tangents, *, xyzw = None, wxyz = None))]
    fn cubic(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        tangents: &Bound<'_, PyAny>,
        xyzw: Option<&Bound<'_, PyAny>>,
        wxyz: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        Self::make(times, xyzw, wxyz, |t, q, order| {
            Rotations::cubic(t, q, quaternion_rates(tangents, order)?).or_raise()
        })
    }

    /// Key times, shape (K,), seconds.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let times = self.inner.times();
        shaped(py, times.to_vec(), &[times.len()])
    }

    /// Rotations at the keys, shape (K, 4): unit quaternions x, y, z, w.
    #[getter]
    fn rotations_xyzw<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.keys(py, Order::Xyzw)
    }

    /// Rotations at the keys, shape (K, 4): unit quaternions w, x, y, z.
    #[getter]
    fn rotations_wxyz<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.keys(py, Order::Wxyz)
    }

    /// Rotation at one time, shape (4,), or at N, (N, 4): x, y, z, w.
    ///
    /// Raises `InvalidValueError` for times that are not finite.
    fn at_xyzw<'py>(&self, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.sampled(times, Order::Xyzw)
    }

    /// Rotation at one time, shape (4,), or at N, (N, 4): w, x, y, z.
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
        format!("RotationCurve({} keys)", self.inner.times().len())
    }
}
