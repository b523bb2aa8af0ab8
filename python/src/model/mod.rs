//! Models: joints, limits, frames.

mod builder;
mod parts;

use std::sync::Arc;

use kinopt::model::{JointId, JointKind};
use numpy::ndarray::Ix2;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyType;

pub(crate) use builder::ModelBuilder;
pub(crate) use parts::{Frame, Joint};

use crate::arrays;
use crate::configuration::of_two;
use crate::error::{OrRaise, invalid};
use crate::loops::{self, LoopParts};
use crate::pickling;

/// A tree of joints and the frames they carry, that nothing changes.
///
/// A configuration `q` has one number a moving joint, in the order of `joint_names`: radians for joints
/// that turn, metres (a rig's own unit for rigs) for those that slide; a ball joint has four, its unit
/// quaternion w, x, y, z.
#[pyclass(frozen, module = "kinopt")]
#[derive(Clone)]
pub(crate) struct Model {
    pub(crate) inner: Arc<kinopt::Model>,
}

impl From<kinopt::Model> for Model {
    fn from(model: kinopt::Model) -> Self {
        let inner = Arc::new(model);
        Self { inner }
    }
}

#[pymethods]
impl Model {
    /// The model's name.
    #[getter]
    fn name(&self) -> &str {
        self.inner.name()
    }

    /// Names of the moving joints, in the order of a configuration.
    #[getter]
    pub(crate) fn joint_names(&self) -> Vec<&str> {
        let moving = self.inner.moving_joints();
        // A ball is there four times.
        let first = |(at, id): &(usize, &JointId)| *at == 0 || moving[at - 1] != **id;
        let joints = moving.iter().enumerate().filter(first);
        joints
            .map(|(_, id)| self.inner.joints()[id.index()].name.as_str())
            .collect()
    }

    /// Names of all frames: links of a robot, bones and tips of a skeleton.
    #[getter]
    pub(crate) fn frame_names(&self) -> Vec<&str> {
        self.inner
            .frames()
            .iter()
            .map(|frame| frame.name.as_str())
            .collect()
    }

    /// Names of the numbers of a configuration: of its joint, and which part of a ball's quaternion, as in
    /// "hip w".
    #[getter]
    pub(crate) fn coordinate_names(&self) -> Vec<String> {
        let parts = self
            .inner
            .moving_joints()
            .iter()
            .enumerate()
            .map(|(at, &id)| {
                let joint = &self.inner.joints()[id.index()];
                let part = at - self.inner.coordinate(id).unwrap_or(at);
                match joint.kind {
                    JointKind::Ball => format!("{} {}", joint.name, ["w", "x", "y", "z"][part]),
                    _ => joint.name.clone(),
                }
            });
        parts.collect()
    }

    /// Names of the free joints, whose parts are `NAME/x`, `NAME/y`, `NAME/z` and `NAME/rotation`.
    #[getter]
    pub(crate) fn free_joints(&self) -> Vec<&str> {
        let first = self.inner.free_joints().iter();
        let names = first.map(|id| self.inner.joints()[id.index()].name.as_str());
        names
            .map(|name| name.strip_suffix("/x").unwrap_or(name))
            .collect()
    }

    /// How many numbers a configuration has, nq: four for a ball joint, one for any other.
    #[getter]
    pub(crate) fn configuration_len(&self) -> usize {
        self.inner.configuration_len()
    }

    /// How many numbers a velocity has, nv: three for a ball joint, one for any other.
    #[getter]
    pub(crate) fn degrees_of_freedom(&self) -> usize {
        self.inner.degrees_of_freedom()
    }

    /// Lower limits in configuration order, shape (nq,), radians or metres; -inf for none.
    #[getter]
    pub(crate) fn lower<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        arrays::frozen(py, self.inner.limits().map(|limits| limits.lower))
    }

    /// Upper limits in configuration order, shape (nq,), radians or metres; inf for none.
    #[getter]
    pub(crate) fn upper<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        arrays::frozen(py, self.inner.limits().map(|limits| limits.upper))
    }

    /// All joints, fixed ones among them, parents before children.
    #[getter]
    fn joints(&self) -> Vec<Joint> {
        let joints = self.inner.joints().iter();
        joints.map(|joint| Joint::of(&self.inner, joint)).collect()
    }

    /// All frames.
    #[getter]
    fn frames(&self) -> Vec<Frame> {
        let frames = self.inner.frames().iter();
        frames.map(|frame| Frame::of(&self.inner, frame)).collect()
    }

    /// The loops that every problem on the model closes: tuples of (name, "connect" or "weld", the two frames' names,
    /// where on them, shape (2, 4, 4): frame_from_place).
    #[getter]
    pub(crate) fn loops<'py>(&self, py: Python<'py>) -> PyResult<Vec<LoopParts<'py>>> {
        loops::loop_parts(py, &self.inner)
    }

    /// The unit of lengths: "m", or "units" where the model says nothing of its size in the world.
    #[getter]
    fn length_unit(&self) -> &'static str {
        self.inner.length_unit().symbol()
    }

    /// How far what turns reaches, metres: the longest way from the first moving joint above a frame to
    /// that frame.
    #[getter]
    fn reach(&self) -> f64 {
        self.inner.reach()
    }

    /// The configuration nearest to all zeros within the limits, shape (nq,).
    pub(crate) fn neutral<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.inner.neutral())
    }

    /// Configurations drawn uniformly within the limits, half a turn around neutral where there are none.
    ///
    /// `seed` is a whole number (the same one gives the same configurations on every machine) or a
    /// `numpy.random.Generator`, which is drawn from. Without `n` one configuration of shape (nq,), with
    /// it n of them, shape (n, dof), of the seeds `seed`, `seed + 1`, ...
    ///
    /// Raises `InvalidValueError` for a seed or an `n` that is no whole number of at least 0.
    #[pyo3(signature = (seed = None, n = None))]
    pub(crate) fn random_configuration<'py>(
        &self,
        py: Python<'py>,
        seed: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] n: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = &self.inner;
        random_configurations(py, seed, n, model.configuration_len(), |seed| {
            model.random_configuration(seed)
        })
    }

    /// Where a velocity leads from a configuration in a unit of time, limits aside: q + v for joints of one
    /// number, exp for balls and free joints, as Pinocchio's `integrate`. Shapes (nq,) and (nv,), (N, nq) and (N, nv), or
    /// one for all of the other; radians and metres, a ball's and a free joint's in their own moved axes, linear first.
    /// Quaternions of `q` are w, x, y, z.
    ///
    /// Raises `InvalidValueError` for other shapes, numbers that are not finite, quaternions of length zero.
    pub(crate) fn integrate<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = &self.inner;
        let (nq, nv) = (model.configuration_len(), model.degrees_of_freedom());
        of_two((q, "q", nq), (v, "v", nv), nq, |q, v, to| {
            model.integrate(q, v, to)
        })
    }

    /// The velocity that leads from `q0` to `q1` in a unit of time, as Pinocchio's `difference`. Shapes
    /// (nq,) twice, (N, nq) twice, or one for all of the other.
    ///
    /// Raises `InvalidValueError` as `integrate`.
    pub(crate) fn difference<'py>(
        &self,
        q0: &Bound<'py, PyAny>,
        q1: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = &self.inner;
        let (nq, nv) = (model.configuration_len(), model.degrees_of_freedom());
        of_two((q0, "q0", nq), (q1, "q1", nq), nv, |q0, q1, v| {
            model.difference(q0, q1, v)
        })
    }

    /// The configuration at a share of the way from `q0` to `q1`. Shapes as of `difference`.
    ///
    /// Raises `InvalidValueError` as `integrate`, and for a share that is not finite.
    pub(crate) fn interpolate<'py>(
        &self,
        q0: &Bound<'py, PyAny>,
        q1: &Bound<'py, PyAny>,
        share: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = &self.inner;
        let nq = model.configuration_len();
        of_two((q0, "q0", nq), (q1, "q1", nq), nq, |q0, q1, to| {
            model.interpolate(q0, q1, share, to)
        })
    }

    /// The configuration with quaternions w, x, y, z of unit length, shape (nq,).
    ///
    /// Raises `InvalidValueError` as `integrate`.
    pub(crate) fn normalise<'py>(
        &self,
        q: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let mut q_unit = arrays::vector_of(q, "q", self.inner.configuration_len())?.to_vec();
        self.inner.normalise(&mut q_unit).or_raise()?;
        Ok(arrays::list(q.py(), &q_unit))
    }

    /// Whether a configuration, shape (nq,), is within all limits, cones included.
    ///
    /// Raises `InvalidValueError` for another shape.
    pub(crate) fn is_within_limits(&self, q: &Bound<'_, PyAny>) -> PyResult<bool> {
        let q = arrays::vector_of(q, "q", self.inner.configuration_len())?;
        Ok(self.inner.is_within_limits(&q))
    }

    /// The same model as JSON, which `Model.from_json` reads.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&*self.inner).or_raise()
    }

    /// A model from what `to_json` wrote; it is checked anew.
    ///
    /// Raises `InvalidValueError` for a text that is no model.
    #[classmethod]
    fn from_json(_class: &Bound<'_, PyType>, text: &str) -> PyResult<Self> {
        serde_json::from_str::<kinopt::Model>(text)
            .or_raise()
            .map(Self::from)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let class = py.get_type::<Self>();
        pickling::by_method(class.as_any(), "from_json", (self.to_json()?,))
    }

    fn __repr__(&self) -> String {
        format!(
            "Model({:?}, {} degrees of freedom, {} frames)",
            self.inner.name(),
            self.inner.degrees_of_freedom(),
            self.inner.frames().len()
        )
    }
}

/// Configurations of `nq` numbers of the seeds `seed`, `seed + 1`, ...: one of shape (nq,), or `n` of shape (n, nq).
pub(crate) fn random_configurations<'py>(
    py: Python<'py>,
    seed: Option<&Bound<'py, PyAny>>,
    n: Option<usize>,
    nq: usize,
    sample: impl Fn(u64) -> Vec<f64>,
) -> PyResult<Bound<'py, PyAny>> {
    let seed = match seed {
        Some(seed) => first_seed(seed)?,
        None => 0,
    };
    let draw = |i: usize| sample(seed.wrapping_add(i as u64));
    let Some(n) = n else {
        return Ok(arrays::list(py, &draw(0)).into_any());
    };
    let array = arrays::zeros::<f64, _>(py, Ix2(n, nq))?;
    {
        let mut array = array
            .try_readwrite()
            .map_err(|error| invalid(error.to_string()))?;
        let rows = array
            .as_slice_mut()
            .map_err(|error| invalid(error.to_string()))?;
        for (i, row) in rows.chunks_mut(nq.max(1)).enumerate() {
            row.copy_from_slice(&draw(i));
        }
    }
    Ok(array.into_any())
}

/// A whole number, or one drawn from a generator of numpy's.
pub(crate) fn first_seed(seed: &Bound<'_, PyAny>) -> PyResult<u64> {
    if seed.hasattr("integers")? {
        return seed.call_method1("integers", (0, 1_i64 << 62))?.extract();
    }
    seed.extract().map_err(|_| {
        invalid("seed must be a whole number from 0 to 2^64 - 1 or a numpy.random.Generator")
    })
}
