//! Robots from URDF and MJCF.

mod coordinate_order;
mod shape;
mod source;

use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use kinopt::collision::Checker;
use kinopt::kinematics::{ForwardKinematics, Jacobian};
use kinopt::model::JointKind;
use kinopt::motion::retarget::FootShapes;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

use coordinate_order::CoordinateOrder;
pub(crate) use shape::Shape;
pub(crate) use source::text_of;
use source::{
    Base, Loops, PickledBase, PickledLimits, PickledLoops, PickledTool, Source, restricts_sources,
};

use crate::arrays;
use crate::collision::{CollisionModel, Taking};
use crate::configuration::of_one;
use crate::error::{OrRaise, invalid};
use crate::kinematics::jacobians;
use crate::loops::{self, LoopParts, NamedLoop};
use crate::masses::{centres, centres_jacobians};
use crate::model::{Model, random_configurations};
use crate::pickling;
use crate::placement;
use crate::pool::Pool;
use crate::srdf::Srdf;

/// A robot: a model with its joints that follow others, its speeds, shapes and masses.
///
/// Every link is a frame under the link's name; the root link stands in the world. A configuration lists
/// the joints that move in the order of the file.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Robot {
    pub(crate) inner: Arc<kinopt::robot::Robot>,
    pub(crate) model: Arc<kinopt::Model>,
    source: Source,
    /// Its shapes and the spheres that cover them, made when a world is first kept clear of.
    checker: OnceLock<Checker>,
    foot_shapes: OnceLock<FootShapes>,
}

impl Robot {
    fn build(source: Source) -> PyResult<Self> {
        let robot = source.read()?;
        Ok(Self {
            model: Arc::new(robot.model().clone()),
            inner: Arc::new(robot),
            source,
            checker: OnceLock::new(),
            foot_shapes: OnceLock::new(),
        })
    }

    /// What keeps its shapes apart, in a world without obstacles.
    pub(crate) fn checker(&self) -> PyResult<Checker> {
        if let Some(known) = self.checker.get() {
            return Ok(known.clone());
        }
        let made = Checker::of(&self.inner).or_raise()?;
        Ok(self.checker.get_or_init(|| made).clone())
    }

    /// The shapes that its feet stand on, found once.
    pub(crate) fn foot_shapes(&self) -> FootShapes {
        let found = || FootShapes::of_files(&self.inner);
        self.foot_shapes.get_or_init(found).clone()
    }

    fn pinocchio_order(&self) -> PyResult<CoordinateOrder> {
        if self.source.is_mjcf() {
            return Err(invalid(
                "the order of Pinocchio is known for robots from URDF, not from MJCF: use to_mujoco",
            ));
        }
        // Limits that were added make a continuous joint one with limits, but not in Pinocchio.
        let stated = self.source.stated()?;
        let kind = |joint: &str| {
            let id = stated.joint(joint).ok()?;
            Some(stated.joints()[id.index()].kind)
        };
        Ok(CoordinateOrder::of_pinocchio(&self.model, |joint| {
            kind(joint) == Some(JointKind::Continuous)
        }))
    }

    fn mujoco_order(&self) -> CoordinateOrder {
        match self.source.is_mjcf() {
            true => CoordinateOrder::same(&self.model),
            false => CoordinateOrder::of_mujoco(&self.model),
        }
    }

    fn per_joint<'py>(
        &self,
        py: Python<'py>,
        value: impl Fn(kinopt::model::JointId) -> Option<f64>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let joints = self.model.moving_joints().iter();
        arrays::frozen(py, joints.map(|&id| value(id).unwrap_or(f64::INFINITY)))
    }
}

#[pymethods]
impl Robot {
    /// Reads a URDF file.
    ///
    /// With `base_joint` the robot moves as a whole: "free" any way (a configuration begins with x, y, z and
    /// the quaternion w, x, y, z), "planar" over the ground (x, y and a turn about z), "slide-x", "slide-y" or
    /// "slide-z" along an axis; "fixed", as without, not at all. `base_room` says where it may stand: a dict of
    /// (lower, upper) for "x", "y" and "z" in metres and, of a planar base, "yaw" in radians. A robot that moves
    /// freely by a joint of its own has that one as its free base.
    ///
    /// With `lenient` what can be mended in one way only is mended, and listed in `repairs`. With
    /// `soft_limits` every joint also keeps within its safety controller's limits. Files of meshes are not
    /// opened here. With `confine` they are opened only below the folder of `path` and below the `packages` of
    /// `collision_model`, for files that are not trusted.
    ///
    /// `mimic_limits`: the limits that restrict a joint which mimic joints follow. "source": its own. If they move a mimic joint
    /// out of its range, `repairs` notes both joints, and the limits of the mimic joint contain the values. "both": also the
    /// ranges of its mimic joints.
    ///
    /// Raises `FileError` where it cannot be read, `InvalidFileError`, which names the element, for what is
    /// wrong in it.
    #[classmethod]
    #[pyo3(signature = (
        path, *, base_joint = None, base_room = None, lenient = false, soft_limits = false, mimic_limits = "source", confine = false
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn from_urdf(
        _class: &Bound<'_, PyType>,
        path: PathBuf,
        base_joint: Option<Bound<'_, PyAny>>,
        base_room: Option<Bound<'_, PyDict>>,
        lenient: bool,
        soft_limits: bool,
        mimic_limits: &str,
        confine: bool,
    ) -> PyResult<Self> {
        let (text, file) = text_of(&path)?;
        Self::build(Source {
            text: text.into(),
            file,
            lenient,
            confine,
            soft_limits,
            mimic_limits: restricts_sources(mimic_limits)?,
            joint_limits: Vec::new(),
            base: Base::new(base_joint, base_room)?,
            tools: Vec::new(),
            loops: Loops::default(),
        })
    }

    /// Reads an MJCF file, as MuJoCo's models are written in, with the files that it includes.
    ///
    /// Bodies and sites are frames under their names (unnamed ones: `body/ID`, `BODY/site`; the world's is
    /// `world`), and a configuration is MuJoCo's `qpos`: a free joint's x, y, z and quaternion w, x, y, z, a
    /// ball's quaternion, `ref` counted in. Joints that a linear `equality` couples follow; `connect` and `weld`
    /// are `loops`. What is left out is in `repairs`. Files of meshes are not opened here. `base_joint`,
    /// `base_room` and `mimic_limits` are as of `from_urdf`. With `confine` files are included, and meshes opened later, only
    /// below the folder of `path`, for files that are not trusted.
    ///
    /// Raises `FileError` where it cannot be read, `InvalidFileError`, which names the element, for what is
    /// wrong in it.
    #[classmethod]
    #[pyo3(signature = (path, *, base_joint = None, base_room = None, mimic_limits = "source", confine = false))]
    fn from_mjcf(
        _class: &Bound<'_, PyType>,
        path: PathBuf,
        base_joint: Option<Bound<'_, PyAny>>,
        base_room: Option<Bound<'_, PyDict>>,
        mimic_limits: &str,
        confine: bool,
    ) -> PyResult<Self> {
        // Faults are told by the lines of the file, which the text of all files together has not.
        let reader = kinopt::robot::Robot::mjcf_reader();
        let reader = if confine { reader.confined() } else { reader };
        reader.read(&path).or_raise()?;
        let text = reader.text_with_includes(&path);
        Self::build(Source {
            text: text.or_raise()?.into(),
            file: path.display().to_string(),
            lenient: false,
            confine,
            soft_limits: false,
            mimic_limits: restricts_sources(mimic_limits)?,
            joint_limits: Vec::new(),
            base: Base::new(base_joint, base_room)?,
            tools: Vec::new(),
            loops: Loops::default(),
        })
    }

    /// Reads a URDF document from a string; `name` is what messages call it, the rest is as of `from_urdf`.
    ///
    /// Raises `InvalidFileError`, which names the element, for what is wrong in it.
    #[classmethod]
    #[pyo3(signature = (
        text, name = "robot.urdf", *, base_joint = None, base_room = None, lenient = false, soft_limits = false,
        mimic_limits = "source", confine = false
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn from_urdf_text(
        _class: &Bound<'_, PyType>,
        text: &str,
        name: &str,
        base_joint: Option<Bound<'_, PyAny>>,
        base_room: Option<Bound<'_, PyDict>>,
        lenient: bool,
        soft_limits: bool,
        mimic_limits: &str,
        confine: bool,
    ) -> PyResult<Self> {
        Self::build(Source {
            text: text.into(),
            file: name.to_owned(),
            lenient,
            confine,
            soft_limits,
            mimic_limits: restricts_sources(mimic_limits)?,
            joint_limits: Vec::new(),
            base: Base::new(base_joint, base_room)?,
            tools: Vec::new(),
            loops: Loops::default(),
        })
    }

    /// Whether meshes are opened only below the folder of the robot's file: see `confine` of `from_urdf`.
    #[getter]
    fn confined(&self) -> bool {
        self.inner.is_confined()
    }

    /// The same robot with the limits of MoveIt's joint_limits.yaml: `max_velocity`, `max_acceleration`, `max_jerk`, and `min_position` and
    /// `max_position`, which narrow what the robot's file says.
    ///
    /// Raises `FileError` where it cannot be read, `InvalidFileError`, which names the line, for what is wrong in it.
    fn with_joint_limits(&self, path: PathBuf) -> PyResult<Self> {
        let (text, file) = text_of(&path)?;
        let mut source = self.source.clone();
        source.joint_limits.push((text.into(), file));
        Self::build(source)
    }

    /// The same robot with one more frame, `name`, which stands `link_from_tool` (4 x 4, metres) away from
    /// the frame `link`.
    ///
    /// Raises `UnknownNameError` for a link that there is not, `InvalidValueError` for a name that is taken
    /// and for what is no rigid motion.
    fn with_tool(
        &self,
        name: String,
        link: String,
        link_from_tool: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let tool = placement::placement(link_from_tool, "link_from_tool")?;
        let mut source = self.source.clone();
        source.tools.push((name, link, tool));
        Self::build(source)
    }

    /// Its joints, frames and limits.
    #[getter]
    fn model(&self) -> Model {
        let inner = Arc::clone(&self.model);
        Model { inner }
    }

    /// The robot's name.
    #[getter]
    fn name(&self) -> &str {
        self.model.name()
    }

    /// Names of the moving joints, in the order of a configuration.
    #[getter]
    fn joint_names(&self) -> Vec<String> {
        self.model()
            .joint_names()
            .into_iter()
            .map(str::to_owned)
            .collect()
    }

    /// Names of all frames: the links, and tools that were added.
    #[getter]
    fn frame_names(&self) -> Vec<String> {
        self.model()
            .frame_names()
            .into_iter()
            .map(str::to_owned)
            .collect()
    }

    /// How many numbers a configuration has, nq: four for a ball joint, one for any other.
    #[getter]
    fn configuration_len(&self) -> usize {
        self.model.configuration_len()
    }

    /// How many numbers a velocity has, nv: three for a ball joint, one for any other.
    #[getter]
    fn degrees_of_freedom(&self) -> usize {
        self.model.degrees_of_freedom()
    }

    /// Names of the numbers of a configuration: see `Model.coordinate_names`.
    #[getter]
    fn coordinate_names(&self) -> Vec<String> {
        self.model().coordinate_names()
    }

    /// Lower limits in configuration order, shape (nq,), radians or metres; -inf for none.
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.model().lower(py)
    }

    /// Upper limits in configuration order, shape (nq,), radians or metres; inf for none.
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.model().upper(py)
    }

    /// Highest speeds in configuration order, shape (nq,), rad/s or m/s; inf for none.
    #[getter]
    fn velocity_limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.per_joint(py, |id| self.inner.velocity_limit(id))
    }

    /// Acceleration limits in configuration order, shape (nq,), rad/s² or m/s²; inf for none. From the URDF's `<limit acceleration>`
    /// or `with_joint_limits`.
    #[getter]
    fn acceleration_limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.per_joint(py, |id| self.inner.acceleration_limit(id))
    }

    /// Jerk limits in configuration order, shape (nq,), rad/s³ or m/s³; inf for none. From the URDF's `<limit jerk>` or
    /// `with_joint_limits`.
    #[getter]
    fn jerk_limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.per_joint(py, |id| self.inner.jerk_limit(id))
    }

    /// Strongest torques and forces in configuration order, shape (nq,), N m or N; inf for none.
    #[getter]
    fn effort_limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.per_joint(py, |id| self.inner.effort_limit(id))
    }

    /// Names of the frames on which nothing hangs: hands, tools, feet.
    #[getter]
    fn tips(&self) -> Vec<String> {
        let frames = self.inner.tips();
        frames
            .into_iter()
            .map(|id| self.model.frames()[id.index()].name.clone())
            .collect()
    }

    /// What the file leaves to defaults or gets wrong and what was taken instead, one text each.
    #[getter]
    fn repairs(&self) -> Vec<String> {
        self.inner
            .repairs()
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    /// The joints that follow others: {joint: (master, ratio, offset)}, value = ratio * master + offset.
    #[getter]
    fn mimics<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let name = |id: kinopt::model::JointId| self.model.joints()[id.index()].name.as_str();
        let mimics = PyDict::new(py);
        for mimic in self.inner.mimics() {
            let follows = (name(mimic.master), mimic.ratio, mimic.offset);
            mimics.set_item(name(mimic.joint), follows)?;
        }
        Ok(mimics)
    }

    /// Loops of the model, of an MJCF file its `connect` and `weld`: see `Model.loops`.
    #[getter]
    fn loops<'py>(&self, py: Python<'py>) -> PyResult<Vec<LoopParts<'py>>> {
        loops::loop_parts(py, &self.model)
    }

    /// Names of the joints that nothing drives: of an MJCF file with actuators those that none of them moves, by
    /// itself or through a fixed tendon, and that follow no other; else those that were said to be.
    #[getter]
    fn passive_joints(&self) -> Vec<&str> {
        let joints = self.inner.passive_joints().iter();
        joints
            .map(|id| self.model.joints()[id.index()].name.as_str())
            .collect()
    }

    /// The same robot with a loop that its file does not know of, as URDF has none: the origins of two `frames` fall
    /// together ("connect"), or origins and axes ("weld"); with `places`, a pair of 4 x 4 placements, not the frames
    /// themselves but those places on them. Every problem on the robot keeps it closed.
    ///
    /// Raises `UnknownNameError` for a kind or a frame that there is not, `InvalidValueError` for a name that is
    /// taken, what is no rigid motion, and a loop that no configuration closes.
    #[pyo3(signature = (name, frames, kind = "connect", places = None))]
    fn with_loop(
        &self,
        name: String,
        frames: [String; 2],
        kind: &str,
        places: Option<[Bound<'_, PyAny>; 2]>,
    ) -> PyResult<Self> {
        let mut source = self.source.clone();
        let own = NamedLoop::new(name, frames, kind, places)?;
        source.loops.added.push(own);
        Self::build(source)
    }

    /// The same robot without loops, for a file whose loops contradict each other or are not meant.
    fn without_loops(&self) -> PyResult<Self> {
        let mut source = self.source.clone();
        source.loops.added.clear();
        source.loops.without = true;
        Self::build(source)
    }

    /// The same robot with these as its `passive_joints`, as an SRDF file names them.
    ///
    /// Raises `UnknownNameError` for a joint that there is not.
    fn with_passive_joints(&self, names: Vec<String>) -> PyResult<Self> {
        let mut source = self.source.clone();
        source.loops.passive = Some(names);
        Self::build(source)
    }

    /// Names of the moving joints between two frames, from base to tip.
    ///
    /// Raises `UnknownNameError` for a frame that there is not.
    fn chain(&self, base: &str, tip: &str) -> PyResult<Vec<String>> {
        let ids = self.inner.chain(base, tip).or_raise()?;
        Ok(ids
            .into_iter()
            .map(|id| self.model.joints()[id.index()].name.clone())
            .collect())
    }

    /// The configuration `q`, shape (n,), with a free base a fifteenth of its height lower, the frames `feet` where they
    /// are and the rest near `q`: knees bent a little, so that a hand that is dragged down bends them more. `up` is
    /// the way up, shape (3,). A robot without a free base, and one whose feet cannot stay, keeps `q`.
    ///
    /// Raises `UnknownNameError` for a frame that there is not, `InvalidValueError` for another shape.
    #[pyo3(signature = (feet, q, *, up = None))]
    fn bent_stance<'py>(
        &self,
        py: Python<'py>,
        feet: Vec<String>,
        q: &Bound<'py, PyAny>,
        up: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let feet = feet.iter().map(|foot| self.model.frame(foot).or_raise());
        let feet = feet.collect::<PyResult<Vec<_>>>()?;
        let q = arrays::vector_of(q, "q", self.model.configuration_len())?.to_vec();
        let up = match up {
            Some(up) => arrays::array(up, "up")?,
            None => [0.0, 0.0, 1.0],
        };
        let (model, map) = (&self.model, self.inner.map());
        let stance = py.detach(|| kinopt::ik::bent_stance(model, map, &feet, &q, up));
        Ok(arrays::list(py, &stance.or_raise()?))
    }

    /// What a link looks like: a list of `Shape`; empty for frames that are no links.
    ///
    /// Raises `UnknownNameError` for a frame that there is not.
    #[pyo3(signature = (link, *, collision = false))]
    fn shapes(&self, link: &str, collision: bool) -> PyResult<Vec<Shape>> {
        let frame = self.model.frame(link).or_raise()?;
        let Some(link) = self.inner.link(frame) else {
            return Ok(Vec::new());
        };
        let shapes = if collision {
            &link.collisions
        } else {
            &link.visuals
        };
        Ok(shapes.iter().map(Shape::of).collect())
    }

    /// Points that a foot stands on, in its frame, shape (N, 3), metres: where the links begin that are fixed to it, its own
    /// first, and the corners of their collision shapes. `tasks.SupportPolygon(on={foot: robot.sole(foot)})` balances over it.
    /// Meshes' files are not opened: they add none.
    ///
    /// Raises `UnknownNameError` for a frame that there is not.
    fn sole<'py>(&self, py: Python<'py>, foot: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = self.inner.sole(self.model.frame(foot).or_raise()?);
        let numbers: Vec<f64> = points.iter().flat_map(|point| point.to_array()).collect();
        arrays::list(py, &numbers).reshape([points.len(), 3])
    }

    /// The mass of all links that joints move, kg. Raises `InvalidValueError` where the file states none, or leaves one to
    /// the volume of a mesh, as MJCF without `inertial` does: the mesh's file is not opened.
    #[getter]
    fn mass(&self) -> PyResult<f64> {
        self.inner.total_mass().or_raise()
    }

    /// Where the centre of mass is: shape (3,) for a configuration `q` of shape (nq,), (N, 3) for (N, nq); metres, in
    /// the world.
    ///
    /// Masses are those of the file's links (`<inertial>`); what stands in the world counts for nothing, as in
    /// Pinocchio. Raises `InvalidValueError` where the file states none, or a negative one, or leaves one or its centre to a
    /// mesh (MJCF), and for other shapes.
    fn center_of_mass<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        centres(q, &self.model, &self.inner.masses().or_raise()?)
    }

    /// How the centre of mass moves: its Jacobian, three rows in m/s in world axes, a column for each number of a
    /// velocity; shape (3, nv) for a configuration `q` of shape (nq,), (N, 3, nv) for (N, nq).
    ///
    /// Raises `InvalidValueError` as `center_of_mass`.
    fn center_of_mass_jacobian<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        centres_jacobians(q, &self.model, &self.inner.masses().or_raise()?)
    }

    /// The configuration closest to all zeros within the limits, shape (nq,), radians and metres, quaternions w, x, y, z. Mimic joints
    /// have the values that their source joints give them.
    fn neutral<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.inner.neutral())
    }

    /// Configurations sampled uniformly within the limits, shape (nq,) or (n, nq): see `Model.random_configuration`. Mimic joints
    /// have the values that their source joints give them.
    ///
    /// Raises `InvalidValueError` for a seed or an `n` that is no whole number of at least 0.
    #[pyo3(signature = (seed = None, n = None))]
    fn random_configuration<'py>(
        &self,
        py: Python<'py>,
        seed: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] n: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (robot, nq) = (&self.inner, self.model.configuration_len());
        random_configurations(py, seed, n, nq, |seed| robot.random_configuration(seed))
    }

    /// Where a velocity leads from a configuration in a unit of time, limits aside: q + v for joints of one
    /// number, exp for balls and free joints, as Pinocchio's `integrate`. Shapes (nq,) and (nv,), (N, nq) and (N, nv), or
    /// one for all of the other; radians and metres, a ball's and a free joint's in their own moved axes, linear first.
    /// Quaternions of `q` are w, x, y, z.
    ///
    /// Raises `InvalidValueError` for other shapes, numbers that are not finite, quaternions of length zero.
    fn integrate<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.model().integrate(q, v)
    }

    /// The velocity that leads from `q0` to `q1` in a unit of time, as Pinocchio's `difference`. Shapes
    /// (nq,) twice, (N, nq) twice, or one for all of the other.
    ///
    /// Raises `InvalidValueError` as `integrate`.
    fn difference<'py>(
        &self,
        q0: &Bound<'py, PyAny>,
        q1: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.model().difference(q0, q1)
    }

    /// The configuration at a share of the way from `q0` to `q1`. Shapes as of `difference`.
    ///
    /// Raises `InvalidValueError` as `integrate`, and for a share that is not finite.
    fn interpolate<'py>(
        &self,
        q0: &Bound<'py, PyAny>,
        q1: &Bound<'py, PyAny>,
        share: f64,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.model().interpolate(q0, q1, share)
    }

    /// The configuration with quaternions w, x, y, z of unit length, shape (nq,).
    ///
    /// Raises `InvalidValueError` as `integrate`.
    fn normalise<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.model().normalise(q)
    }

    /// Whether a configuration, shape (nq,), is within all limits, cones included, and has every mimic joint at the value that its
    /// source joint gives it, up to 1e-9 rad or m.
    ///
    /// Raises `InvalidValueError` for another shape.
    fn is_within_limits(&self, q: &Bound<'_, PyAny>) -> PyResult<bool> {
        let q = arrays::vector_of(q, "q", self.model.configuration_len())?;
        Ok(self.inner.is_within_limits(&q))
    }

    /// The configuration with mimic joints at the values that their source joints in it give them. Shape (nq,) for `q` of shape (nq,),
    /// (N, nq) for (N, nq), radians and metres. Forward kinematics takes a configuration as it is.
    ///
    /// Raises `InvalidValueError` for other shapes and for numbers that are not finite.
    fn apply_mimics<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let nq = self.model.configuration_len();
        of_one((q, "q", nq), nq, |q, applied| {
            applied.copy_from_slice(&self.inner.apply_mimics(q)?);
            Ok(())
        })
    }

    /// The configuration as Pinocchio's `buildModelFromUrdf` has it for the robot's URDF, with a root joint for `base_joint`: joints
    /// depth first, siblings by name; quaternions x, y, z, w (here w, x, y, z); the cosine and sine of a continuous joint (here
    /// its angle). Shape (n,) for `q` of shape (nq,), (N, n) for (N, nq), radians and metres.
    ///
    /// Raises `InvalidValueError` for other shapes and for a robot from MJCF.
    fn to_pinocchio<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let order = self.pinocchio_order()?;
        let nq = self.model.configuration_len();
        of_one((q, "q", nq), order.len(), |q, other| {
            order.write(q, other);
            Ok(())
        })
    }

    /// The configuration of a `q` in the order of Pinocchio, shape (n,) or (N, n): the inverse of `to_pinocchio`. Continuous joints are
    /// from -pi to pi.
    ///
    /// Raises `InvalidValueError` as `to_pinocchio`.
    #[allow(
        clippy::wrong_self_convention,
        reason = "the name in Python, beside `to_`"
    )]
    fn from_pinocchio<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let order = self.pinocchio_order()?;
        let nq = self.model.configuration_len();
        of_one((q, "q", order.len()), nq, |other, q| {
            order.read(other, q);
            Ok(())
        })
    }

    /// The configuration as MuJoCo's `qpos` for the robot's file: joints depth first, siblings in the order of the file, quaternions
    /// w, x, y, z as here. For a robot from MJCF it is `q` itself. Shape (nq,) for `q` of shape (nq,), (N, nq) for (N, nq),
    /// radians and metres.
    ///
    /// Raises `InvalidValueError` for other shapes.
    fn to_mujoco<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let order = self.mujoco_order();
        let nq = self.model.configuration_len();
        of_one((q, "q", nq), nq, |q, other| {
            order.write(q, other);
            Ok(())
        })
    }

    /// The configuration of MuJoCo's `qpos`, shape (nq,) or (N, nq): the inverse of `to_mujoco`.
    ///
    /// Raises `InvalidValueError` as `to_mujoco`.
    #[allow(
        clippy::wrong_self_convention,
        reason = "the name in Python, beside `to_`"
    )]
    fn from_mujoco<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let order = self.mujoco_order();
        let nq = self.model.configuration_len();
        of_one((q, "q", nq), nq, |other, q| {
            order.read(other, q);
            Ok(())
        })
    }

    /// The Jacobian of a frame, shape (6, nv) for a configuration `q` of shape (nq,), (N, 6, nv) for (N, nq): the
    /// velocity of its origin (m/s), then its angular velocity (rad/s), in world axes, for velocities as of `integrate`:
    /// Pinocchio's `LOCAL_WORLD_ALIGNED`. `kinopt.Jacobian` does the same for several frames.
    ///
    /// Raises `UnknownNameError` for a frame that there is not, `InvalidValueError` as `integrate`.
    fn frame_jacobian<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        frame: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let id = self.model.frame(frame).or_raise()?;
        let kinematics = ForwardKinematics::of_frames(&self.model, &[id]).or_raise()?;
        jacobians(q, &Pool::new(Jacobian::new(kinematics)), 1)
    }

    /// The collision shapes of its links.
    ///
    /// Meshes are looked for beside the robot's file and, at `package://`, in the folders above it and in `packages`;
    /// they count as their convex hulls, with `meshes="parts"` as the hulls of their connected parts, with "pieces" as up
    /// to 16 convex pieces that hold them, with "triangles" as they are. One that is not found is an error, or with `leave_out_missing` left out with a note. An `srdf` says
    /// which links may touch.
    ///
    /// Raises `FileError` for a mesh that is not there, `InvalidFileError` for one that is damaged, `InvalidValueError`
    /// for a shape that is none.
    #[pyo3(
        signature = (*, packages = Vec::new(), meshes = "hull", leave_out_missing = false, srdf = None),
        text_signature = "(self, *, packages=[], meshes=\"hull\", leave_out_missing=False, srdf=None)"
    )]
    fn collision_model(
        &self,
        py: Python<'_>,
        packages: Vec<PathBuf>,
        meshes: &str,
        leave_out_missing: bool,
        srdf: Option<&Srdf>,
    ) -> PyResult<CollisionModel> {
        let taking = Taking {
            packages,
            meshes: meshes.to_owned(),
            leave_out_missing,
        };
        let model = py.detach(|| CollisionModel::of(&self.inner, &taking))?;
        match srdf {
            Some(srdf) => model.with_srdf(srdf),
            None => Ok(model),
        }
    }

    #[classmethod]
    #[allow(clippy::too_many_arguments, reason = "it is what `__reduce__` gives")]
    fn _rebuild(
        _class: &Bound<'_, PyType>,
        text: &str,
        file: String,
        reading: (bool, bool),
        limits: PickledLimits,
        base: PickledBase<'_>,
        tools: Vec<PickledTool<'_>>,
        loops: PickledLoops<'_>,
    ) -> PyResult<Self> {
        Self::build(Source::unpickled(
            text, file, reading, limits, base, tools, loops,
        )?)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_rebuild::<Self>(py, self.source.pickled(py)?)
    }

    fn __repr__(&self) -> String {
        format!(
            "Robot({:?}, {} degrees of freedom, {} links)",
            self.model.name(),
            self.model.degrees_of_freedom(),
            self.model.frames().len()
        )
    }
}
