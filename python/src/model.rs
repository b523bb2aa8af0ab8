//! Models: joints, limits, frames.

use std::sync::Arc;

use kinopt::model::{JointId, JointKind, LengthUnit, Limits};
use kinopt::spatial::Placement;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::placement;

/// A tree of joints and the frames they carry, that nothing changes.
///
/// A configuration `q` has one number a moving joint, in the order of `joint_names`: radians for joints
/// that turn, metres (a rig's own unit for rigs) for those that slide.
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
        let joints = self.inner.moving_joints().iter();
        joints
            .map(|id| self.inner.joints()[id.index()].name.as_str())
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

    /// How many numbers a configuration has.
    #[getter]
    pub(crate) fn degrees_of_freedom(&self) -> usize {
        self.inner.configuration_len()
    }

    /// Lower limits in configuration order, shape (dof,), radians or metres; -inf for none.
    #[getter]
    pub(crate) fn lower<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        arrays::frozen(py, self.inner.limits().map(|limits| limits.lower))
    }

    /// Upper limits in configuration order, shape (dof,), radians or metres; inf for none.
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

    /// The configuration nearest to all zeros within the limits, shape (dof,).
    pub(crate) fn neutral<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.inner.neutral())
    }

    /// Configurations drawn uniformly within the limits, half a turn around neutral where there are none.
    ///
    /// `seed` is a whole number (the same one gives the same configurations on every machine) or a
    /// `numpy.random.Generator`, which is drawn from. Without `n` one configuration of shape (dof,), with
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
        let seed = match seed {
            Some(seed) => first_seed(seed)?,
            None => 0,
        };
        let draw = |i: usize| self.inner.random_configuration(seed.wrapping_add(i as u64));
        let Some(n) = n else {
            return Ok(arrays::list(py, &draw(0)).into_any());
        };
        let array = PyArray2::<f64>::zeros(py, [n, self.inner.configuration_len()], false);
        {
            let mut array = array
                .try_readwrite()
                .map_err(|error| invalid(error.to_string()))?;
            let rows = array
                .as_slice_mut()
                .map_err(|error| invalid(error.to_string()))?;
            for (i, row) in rows
                .chunks_mut(self.inner.configuration_len().max(1))
                .enumerate()
            {
                row.copy_from_slice(&draw(i));
            }
        }
        Ok(array.into_any())
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
            self.inner.configuration_len(),
            self.inner.frames().len()
        )
    }
}

/// A whole number, or one drawn from a generator of numpy's.
fn first_seed(seed: &Bound<'_, PyAny>) -> PyResult<u64> {
    if seed.hasattr("integers")? {
        return seed.call_method1("integers", (0, 1_i64 << 62))?.extract();
    }
    seed.extract().map_err(|_| {
        invalid("seed must be a whole number from 0 to 2^64 - 1 or a numpy.random.Generator")
    })
}

/// One joint of a model.
#[pyclass(frozen, module = "kinopt")]
#[derive(Clone)]
pub(crate) struct Joint {
    /// Unique within the model.
    #[pyo3(get)]
    name: String,
    /// "revolute", "continuous", "prismatic" or "fixed".
    #[pyo3(get)]
    kind: &'static str,
    /// The joint it stands on; None for the world.
    #[pyo3(get)]
    parent: Option<String>,
    /// The unit axis it turns about or slides along, in its own frame.
    #[pyo3(get)]
    axis: [f64; 3],
    /// Smallest value, radians or metres.
    #[pyo3(get)]
    lower: f64,
    /// Largest value, radians or metres.
    #[pyo3(get)]
    upper: f64,
    /// Where its value stands in a configuration; None for a fixed joint.
    #[pyo3(get)]
    coordinate: Option<usize>,
    parent_from_joint: [f64; 16],
}

impl Joint {
    fn of(model: &kinopt::Model, joint: &kinopt::model::Joint) -> Self {
        let id = model.joint(&joint.name).ok();
        Self {
            name: joint.name.clone(),
            kind: joint.kind.name(),
            parent: joint
                .parent
                .map(|parent| model.joints()[parent.index()].name.clone()),
            axis: joint.axis.to_array(),
            lower: joint.limits.lower,
            upper: joint.limits.upper,
            coordinate: id.and_then(|id| model.coordinate(id)),
            parent_from_joint: placement::to_numbers(&joint.parent_from_joint),
        }
    }
}

#[pymethods]
impl Joint {
    /// Where the joint stands in its parent at value 0, shape (4, 4).
    #[getter]
    fn parent_from_joint<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::list(py, &self.parent_from_joint).reshape([4, 4])
    }

    fn __repr__(&self) -> String {
        format!(
            "Joint({:?}, {}, {} to {})",
            self.name, self.kind, self.lower, self.upper
        )
    }
}

/// One frame of a model: a named place on a joint.
#[pyclass(frozen, module = "kinopt")]
#[derive(Clone)]
pub(crate) struct Frame {
    /// Unique within the model.
    #[pyo3(get)]
    name: String,
    /// The joint that carries it; None for a frame fixed in the world.
    #[pyo3(get)]
    joint: Option<String>,
    joint_from_frame: Placement<f64>,
}

impl Frame {
    fn of(model: &kinopt::Model, frame: &kinopt::model::Frame) -> Self {
        let name = |joint: JointId| model.joints()[joint.index()].name.clone();
        Self {
            name: frame.name.clone(),
            joint: frame.joint.map(name),
            joint_from_frame: frame.joint_from_frame,
        }
    }
}

#[pymethods]
impl Frame {
    /// Where the frame stands in its joint's frame, shape (4, 4).
    #[getter]
    fn joint_from_frame<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        placement::to_array(py, &self.joint_from_frame)
    }

    fn __repr__(&self) -> String {
        format!(
            "Frame({:?} on {:?})",
            self.name,
            self.joint.as_deref().unwrap_or("world")
        )
    }
}

/// Builds a model joint by joint; joints and frames are known by their names.
///
/// Starts an empty model; `length_unit` is "m", or "units" for lengths of the model's own.
///
/// Raises `InvalidValueError` for another unit.
#[pyclass(module = "kinopt")]
pub(crate) struct ModelBuilder {
    name: String,
    unit: LengthUnit,
    joints: Vec<kinopt::model::Joint>,
    frames: Vec<(String, Option<JointId>, Placement<f64>)>,
    ids: Vec<JointId>,
    /// Hands out ids, in the order in which `build` will.
    numbering: kinopt::model::ModelBuilder,
}

impl ModelBuilder {
    fn parent(&self, name: Option<&str>) -> PyResult<Option<JointId>> {
        let Some(name) = name else { return Ok(None) };
        let found = self.joints.iter().position(|joint| joint.name == name);
        let names = self.joints.iter().map(|joint| joint.name.as_str());
        let id = found.map(|i| self.ids[i]);
        id.ok_or_else(|| kinopt::model::UnknownName::new("joint", name, names))
            .or_raise()
            .map(Some)
    }
}

#[pymethods]
impl ModelBuilder {
    #[new]
    #[pyo3(signature = (name, length_unit = "m"))]
    fn new(name: String, length_unit: &str) -> PyResult<Self> {
        let unit = match length_unit {
            "m" => LengthUnit::Metres,
            "units" => LengthUnit::Own,
            _ => {
                return Err(invalid(format!(
                    "length_unit is {length_unit:?}: \"m\" or \"units\""
                )));
            }
        };
        Ok(Self {
            numbering: kinopt::Model::builder(""),
            name,
            unit,
            joints: Vec::new(),
            frames: Vec::new(),
            ids: Vec::new(),
        })
    }

    /// Adds a joint.
    ///
    /// `kind` is "revolute", "continuous", "prismatic" or "fixed"; `parent` the name of a joint that is
    /// there (None: the world); `parent_from_joint` a 4 x 4 placement, metres (None: the identity);
    /// `axis` three numbers, in the joint's own frame, of any length; `lower` and `upper` radians or
    /// metres.
    ///
    /// Raises `UnknownNameError` for a kind or a parent that does not exist, `InvalidValueError` for a
    /// placement of another shape; what does not go together is said by `build`.
    #[pyo3(signature = (
        name, kind = "revolute", parent = None, parent_from_joint = None, axis = [0.0, 0.0, 1.0],
        lower = f64::NEG_INFINITY, upper = f64::INFINITY
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn joint(
        &mut self,
        name: String,
        kind: &str,
        parent: Option<&str>,
        parent_from_joint: Option<&Bound<'_, PyAny>>,
        axis: [f64; 3],
        lower: f64,
        upper: f64,
    ) -> PyResult<()> {
        let kinds = [
            JointKind::Fixed,
            JointKind::Revolute,
            JointKind::Continuous,
            JointKind::Prismatic,
        ];
        let names = kinds.map(JointKind::name);
        let kind = kinds
            .into_iter()
            .find(|known| known.name() == kind)
            .ok_or_else(|| kinopt::model::UnknownName::new("joint kind", kind, names));
        let placement = match parent_from_joint {
            Some(value) => placement::placement(value, "parent_from_joint")?,
            None => Placement::identity(),
        };
        let parent = self.parent(parent)?;
        let joint = kinopt::model::Joint::new(
            name,
            parent,
            placement,
            kind.or_raise()?,
            axis,
            Limits::new(lower, upper),
        );
        self.ids.push(self.numbering.joint(joint.clone()));
        self.joints.push(joint);
        Ok(())
    }

    /// Adds a frame: a named place on `joint` (None: the world), `joint_from_frame` away, 4 x 4, metres.
    ///
    /// Raises `UnknownNameError` for a joint that does not exist, `InvalidValueError` for a placement of
    /// another shape.
    #[pyo3(signature = (name, joint = None, joint_from_frame = None))]
    fn frame(
        &mut self,
        name: String,
        joint: Option<&str>,
        joint_from_frame: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let placement = match joint_from_frame {
            Some(value) => placement::placement(value, "joint_from_frame")?,
            None => Placement::identity(),
        };
        let joint = self.parent(joint)?;
        self.frames.push((name, joint, placement));
        Ok(())
    }

    /// Checks all and makes the model.
    ///
    /// Raises `InvalidValueError`, which names the joint or frame: names given twice, limits that leave
    /// nothing, axes without a direction, placements that are no rigid motions.
    fn build(&self) -> PyResult<Model> {
        let mut builder = kinopt::Model::builder(self.name.as_str());
        builder.length_unit(self.unit);
        for joint in &self.joints {
            builder.joint(joint.clone());
        }
        for (name, joint, placement) in &self.frames {
            builder.frame(name.as_str(), *joint, *placement);
        }
        builder.build().or_raise().map(Model::from)
    }

    fn __repr__(&self) -> String {
        format!(
            "ModelBuilder({:?}, {} joints)",
            self.name,
            self.joints.len()
        )
    }
}
