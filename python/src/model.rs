//! Models: joints, limits, frames.

use std::sync::Arc;

use kinopt::model::{BallLimits, FrameId, JointId, JointKind, LengthUnit, Limits};
use kinopt::spatial::Placement;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::arrays;
use crate::configuration::of_two;
use crate::error::{OrRaise, invalid};
use crate::loops::{self, NamedLoop, Told};
use crate::pickling;
use crate::placement;

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

    /// The loops that every problem on the model closes: tuples of (name, "connect" or "weld", the two frames' names,
    /// where on them, shape (2, 4, 4): frame_from_place).
    #[getter]
    pub(crate) fn loops<'py>(&self, py: Python<'py>) -> PyResult<Vec<Told<'py>>> {
        loops::told(py, &self.inner)
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

    /// Where a velocity leads from a configuration in a unit of time, limits aside: q + v for joints of one
    /// number, exp for balls and free joints, as Pinocchio's `integrate`. Shapes (nq,) and (nv,), (N, nq) and (N, nv), or
    /// one for all of the other; radians and metres, a ball's and a free joint's in their own moved axes, linear first.
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

    /// The configuration with quaternions of unit length, shape (nq,).
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

/// A whole number, or one drawn from a generator of numpy's.
pub(crate) fn first_seed(seed: &Bound<'_, PyAny>) -> PyResult<u64> {
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
    /// "revolute", "continuous", "prismatic", "ball" or "fixed".
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
    /// Where its value, or a ball's quaternion, begins in a configuration; None for a fixed joint.
    #[pyo3(get)]
    coordinate: Option<usize>,
    /// How far a ball joint may swing about two axes across its own, radians; None for anywhere.
    #[pyo3(get)]
    swing: Option<[f64; 2]>,
    /// How far a ball joint may twist about its axis, radians; None for anywhere.
    #[pyo3(get)]
    twist: Option<(f64, f64)>,
    /// How far a ball may turn in all, radians; None where nothing but swing and twist limits it.
    #[pyo3(get)]
    angle: Option<f64>,
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
            swing: joint.ball.map(|ball| ball.swing),
            twist: joint.ball.map(|ball| (ball.twist.lower, ball.twist.upper)),
            angle: joint.ball.and_then(|ball| ball.angle),
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
    inner: kinopt::model::ModelBuilder,
    /// The joints that others can stand on, by the names they were added by.
    joints: Vec<(String, JointId)>,
    /// The frames that loops can join.
    frames: Vec<(String, FrameId)>,
}

impl ModelBuilder {
    fn parent(&self, name: Option<&str>) -> PyResult<Option<JointId>> {
        let Some(name) = name else { return Ok(None) };
        let found = self.joints.iter().find(|(joint, _)| joint == name);
        let names = self.joints.iter().map(|(joint, _)| joint.as_str());
        found
            .map(|&(_, id)| id)
            .ok_or_else(|| kinopt::model::UnknownName::new("joint", name, names))
            .or_raise()
            .map(Some)
    }

    /// Where a joint stands: its parent and the placement in it.
    fn place(
        &self,
        parent: Option<&str>,
        parent_from_joint: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<(Option<JointId>, Placement<f64>)> {
        let placement = match parent_from_joint {
            Some(value) => placement::placement(value, "parent_from_joint")?,
            None => Placement::identity(),
        };
        Ok((self.parent(parent)?, placement))
    }
}

/// Ranges as limits.
fn room<const N: usize>(room: Option<[(f64, f64); N]>) -> [Limits; N] {
    let free = [Limits::UNBOUNDED; N];
    room.map_or(free, |room| {
        room.map(|(lower, upper)| Limits::new(lower, upper))
    })
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
        let mut inner = kinopt::Model::builder(name);
        inner.length_unit(unit);
        Ok(Self {
            inner,
            joints: Vec::new(),
            frames: Vec::new(),
        })
    }

    /// Adds a joint.
    ///
    /// `kind` is "revolute", "continuous", "prismatic" or "fixed" (`ball`, `free`, `planar` and `universal` add the
    /// others); `parent` the name of a joint that is
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
            .ok_or_else(|| {
                let unknown = kinopt::model::UnknownName::new("joint kind", kind, names);
                unknown.with_note(
                    "others have methods of their own: .ball(), .free(), .planar(), .universal()",
                )
            });
        let (parent, placement) = self.place(parent, parent_from_joint)?;
        let joint = kinopt::model::Joint::new(
            name.as_str(),
            parent,
            placement,
            kind.or_raise()?,
            axis,
            Limits::new(lower, upper),
        );
        let id = self.inner.joint(joint);
        self.joints.push((name, id));
        Ok(())
    }

    /// Adds a ball joint, which turns any way about one point: in a configuration its unit quaternion w, x,
    /// y, z.
    ///
    /// With `swing` (radians, at most pi) it tips its `axis` within a cone of that half angle, or within an
    /// elliptic one of two half angles, about `about` and about what is across that and the axis; `twist` is
    /// the range, (lower, upper) in radians, that it may turn about its axis. `angle` limits the whole rotation, about
    /// whatever axis, in radians. `parent` and `parent_from_joint` are as of `joint`.
    ///
    /// Raises `UnknownNameError` for a parent that does not exist, `InvalidValueError` for a placement of
    /// another shape; what does not go together is said by `build`.
    #[pyo3(signature = (
        name, parent = None, parent_from_joint = None, axis = [1.0, 0.0, 0.0], *, swing = None,
        twist = None, about = None, angle = None
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn ball(
        &mut self,
        name: String,
        parent: Option<&str>,
        parent_from_joint: Option<&Bound<'_, PyAny>>,
        axis: [f64; 3],
        swing: Option<&Bound<'_, PyAny>>,
        twist: Option<(f64, f64)>,
        about: Option<[f64; 3]>,
        angle: Option<f64>,
    ) -> PyResult<()> {
        let (parent, placement) = self.place(parent, parent_from_joint)?;
        let [twist_range] = room(twist.map(|twist| [twist]));
        let limited = swing.is_some() || twist.is_some() || angle.is_some();
        let swing = match swing {
            None => [std::f64::consts::PI; 2],
            Some(swing) => half_angles(swing)?,
        };
        let mut limits = BallLimits::cone(swing[0], twist_range);
        limits.swing = swing;
        limits.about = about.map(Into::into);
        limits.angle = angle;
        let limits = limited.then_some(limits);
        let id = self
            .inner
            .ball(name.as_str(), parent, placement, axis, limits);
        self.joints.push((name, id));
        Ok(())
    }

    /// Adds a joint that moves and turns any way: `NAME/x`, `NAME/y` and `NAME/z`, which slide within `room`
    /// ((lower, upper) three times, metres), and the ball `NAME/rotation`. In a configuration it is x, y, z,
    /// w, x, y, z. Others stand on it by its name.
    ///
    /// Raises as `ball`.
    #[pyo3(signature = (name, parent = None, parent_from_joint = None, *, room = None))]
    fn free(
        &mut self,
        name: String,
        parent: Option<&str>,
        parent_from_joint: Option<&Bound<'_, PyAny>>,
        room: Option<[(f64, f64); 3]>,
    ) -> PyResult<()> {
        let (parent, placement) = self.place(parent, parent_from_joint)?;
        let room = self::room(room);
        let id = self.inner.free(name.as_str(), parent, placement, room);
        self.joints.push((name, id));
        Ok(())
    }

    /// Adds a joint that moves in the plane across `normal`: `NAME/x` and `NAME/y`, which slide within `room`
    /// ((lower, upper) twice, metres), and `NAME/yaw`, which turns within `yaw` (radians). Others stand on it by
    /// its name.
    ///
    /// Raises as `ball`.
    #[pyo3(signature = (
        name, parent = None, parent_from_joint = None, normal = [0.0, 0.0, 1.0], *, room = None, yaw = None
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn planar(
        &mut self,
        name: String,
        parent: Option<&str>,
        parent_from_joint: Option<&Bound<'_, PyAny>>,
        normal: [f64; 3],
        room: Option<[(f64, f64); 2]>,
        yaw: Option<(f64, f64)>,
    ) -> PyResult<()> {
        let (parent, placement) = self.place(parent, parent_from_joint)?;
        let (room, [yaw]) = (self::room(room), self::room(yaw.map(|yaw| [yaw])));
        let id = (self.inner).planar(name.as_str(), parent, placement, normal, room, yaw);
        self.joints.push((name, id));
        Ok(())
    }

    /// Adds a universal joint: `NAME/first`, which turns about the first of two `axes` (each three numbers), and
    /// `NAME/second`, which turns about the second as the first has turned it, within `limits` ((lower, upper) twice,
    /// radians). Others stand on it by its name.
    ///
    /// Raises as `ball`.
    #[pyo3(signature = (
        name, parent = None, parent_from_joint = None, axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], *, limits = None
    ))]
    fn universal(
        &mut self,
        name: String,
        parent: Option<&str>,
        parent_from_joint: Option<&Bound<'_, PyAny>>,
        axes: [[f64; 3]; 2],
        limits: Option<[(f64, f64); 2]>,
    ) -> PyResult<()> {
        let (parent, placement) = self.place(parent, parent_from_joint)?;
        let (axes, limits) = (axes.map(Into::into), room(limits));
        let id = (self.inner).universal(name.as_str(), parent, placement, axes, limits);
        self.joints.push((name, id));
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
        let id = self.inner.frame(name.as_str(), joint, placement);
        self.frames.push((name, id));
        Ok(())
    }

    /// Adds a loop: the origins of two `frames` that are there fall together ("connect"), or origins and axes
    /// ("weld"); with `places`, a pair of 4 x 4 placements, not the frames themselves but those places on them. Every
    /// problem on the model keeps it closed.
    ///
    /// Raises `UnknownNameError` for a kind or a frame that does not exist; what does not go together, and a loop that
    /// no configuration closes, is said by `build`.
    #[pyo3(signature = (name, frames, kind = "connect", places = None))]
    fn close(
        &mut self,
        name: String,
        frames: [String; 2],
        kind: &str,
        places: Option<[Bound<'_, PyAny>; 2]>,
    ) -> PyResult<()> {
        let own = NamedLoop::new(name, frames, kind, places)?;
        let id = |name: &String| -> PyResult<FrameId> {
            let found = self.frames.iter().find(|(frame, _)| frame == name);
            let names = self.frames.iter().map(|(frame, _)| frame.as_str());
            let unknown = || kinopt::model::UnknownName::new("frame", name, names);
            found.map(|&(_, id)| id).ok_or_else(unknown).or_raise()
        };
        let frames = [id(&own.frames[0])?, id(&own.frames[1])?];
        self.inner.close(own.of(frames));
        Ok(())
    }

    /// Checks all and makes the model.
    ///
    /// Raises `InvalidValueError`, which names the joint or frame: names given twice, limits that leave
    /// nothing, axes without a direction, placements that are no rigid motions.
    fn build(&self) -> PyResult<Model> {
        self.inner.clone().build().or_raise().map(Model::from)
    }

    fn __repr__(&self) -> String {
        format!("ModelBuilder({} joints)", self.joints.len())
    }
}

/// One half angle of a cone, or two of an elliptic one.
fn half_angles(swing: &Bound<'_, PyAny>) -> PyResult<[f64; 2]> {
    let cone = swing.extract().map(|half| [half; 2]);
    cone.or_else(|_| swing.extract()).map_err(|_| {
        invalid(format!(
            "swing must be a half angle in radians, or two of them, not {}",
            arrays::shown(swing)
        ))
    })
}
