//! Curves through keys: numbers, vectors, rotations and angles over time.

use kinopt::animation::EulerCurve as Angles;
use kinopt::animation::curve::{
    BezierHandle, KeyError, KeyedCurve as Curve, TensionContinuityBias,
};
use kinopt::animation::rotation::{EulerOrder, RotationCurve as Rotations};
use kinopt::animation::{BezierEasing, Easing};
use kinopt::glam::{Quat, Vec3A};
use numpy::PyArrayDyn;
use numpy::ndarray::IxDyn;
use pyo3::prelude::*;
use pyo3::types::PyType;
use serde::Serialize;

use crate::arrays::{self, Numbers, Questions, shape_text};
use crate::error::{OrRaise, invalid};
use crate::transforms::{
    Order, flat, given, numbers, quaternion, quaternion_rates, quaternions, shaped,
};

/// Times that are looked at between two looks at signals.
const TIMES_AT_A_TIME: usize = 4096;

/// A curve through values at key times: numbers, or vectors of three. Before the first and after the last key
/// it holds the value there. Times are seconds, numbers float32.
///
/// Made by `step`, `linear`, `eased`, `cubic`, `catmull_rom`, `kochanek_bartels` and `bezier`: `times` has
/// shape (K,), rising, and `values` (K,) or (K, 3). What is wrong with keys raises `InvalidValueError`.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct KeyedCurve {
    pub(crate) inner: Values,
}

/// The same curve of numbers or of vectors.
#[derive(Clone, Serialize, serde::Deserialize)]
pub(crate) enum Values {
    Numbers(Curve<f32>),
    Vectors(Curve<Vec3A>),
}

/// Keys as they come.
enum Keys {
    Numbers(Vec<f32>),
    Vectors(Vec<Vec3A>),
}

/// Values of shape (K,) or (K, 3); of (K, 2) or (K, 2, 3) where there is a pair for each key.
fn keys(value: &Bound<'_, PyAny>, what: &str, pairs: bool) -> PyResult<Keys> {
    let numbers: Numbers<'_, IxDyn, f32> = arrays::numbers(value, what, "(K,) or (K, 3)")?;
    let before = if pairs { 2 } else { 1 };
    let vectors = match numbers.shape() {
        shape if pairs && shape.get(1) != Some(&2) => None,
        shape if shape.len() == before => Some(false),
        shape if shape.len() == before + 1 && shape[before] == 3 => Some(true),
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

fn times_of(value: &Bound<'_, PyAny>) -> PyResult<Vec<f32>> {
    numbers(value, "times", None)
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

    fn columns(&self) -> &'static [usize] {
        match self.inner {
            Values::Numbers(_) => &[],
            Values::Vectors(_) => &[3],
        }
    }

    fn sampled<'py>(
        &self,
        py: Python<'py>,
        times: &Bound<'py, PyAny>,
        number: impl Fn(&Curve<f32>, f32) -> f32 + Sync,
        vector: impl Fn(&Curve<Vec3A>, f32) -> Vec3A + Sync,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let times = Questions::numbers(times, "times")?;
        let array = arrays::room_of::<f32>(py, None, &times.shape(self.columns()))?;
        arrays::fill(&array, |room| {
            times.each(py, room, TIMES_AT_A_TIME, |time, room| {
                match &self.inner {
                    Values::Numbers(curve) => room[0] = number(curve, time[0] as f32),
                    Values::Vectors(curve) => {
                        room.copy_from_slice(&vector(curve, time[0] as f32).to_array());
                    }
                }
                Ok(())
            })
        })?;
        Ok(array)
    }
}

#[pymethods]
impl KeyedCurve {
    /// Keeps each key's value until the next (glTF's STEP).
    #[classmethod]
    fn step(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        values: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        Self::make(times, values, Curve::step, Curve::step)
    }

    /// Straight from key to key (glTF's LINEAR).
    #[classmethod]
    fn linear(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        values: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        Self::make(times, values, Curve::linear, Curve::linear)
    }

    /// Straight from key to key, each way at its own pace: an easing (see `easing`) for each key and the way
    /// that leaves it.
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

    /// Cubic segments with arriving and leaving tangents at each key, per second: `tangents` has shape
    /// (K, 2) or (K, 2, 3) (glTF's CUBICSPLINE).
    #[classmethod]
    fn cubic(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        values: &Bound<'_, PyAny>,
        tangents: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let times = times_of(times)?;
        let read = (
            keys(values, "values", false)?,
            keys(tangents, "tangents", true)?,
        );
        let inner = match read {
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

    /// A Catmull-Rom spline over uneven times.
    #[classmethod]
    fn catmull_rom(
        _class: &Bound<'_, PyType>,
        times: &Bound<'_, PyAny>,
        values: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        Self::make(times, values, Curve::catmull_rom, Curve::catmull_rom)
    }

    /// A Kochanek-Bartels spline: `controls`, shape (K, 3), are tension, continuity and bias at each key.
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

    /// The f-curve of animation editors: `handle_times`, shape (K, 2), and `handle_values`, (K, 2) or
    /// (K, 2, 3), are the arriving and the leaving handle of each key, as seen from the key.
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
        let read = (
            keys(values, "values", false)?,
            keys(handle_values, "handle_values", true)?,
        );
        let inner = match read {
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

    /// The values at the keys, shape (K,) or (K, 3).
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

    /// The value at one time, shape () or (3,), or at N, (N,) or (N, 3); at a key's time the key's to the bit.
    fn at<'py>(
        &self,
        py: Python<'py>,
        times: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.sampled(
            py,
            times,
            |curve, time| curve.at(time),
            |curve, time| curve.at(time),
        )
    }

    /// The rate of change per second, as `at` has it; zero outside the keys and where the curve steps.
    fn rate<'py>(
        &self,
        py: Python<'py>,
        times: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.sampled(
            py,
            times,
            |curve, time| curve.rate(time),
            |curve, time| curve.rate(time),
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickled(py, py.get_type::<Self>(), &self.inner)
    }

    #[staticmethod]
    fn _rebuild(text: &str) -> PyResult<Self> {
        let inner = serde_json::from_str(text).or_raise()?;
        Ok(Self { inner })
    }

    fn __repr__(&self) -> String {
        let (keys, of) = match &self.inner {
            Values::Numbers(curve) => (curve.times().len(), "numbers"),
            Values::Vectors(curve) => (curve.times().len(), "vectors"),
        };
        format!("KeyedCurve({keys} keys of {of})")
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
    let all = at.iter().zip(to);
    let all: Vec<_> = all
        .map(|(&time, &value)| BezierHandle { time, value })
        .collect();
    Ok(pairs(&all))
}

/// A curve through rotations at key times: `step`, `slerp`, `eased`, `squad`, `smooth` and `cubic` make one of
/// `times`, shape (K,), seconds, rising, and quaternions, shape (K, 4), given as `xyzw` or as `wxyz`, of any
/// length above 0. What is wrong with keys raises `InvalidValueError`.
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
        let (rotations, order) = given(xyzw, wxyz, "rotations")?
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
        py: Python<'py>,
        times: &Bound<'py, PyAny>,
        order: Order,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let times = Questions::numbers(times, "times")?;
        let array = arrays::room_of::<f32>(py, None, &times.shape(&[4]))?;
        arrays::fill(&array, |room| {
            times.each(py, room, TIMES_AT_A_TIME, |time, room| {
                room.copy_from_slice(&order.to_array(self.inner.at(time[0] as f32)));
                Ok(())
            })
        })?;
        Ok(array)
    }
}

#[pymethods]
impl RotationCurve {
    /// Keeps each key's rotation until the next (glTF's STEP).
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

    /// At constant angular speed along the shorter arc from key to key (glTF's LINEAR).
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

    /// Along the shorter arc from key to key, each way at its own pace: an easing (see `easing`) for each key
    /// and the way that leaves it.
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

    /// By squad: smooth at keys an even time apart.
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

    /// By Hermite segments with mean angular velocities: smooth at uneven times.
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

    /// A cubic through the components, made of unit length, with arriving and leaving `tangents` per second,
    /// shape (K, 2, 4), in the order of the quaternions (glTF's CUBICSPLINE).
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

    /// The rotations at the keys, shape (K, 4): unit quaternions x, y, z, w.
    #[getter]
    fn rotations_xyzw<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.keys(py, Order::Xyzw)
    }

    /// The rotations at the keys, shape (K, 4): unit quaternions w, x, y, z.
    #[getter]
    fn rotations_wxyz<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.keys(py, Order::Wxyz)
    }

    /// The rotation at one time, shape (4,), or at N, (N, 4): x, y, z, w.
    fn at_xyzw<'py>(
        &self,
        py: Python<'py>,
        times: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.sampled(py, times, Order::Xyzw)
    }

    /// The rotation at one time, shape (4,), or at N, (N, 4): w, x, y, z.
    fn at_wxyz<'py>(
        &self,
        py: Python<'py>,
        times: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.sampled(py, times, Order::Wxyz)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickled(py, py.get_type::<Self>(), &self.inner)
    }

    #[staticmethod]
    fn _rebuild(text: &str) -> PyResult<Self> {
        let inner = serde_json::from_str(text).or_raise()?;
        Ok(Self { inner })
    }

    fn __repr__(&self) -> String {
        format!("RotationCurve({} keys)", self.inner.times().len())
    }
}

/// A rotation before * R(angles), whose angles run along a curve; for motion that is authored in angles,
/// which may pass whole turns.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct EulerCurve {
    pub(crate) inner: Angles,
}

#[pymethods]
impl EulerCurve {
    /// A curve of `angles`, vectors in radians in the order of the axes of `order` ("xyz", "zxz", ...; each
    /// about axes that those before have turned), after a rotation, shape (4,), of unit length.
    ///
    /// Raises `UnknownNameError` for an order.
    #[new]
    #[pyo3(signature = (order, angles, *, before_xyzw = None, before_wxyz = None))]
    fn new(
        order: &str,
        angles: &Bound<'_, KeyedCurve>,
        before_xyzw: Option<&Bound<'_, PyAny>>,
        before_wxyz: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let names = EulerOrder::ALL.map(|own| format!("{own:?}").to_lowercase());
        let found = names.iter().position(|own| own == order);
        let found = found.map(|index| EulerOrder::ALL[index]).ok_or_else(|| {
            kinopt::model::UnknownName::new("order", order, names.iter().map(String::as_str))
        });
        let Values::Vectors(angles) = &angles.get().inner else {
            return Err(invalid("angles must be a curve of vectors"));
        };
        let before = match given(before_xyzw, before_wxyz, "rotations")? {
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
                order: found.or_raise()?,
                before,
                angles: angles.clone(),
            },
        })
    }

    /// The axes of the angles.
    #[getter]
    fn order(&self) -> String {
        format!("{:?}", self.inner.order).to_lowercase()
    }

    /// The curve of the angles.
    #[getter]
    fn angles(&self) -> KeyedCurve {
        let inner = Values::Vectors(self.inner.angles.clone());
        KeyedCurve { inner }
    }

    /// The rotation at a time in seconds, shape (4,), float32: x, y, z, w.
    fn at_xyzw<'py>(&self, py: Python<'py>, time: f32) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        shaped(py, Order::Xyzw.to_array(self.inner.at(time)).to_vec(), &[4])
    }

    /// The rotation at a time in seconds, shape (4,), float32: w, x, y, z.
    fn at_wxyz<'py>(&self, py: Python<'py>, time: f32) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        shaped(py, Order::Wxyz.to_array(self.inner.at(time)).to_vec(), &[4])
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickled(py, py.get_type::<Self>(), &self.inner)
    }

    #[staticmethod]
    fn _rebuild(text: &str) -> PyResult<Self> {
        let inner: Angles = serde_json::from_str(text).or_raise()?;
        Ok(Self { inner })
    }

    fn __repr__(&self) -> String {
        format!(
            "EulerCurve({:?}, {} keys)",
            self.order(),
            self.inner.angles.times().len()
        )
    }
}

/// The share of the way at shares `t` of the time, within [0, 1]; float64 of the shape of `t`, () or (N,).
///
/// `how` is "linear", "quadratic_in", "quadratic_out", "quadratic_in_out", "cubic_in", "cubic_out",
/// "cubic_in_out", or two handles ((time, value), (time, value)), as CSS's cubic-bezier has them.
#[pyfunction]
pub(crate) fn easing<'py>(
    how: &Bound<'py, PyAny>,
    t: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let py = how.py();
    let easing = read_easing(how)?;
    let shares = Questions::numbers(t, "t")?;
    let array = arrays::room_of::<f64>(py, None, &shares.shape(&[]))?;
    arrays::fill(&array, |room| {
        shares.each(py, room, TIMES_AT_A_TIME, |t, room| {
            room[0] = easing.at(t[0]);
            Ok(())
        })
    })?;
    Ok(array)
}

fn read_easings(values: &[Bound<'_, PyAny>]) -> PyResult<Vec<Easing>> {
    values.iter().map(read_easing).collect()
}

fn read_easing(value: &Bound<'_, PyAny>) -> PyResult<Easing> {
    if let Ok(name) = value.extract::<String>() {
        let quoted = serde_json::to_string(&name).or_raise()?;
        return serde_json::from_str(&quoted).or_raise();
    }
    let [first, second]: [[f32; 2]; 2] = value.extract().map_err(|_| {
        invalid("an easing is a name or two handles ((time, value), (time, value))")
    })?;
    BezierEasing::new(first, second)
        .or_raise()
        .map(Easing::Bezier)
}

/// What rebuilds something from its JSON.
pub(crate) fn pickled<'py>(
    py: Python<'py>,
    class: Bound<'py, PyType>,
    value: &impl Serialize,
) -> PyResult<Bound<'py, PyAny>> {
    let rebuild = class.getattr("_rebuild")?;
    let text = serde_json::to_string(value).or_raise()?;
    Ok((rebuild, (text,)).into_pyobject(py)?.into_any())
}
