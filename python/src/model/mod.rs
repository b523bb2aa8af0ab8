//! Models: joints, limits, frames.

mod builder;
mod parts;

use std::sync::Arc;

use kinopt::model::JointId;
use kinopt_bindings::coordinates;
use numpy::ndarray::Ix2;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyType;

pub(crate) use builder::ModelBuilder;
pub(crate) use parts::{Frame, Joint};

use crate::arrays;
use crate::configuration::of_two;
use crate::error::{OrRaise, invalid};
use crate::named_loop::{self, LoopParts};
use crate::pickling;

/// Immutable tree of joints and their frames.
///
/// A configuration `q` has one number for each moving joint, in the order of `joint_names`. The units are radians for
/// revolute joints, metres (for rigs, the rig's unit) for prismatic ones. A ball joint has four numbers, its unit
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
    /// Name of the model.
    #[getter]
    fn name(&self) -> &str {
        self.inner.name()
    }

    /// Names of the moving joints, in the order of a configuration.
    #[getter]
    pub(crate) fn joint_names(&self) -> Vec<&str> {
        let moving = self.inner.moving_joints();
        // A ball joint occurs four times in `moving_joints`.
        let first = |(at, id): &(usize, &JointId)| *at == 0 || moving[at - 1] != **id;
        let joints = moving.iter().enumerate().filter(first);
        joints
            .map(|(_, id)| self.inner.joints()[id.index()].name.as_str())
            .collect()
    }

    /// Names of all frames: links of a robot, bones and end effectors of a skeleton.
    #[getter]
    pub(crate) fn frame_names(&self) -> Vec<&str> {
        self.inner
            .frames()
            .iter()
            .map(|frame| frame.name.as_str())
            .collect()
    }

    /// Names of the numbers of a configuration: the joint's name, with the component for a ball's quaternion, as in
    /// "hip w".
    #[getter]
    pub(crate) fn coordinate_names(&self) -> Vec<String> {
        coordinates::names(&self.inner)
    }

    /// Names of the free joints, whose components are `NAME/x`, `NAME/y`, `NAME/z` and `NAME/rotation`.
    #[getter]
    pub(crate) fn free_joints(&self) -> Vec<&str> {
        let first = self.inner.free_joints().iter();
        let names = first.map(|id| self.inner.joints()[id.index()].name.as_str());
        names
            .map(|name| name.strip_suffix("/x").unwrap_or(name))
            .collect()
    }

    /// Length of a configuration, nq: four for a ball joint, one for any other.
    #[getter]
    pub(crate) fn configuration_len(&self) -> usize {
        self.inner.configuration_len()
    }

    /// Length of a velocity, nv: three for a ball joint, one for any other.
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

    /// All joints, including fixed ones, parents before children.
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

    /// Loops that every problem on the model closes. They are tuples of (name, "connect" or "weld", the names of two
    /// frames, the placements relative to them, shape (2, 4, 4)).
    #[getter]
    pub(crate) fn loops<'py>(&self, py: Python<'py>) -> PyResult<Vec<LoopParts<'py>>> {
        named_loop::loop_parts(py, &self.inner)
    }

    /// Unit of lengths: "m", or "units" for an unknown unit.
    #[getter]
    fn length_unit(&self) -> &'static str {
        self.inner.length_unit().symbol()
    }

    /// Reach of the revolute joints, metres: the longest chain from the first moving joint above a frame to that frame.
    #[getter]
    fn reach(&self) -> f64 {
        self.inner.reach()
    }

    /// The configuration closest to all zeros within the limits, shape (nq,).
    pub(crate) fn neutral<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.inner.neutral())
    }

    /// Configurations sampled uniformly within the limits; without limits, within half a turn around neutral.
    ///
    /// `seed` is a whole number (equal seeds give equal configurations on every machine) or a `numpy.random.Generator`,
    /// whose state advances. Without `n` the result is one configuration of shape (nq,), with it n of them, shape (n,
    /// nq), of the seeds `seed`, `seed + 1`, ...
    ///
    /// Raises `InvalidValueError` for a seed or an `n` that is not a whole number of at least 0.
    #[pyo3(signature = (n = None, *, seed = None))]
    pub(crate) fn random_configuration<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] n: Option<usize>,
        seed: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let model = &self.inner;
        random_configurations(py, seed, n, model.configuration_len(), |seed| {
            model.random_configuration(seed)
        })
    }

    /// Integrates a velocity over a unit of time from a configuration, without limits, as Pinocchio's `integrate`: q +
    /// v for joints of one number, exp for balls and free joints. Shapes (nq,) and (nv,), (N, nq) and (N, nv), or one
    /// row for all of the other; radians and metres. Velocities of balls and free joints are in their own moving axes,
    /// linear first. Quaternions of `q` are w, x, y, z.
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

    /// The velocity that leads from `q0` to `q1` in a unit of time, as Pinocchio's `difference`. Shapes (nq,) twice,
    /// (N, nq) twice, or one row for all of the other.
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

    /// Interpolates from `q0` (`share` 0) to `q1` (`share` 1). Shapes are as in `difference`.
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

    /// True if a configuration, shape (nq,), is within all limits, including cones.
    ///
    /// Raises `InvalidValueError` for another shape.
    pub(crate) fn is_within_limits(&self, q: &Bound<'_, PyAny>) -> PyResult<bool> {
        let q = arrays::vector_of(q, "q", self.inner.configuration_len())?;
        Ok(self.inner.is_within_limits(&q))
    }

    /// The model as JSON, which `Model.from_json` reads.
    fn to_json(&self) -> PyResult<String> {
        serde_json::to_string(&*self.inner).or_raise()
    }

    /// Creates a model from the JSON of `to_json`, and validates it.
    ///
    /// Raises `InvalidValueError` for a text that is not a model.
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

/// Random configurations of `nq` numbers of the seeds `seed`, `seed + 1`, ...: one of shape (nq,), or `n` of shape (n,
/// nq).
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

/// Returns a whole number, or samples one from a numpy generator.
pub(crate) fn first_seed(seed: &Bound<'_, PyAny>) -> PyResult<u64> {
    if seed.hasattr("integers")? {
        return seed.call_method1("integers", (0, 1_i64 << 62))?.extract();
    }
    seed.extract().map_err(|_| {
        invalid("seed must be a whole number from 0 to 2^64 - 1 or a numpy.random.Generator")
    })
}
