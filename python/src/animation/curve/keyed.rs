//! Curves of numbers and of vectors.

use kinopt::animation::curve::{
    BezierHandle, KeyError, KeyedCurve as Curve, TensionContinuityBias,
};
use kinopt::glam::Vec3A;
use numpy::PyArrayDyn;
use numpy::ndarray::IxDyn;
use pyo3::prelude::*;
use pyo3::types::PyType;
use serde::Serialize;

use super::easing::read_easings;
use super::{sampled, times_of};
use crate::arrays::{self, Numbers, shape_text};
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::transforms::{flat, shaped};

/// A curve through values at key times: numbers, or vectors of three. It is constant before the first and after the
/// last key. Times are seconds, numbers float32.
///
/// Created by `step`, `linear`, `eased`, `cubic`, `catmull_rom`, `kochanek_bartels` and `bezier`: `times` has shape
/// (K,), ascending, and `values` (K,) or (K, 3). Invalid keys raise `InvalidValueError`.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct KeyedCurve {
    pub(crate) inner: Values,
}

/// Curve of numbers or of vectors.
#[derive(Clone, Serialize, serde::Deserialize)]
pub(crate) enum Values {
    Numbers(Curve<f32>),
    Vectors(Curve<Vec3A>),
}

/// Key values of numbers or of vectors.
enum Keys {
    Numbers(Vec<f32>),
    Vectors(Vec<Vec3A>),
}

/// Reads values of shape (K,) or (K, 3); with pairs for each key, of (K, 2) or (K, 2, 3).
fn keys(value: &Bound<'_, PyAny>, what: &str, pairs: bool) -> PyResult<Keys> {
    let numbers: Numbers<'_, IxDyn, f32> = arrays::numbers(value, what, "(K,) or (K, 3)")?;
    let axes = if pairs { 2 } else { 1 };
    let vectors = match numbers.shape() {
        shape if pairs && shape.get(1) != Some(&2) => None,
        shape if shape.len() == axes => Some(false),
        shape if shape.len() == axes + 1 && shape[axes] == 3 => Some(true),
        _ => None,
    };
    match vectors {
        Some(false) => Ok(Keys::Numbers(numbers.to_vec())),
        Some(true) => {
            let rows = numbers.chunks_exact(3);
            Ok(Keys::Vectors(rows.map(Vec3A::from_slice).collect()))
        }
        None => Err(invalid(format!(
            "{what} has shape {}, expected {}",
            shape_text(numbers.shape()),
            if pairs {
                "(K, 2) or (K, 2, 3)"
            } else {
                "(K,) or (K, 3)"
            }
        ))),
    }
}

fn pairs<T: Copy>(list: &[T]) -> Vec<[T; 2]> {
    list.chunks_exact(2)
        .map(|pair| [pair[0], pair[1]])
        .collect()
}

impl KeyedCurve {
    fn make(
        times: &Bound<'_, PyAny>,
        values: &Bound<'_, PyAny>,
        number: impl FnOnce(Vec<f32>, Vec<f32>) -> Result<Curve<f32>, KeyError>,
        vector: impl FnOnce(Vec<f32>, Vec<Vec3A>) -> Result<Curve<Vec3A>, KeyError>,
    ) -> PyResult<Self> {
        let times = times_of(times)?;
        let inner = match keys(values, "values", false)? {
            Keys::Numbers(values) => Values::Numbers(number(times, values).or_raise()?),
            Keys::Vectors(values) => Values::Vectors(vector(times, values).or_raise()?),
        };
        Ok(Self { inner })
    }

    fn sampled<'py>(
        &self,
        times: &Bound<'py, PyAny>,
        number: impl Fn(&Curve<f32>, f32) -> f32 + Sync,
        vector: impl Fn(&Curve<Vec3A>, f32) -> Vec3A + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        match &self.inner {
            Values::Numbers(curve) => {
                sampled(times, &[], |time, buffer| buffer[0] = number(curve, time))
            }
            Values::Vectors(curve) => sampled(times, &[3], |time, buffer| {
                buffer.copy_from_slice(&vector(curve, time).to_array());
            }),
        }
    }
}

#[pymethods]
impl KeyedCurve {
    /// Step interpolation: each key's value holds until the next (glTF's STEP).
    ///
    /// Raises `InvalidValueError`, which names the key: times that do not ascend, numbers that are not finite, other
    /// shapes.
    #[classmethod]
    fn step(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        values: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        Self::make(times, values, Curve::step, Curve::step)
    }

    /// Linear interpolation (glTF's LINEAR).
    ///
    /// Raises `InvalidValueError`, which names the key: times that do not ascend, numbers that are not finite, other
    /// shapes.
    #[classmethod]
    fn linear(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        values: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        Self::make(times, values, Curve::linear, Curve::linear)
    }

    /// Linear interpolation with an easing (see `easing`) for the segment after each key.
    ///
    /// Raises `InvalidValueError`, which names the key: times that do not ascend, numbers that are not finite, other
    /// shapes, an unknown easing.
    #[classmethod]
    fn eased(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        values: &Bound<'_, PyAny>,
        easings: Vec<Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let easings = read_easings(&easings)?;
        let again = easings.clone();
        Self::make(
            times,
            values,
            |times, values| Curve::eased(times, values, easings),
            |times, values| Curve::eased(times, values, again),
        )
    }

    /// Cubic segments with in- and out-tangents at each key, per second: `tangents` has shape (K, 2) or (K, 2, 3)
    /// (glTF's CUBICSPLINE).
    ///
    /// Raises `InvalidValueError`, which names the key: times that do not ascend, numbers that are not finite, other
    /// shapes.
    #[classmethod]
    fn cubic(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        values: &Bound<'_, PyAny>,
        tangents: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let times = times_of(times)?;
        let keys_and_tangents = (
            keys(values, "values", false)?,
            keys(tangents, "tangents", true)?,
        );
        let inner = match keys_and_tangents {
            (Keys::Numbers(values), Keys::Numbers(tangents)) => {
                Values::Numbers(Curve::cubic(times, values, pairs(&tangents)).or_raise()?)
            }
            (Keys::Vectors(values), Keys::Vectors(tangents)) => {
                Values::Vectors(Curve::cubic(times, values, pairs(&tangents)).or_raise()?)
            }
            _ => {
                return Err(invalid(
                    "values and tangents must both be numbers or both vectors",
                ));
            }
        };
        Ok(Self { inner })
    }

    /// A Catmull-Rom spline over non-uniform times.
    ///
    /// Raises `InvalidValueError`, which names the key: times that do not ascend, numbers that are not finite, other
    /// shapes.
    #[classmethod]
    fn catmull_rom(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        values: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        Self::make(times, values, Curve::catmull_rom, Curve::catmull_rom)
    }

    /// A Kochanek-Bartels spline: `controls`, shape (K, 3), are tension, continuity and bias at each key.
    ///
    /// Raises `InvalidValueError`, which names the key: times that do not ascend, numbers that are not finite, other
    /// shapes.
    #[classmethod]
    fn kochanek_bartels(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        values: &Bound<'_, PyAny>,
        controls: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let rows = crate::vertices::vectors(controls, "controls")?;
        let controls: Vec<_> = rows
            .iter()
            .map(|row| TensionContinuityBias {
                tension: row.x,
                continuity: row.y,
                bias: row.z,
            })
            .collect();
        Self::make(
            times,
            values,
            |times, values| Curve::kochanek_bartels(times, values, &controls),
            |times, values| Curve::kochanek_bartels(times, values, &controls),
        )
    }

    /// Bézier curve of animation editors (f-curve). `handle_times`, shape (K, 2), and `handle_values`, (K, 2) or (K, 2,
    /// 3), are the left and right handle of each key, relative to the key.
    ///
    /// Raises `InvalidValueError`, which names the key: times that do not ascend, numbers that are not finite, other
    /// shapes.
    #[classmethod]
    fn bezier(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        values: &Bound<'_, PyAny>,
        handle_times: &Bound<'_, PyAny>,
        handle_values: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let times = times_of(times)?;
        let Keys::Numbers(at) = keys(handle_times, "handle_times", true)? else {
            return Err(invalid("handle_times must have shape (K, 2)"));
        };
        let keys_and_handles = (
            keys(values, "values", false)?,
            keys(handle_values, "handle_values", true)?,
        );
        let inner = match keys_and_handles {
            (Keys::Numbers(values), Keys::Numbers(to)) => {
                Values::Numbers(Curve::bezier(times, values, handles(&at, &to)?).or_raise()?)
            }
            (Keys::Vectors(values), Keys::Vectors(to)) => {
                Values::Vectors(Curve::bezier(times, values, handles(&at, &to)?).or_raise()?)
            }
            _ => {
                return Err(invalid(
                    "values and handles must both be numbers or both vectors",
                ));
            }
        };
        Ok(Self { inner })
    }

    /// Key times, shape (K,), seconds.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let times = match &self.inner {
            Values::Numbers(curve) => curve.times(),
            Values::Vectors(curve) => curve.times(),
        };
        shaped(py, times.to_vec(), &[times.len()])
    }

    /// Values at the keys, shape (K,) or (K, 3).
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        match &self.inner {
            Values::Numbers(curve) => shaped(py, curve.values().to_vec(), &[curve.values().len()]),
            Values::Vectors(curve) => {
                let numbers = flat(curve.values()).collect();
                shaped(py, numbers, &[curve.values().len(), 3])
            }
        }
    }

    /// Value at one time, shape () or (3,), or at N, (N,) or (N, 3); at a key time exactly the key's value.
    ///
    /// Raises `InvalidValueError` for times that are not finite.
    fn at<'py>(&self, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.sampled(times, Curve::at, Curve::at)
    }

    /// Rate of change per second, with the shape of `at`; zero outside the keys and for step interpolation.
    ///
    /// Raises `InvalidValueError` for times that are not finite.
    fn rate<'py>(&self, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.sampled(times, Curve::rate, Curve::rate)
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
        let (keys, kind) = match &self.inner {
            Values::Numbers(curve) => (curve.times().len(), "numbers"),
            Values::Vectors(curve) => (curve.times().len(), "vectors"),
        };
        format!("KeyedCurve({keys} keys of {kind})")
    }
}

fn handles<V>(at: &[f32], to: &[V]) -> PyResult<Vec<[BezierHandle<V>; 2]>>
where
    V: kinopt::animation::curve::CurveValue<Real = f32>,
{
    if at.len() != to.len() {
        return Err(invalid(format!(
            "{} times of handles for {} values",
            at.len(),
            to.len()
        )));
    }
    let bezier_handles = at.iter().zip(to);
    let bezier_handles: Vec<_> = bezier_handles
        .map(|(&time, &value)| BezierHandle { time, value })
        .collect();
    Ok(pairs(&bezier_handles))
}
