//! Robots from URDF and MJCF.

mod class;
mod shape;
mod source;

use std::path::PathBuf;
use std::sync::Arc;

use kinopt::kinematics::{ForwardKinematics, Jacobian};
use kinopt_bindings::names::{MIMIC_LIMITS, named};
use kinopt_bindings::option::robot::RobotOptions;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

pub(crate) use class::Robot;
pub(crate) use shape::Shape;
pub(crate) use source::text_of;
use source::{PickledBase, PickledLimits, PickledLoops, PickledTool, Source, base_of};

use crate::arrays;
use crate::collision::{CollisionModel, CollisionOptions};
use crate::configuration::of_one;
use crate::error::{OrRaise, invalid};
use crate::kinematics::jacobians;
use crate::masses::{centres, centres_jacobians};
use crate::model::{Model, random_configurations};
use crate::named_loop::{self, LoopParts, NamedLoop};
use crate::pickling;
use crate::placement;
use crate::pool::Pool;
use crate::srdf::Srdf;

#[pymethods]
impl Robot {
    /// Reads a URDF file.
    ///
    /// `base_joint` connects the root to the world. It is "fixed", the default, "free", "planar" (x, y and a rotation
    /// about z), or "slide-x", "slide-y" or "slide-z" (translation along an axis). With a free base a configuration
    /// begins with x, y, z and the quaternion w, x, y, z. `base_bounds` limits its position: a dict of (lower, upper) for "x", "y" and "z" in
    /// metres and, for a planar base, "yaw" in radians. A free joint of the file at the root serves as the free base.
    ///
    /// With `lenient`, defects that have a unique repair are repaired, and listed in `repairs`. With `soft_limits`,
    /// every joint also stays within its safety controller's limits. Mesh files are not opened here. With `confine`
    /// they are opened only below the folder of `path` and below the `packages` of `collision_model`, for files that
    /// are not trusted.
    ///
    /// `mimic_limits`: the limits that restrict the source joint of mimic joints. "source": its own. If they move a
    /// mimic joint out of its range, `repairs` notes both joints, and the limits of the mimic joint contain the values.
    /// "both": also the ranges of its mimic joints.
    ///
    /// Raises `FileError` if the file cannot be read, `InvalidFileError`, which names the element, if its content is
    /// invalid.
    #[classmethod]
    #[pyo3(signature = (
        path, *, base_joint = None, base_bounds = None, lenient = false, soft_limits = false, mimic_limits = "source", confine = false
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn from_urdf(
        _class: &Bound<'_, PyType>,
        path: PathBuf,
        base_joint: Option<Bound<'_, PyAny>>,
        base_bounds: Option<Bound<'_, PyDict>>,
        lenient: bool,
        soft_limits: bool,
        mimic_limits: &str,
        confine: bool,
    ) -> PyResult<Self> {
        let (text, file) = text_of(&path)?;
        Self::build(Source {
            text: text.into(),
            file,
            options: RobotOptions {
                lenient,
                confine,
                soft_limits,
                mimic_limits: named("mimic_limits", mimic_limits, &MIMIC_LIMITS).or_raise()?,
                base: base_of(base_joint, base_bounds)?,
            },
            ..Source::default()
        })
    }

    /// Reads a robot file. Its root element selects the format: URDF, as `from_urdf`, or MJCF, as `from_mjcf`.
    ///
    /// Raises `FileError` if the file cannot be read, `InvalidFileError`, which names the element, if its content is
    /// invalid, and `InvalidValueError` for `lenient` and `soft_limits` of an MJCF file.
    #[classmethod]
    #[pyo3(signature = (
        path, *, base_joint = None, base_bounds = None, lenient = false, soft_limits = false, mimic_limits = "source", confine = false
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn read(
        class: &Bound<'_, PyType>,
        path: PathBuf,
        base_joint: Option<Bound<'_, PyAny>>,
        base_bounds: Option<Bound<'_, PyDict>>,
        lenient: bool,
        soft_limits: bool,
        mimic_limits: &str,
        confine: bool,
    ) -> PyResult<Self> {
        let (base, bounds) = (base_joint, base_bounds);
        if !kinopt::robot::Robot::is_mjcf(&text_of(&path)?.0) {
            return Self::from_urdf(
                class,
                path,
                base,
                bounds,
                lenient,
                soft_limits,
                mimic_limits,
                confine,
            );
        }
        match lenient || soft_limits {
            true => Err(invalid(
                "lenient and soft_limits apply to URDF files, not to MJCF: remove them",
            )),
            false => Self::from_mjcf(class, path, base, bounds, mimic_limits, confine),
        }
    }

    /// Reads an MJCF file (MuJoCo), with the files that it includes.
    ///
    /// Bodies and sites are frames of their names (unnamed ones: `body/ID`, `BODY/site`; the world is `world`). A
    /// configuration is MuJoCo's `qpos`, including `ref`: a free joint's x, y, z and quaternion w, x, y, z, and a
    /// ball's quaternion. A joint `equality` of degree one makes a mimic joint; `connect` and `weld` are `loops`.
    /// Ignored elements are in `repairs`. Mesh files are not opened here. `base_joint`, `base_bounds` and
    /// `mimic_limits` are as in `from_urdf`. With `confine`, files are included, and meshes opened later, only below
    /// the folder of `path`, for files that are not trusted.
    ///
    /// Raises `FileError` if the file cannot be read, `InvalidFileError`, which names the element, if its content is
    /// invalid.
    #[classmethod]
    #[pyo3(signature = (path, *, base_joint = None, base_bounds = None, mimic_limits = "source", confine = false))]
    fn from_mjcf(
        _class: &Bound<'_, PyType>,
        path: PathBuf,
        base_joint: Option<Bound<'_, PyAny>>,
        base_bounds: Option<Bound<'_, PyDict>>,
        mimic_limits: &str,
        confine: bool,
    ) -> PyResult<Self> {
        // Errors refer to the lines of the file, which the combined text of all files does not have.
        let reader = kinopt::robot::Robot::mjcf_reader();
        let reader = if confine { reader.confined() } else { reader };
        reader.read(&path).or_raise()?;
        let text = reader.text_with_includes(&path);
        Self::build(Source {
            text: text.or_raise()?.into(),
            file: path.display().to_string(),
            options: RobotOptions {
                confine,
                mimic_limits: named("mimic_limits", mimic_limits, &MIMIC_LIMITS).or_raise()?,
                base: base_of(base_joint, base_bounds)?,
                ..RobotOptions::default()
            },
            ..Source::default()
        })
    }

    /// Reads a URDF document from a string; `name` is its name in messages. Other arguments are as in `from_urdf`.
    ///
    /// Raises `InvalidFileError`, which names the element, if its content is invalid.
    #[classmethod]
    #[pyo3(signature = (
        text, name = "robot.urdf", *, base_joint = None, base_bounds = None, lenient = false, soft_limits = false,
        mimic_limits = "source", confine = false
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn from_urdf_text(
        _class: &Bound<'_, PyType>,
        text: &str,
        name: &str,
        base_joint: Option<Bound<'_, PyAny>>,
        base_bounds: Option<Bound<'_, PyDict>>,
        lenient: bool,
        soft_limits: bool,
        mimic_limits: &str,
        confine: bool,
    ) -> PyResult<Self> {
        Self::build(Source {
            text: text.into(),
            file: name.to_owned(),
            options: RobotOptions {
                lenient,
                confine,
                soft_limits,
                mimic_limits: named("mimic_limits", mimic_limits, &MIMIC_LIMITS).or_raise()?,
                base: base_of(base_joint, base_bounds)?,
            },
            ..Source::default()
        })
    }

    /// Reads a xacro file through the package xacrodoc, without ROS: `pip install 'kinopt[xacro]'`.
    ///
    /// `arguments` are the values of `<xacro:arg>` by name. A package of `$(find NAME)` is a folder in `packages`, a
    /// folder above the file whose package.xml states the name, or a package of the ROS environment. Expansion
    /// evaluates Python expressions of the file, so the file must be trusted. Other arguments are as in `from_urdf`.
    ///
    /// Raises `FileError` if a file cannot be read, `InvalidFileError` if its content is invalid.
    #[classmethod]
    #[pyo3(
        signature = (path, arguments = None, **options),
        text_signature = "(path, arguments=None, *, packages=None, base_joint=None, base_bounds=None, lenient=False, soft_limits=False, mimic_limits=\"source\")"
    )]
    fn from_xacro<'py>(
        class: &Bound<'py, PyType>,
        path: Bound<'py, PyAny>,
        arguments: Option<Bound<'py, PyAny>>,
        options: Option<Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let sources = class.py().import("kinopt._robot_sources")?;
        sources.call_method("from_xacro", (path, arguments), options.as_ref())
    }

    /// Reads a robot of the package robot_descriptions, such as "panda_description": `pip install
    /// 'kinopt[descriptions]'`.
    ///
    /// The first use of a description clones its git repository into `~/.cache/robot_descriptions` or the folder
    /// `ROBOT_DESCRIPTIONS_CACHE`. Its file is URDF, MJCF, or xacro with `arguments` and `packages` as in `from_xacro`.
    /// Its meshes are found there. `lenient` is for URDF and xacro. Other arguments are as in `from_urdf`.
    ///
    /// Raises `UnknownNameError` for an unknown name, `FileError` if the repository cannot be cloned,
    /// `InvalidFileError` if the content is invalid.
    #[classmethod]
    #[pyo3(
        signature = (name, arguments = None, **options),
        text_signature = "(name, arguments=None, *, packages=None, base_joint=None, base_bounds=None, lenient=False, mimic_limits=\"source\")"
    )]
    fn from_description<'py>(
        class: &Bound<'py, PyType>,
        name: Bound<'py, PyAny>,
        arguments: Option<Bound<'py, PyAny>>,
        options: Option<Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let sources = class.py().import("kinopt._robot_sources")?;
        sources.call_method("from_description", (name, arguments), options.as_ref())
    }

    /// True if meshes are opened only below the folder of the robot's file: see `confine` of `from_urdf`.
    #[getter]
    fn confined(&self) -> bool {
        self.inner.is_confined()
    }

    /// The robot with the limits of MoveIt's joint_limits.yaml: `max_velocity`, `max_acceleration`, `max_jerk`, and
    /// `min_position` and `max_position`, which narrow the position limits.
    ///
    /// Raises `FileError` if the file cannot be read, `InvalidFileError`, which names the line, if its content is
    /// invalid.
    fn with_joint_limits(&self, path: PathBuf) -> PyResult<Self> {
        let (text, file) = text_of(&path)?;
        let mut source = self.source.clone();
        source.joint_limits.push((text.into(), file));
        Self::build(source)
    }

    /// The robot with an additional frame `name` at `link_from_tool` (4 x 4, metres) relative to the frame `link`.
    ///
    /// Raises `UnknownNameError` for an unknown link, `InvalidValueError` for a name that exists and for a placement
    /// that is not rigid.
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

    /// Joints, frames and limits of the robot.
    #[getter]
    fn model(&self) -> Model {
        let inner = Arc::clone(&self.model);
        Model { inner }
    }

    /// Name of the robot.
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

    /// Names of all frames: the links and added tools.
    #[getter]
    fn frame_names(&self) -> Vec<String> {
        self.model()
            .frame_names()
            .into_iter()
            .map(str::to_owned)
            .collect()
    }

    /// Length of a configuration, nq: four for a ball joint, one for any other.
    #[getter]
    fn configuration_len(&self) -> usize {
        self.model.configuration_len()
    }

    /// Length of a velocity, nv: three for a ball joint, one for any other.
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

    /// Velocity limits in configuration order, shape (nq,), rad/s or m/s; inf for none.
    #[getter]
    fn velocity_limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.per_joint(py, |id| self.inner.velocity_limit(id))
    }

    /// Acceleration limits in configuration order, shape (nq,), rad/s² or m/s²; inf for none. From the URDF's `<limit
    /// acceleration>` or `with_joint_limits`.
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

    /// Effort limits in configuration order, shape (nq,), N m or N; inf for none.
    #[getter]
    fn effort_limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.per_joint(py, |id| self.inner.effort_limit(id))
    }

    /// Names of the frames without children: hands, tools, feet.
    #[getter]
    fn tips(&self) -> Vec<String> {
        let frames = self.inner.tips();
        frames
            .into_iter()
            .map(|id| self.model.frames()[id.index()].name.clone())
            .collect()
    }

    /// Defaults and repairs of the file's content, one text each.
    #[getter]
    fn repairs(&self) -> Vec<String> {
        self.inner
            .repairs()
            .iter()
            .map(ToString::to_string)
            .collect()
    }

    /// Mimic joints: {joint: (source, ratio, offset)}, value = ratio * source + offset.
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

    /// Loops of the model, for an MJCF file its `connect` and `weld`: see `Model.loops`.
    #[getter]
    fn loops<'py>(&self, py: Python<'py>) -> PyResult<Vec<LoopParts<'py>>> {
        named_loop::loop_parts(py, &self.model)
    }

    /// Names of the passive joints. In an MJCF file with actuators: those that no actuator moves, directly or through a
    /// fixed tendon, and that are no mimic joints. Otherwise those of `with_passive_joints`.
    #[getter]
    fn passive_joints(&self) -> Vec<&str> {
        let joints = self.inner.passive_joints().iter();
        joints
            .map(|id| self.model.joints()[id.index()].name.as_str())
            .collect()
    }

    /// The robot with an additional loop, as URDF has none: the origins of two `frames` coincide ("connect"), or
    /// origins and axes ("weld"). `places`, a pair of 4 x 4 placements, are relative to the frames; default the
    /// identity. Every problem on the robot closes it.
    ///
    /// Raises `UnknownNameError` for an unknown kind or frame, `InvalidValueError` for a name that exists, a placement
    /// that is not rigid, and a loop that no configuration closes.
    #[pyo3(signature = (name, frames, kind = "connect", places = None))]
    fn with_loop(
        &self,
        name: String,
        frames: [String; 2],
        kind: &str,
        places: Option<[Bound<'_, PyAny>; 2]>,
    ) -> PyResult<Self> {
        let mut source = self.source.clone();
        let named_loop = NamedLoop::new(name, frames, kind, places)?;
        source.loops.added.push(named_loop);
        Self::build(source)
    }

    /// The robot without loops, for a file with contradictory or unwanted loops.
    fn without_loops(&self) -> PyResult<Self> {
        let mut source = self.source.clone();
        source.loops.added.clear();
        source.loops.without = true;
        Self::build(source)
    }

    /// The robot with these `passive_joints`, as an SRDF file names them.
    ///
    /// Raises `UnknownNameError` for an unknown joint.
    fn with_passive_joints(&self, names: Vec<String>) -> PyResult<Self> {
        let mut source = self.source.clone();
        source.loops.passive = Some(names);
        Self::build(source)
    }

    /// Names of the moving joints between two frames, from base to tip.
    ///
    /// Raises `UnknownNameError` for an unknown frame.
    fn chain(&self, base: &str, tip: &str) -> PyResult<Vec<String>> {
        let ids = self.inner.chain(base, tip).or_raise()?;
        Ok(ids
            .into_iter()
            .map(|id| self.model.joints()[id.index()].name.clone())
            .collect())
    }

    /// Crouched configuration: `q`, shape (n,), with a free base lower by a fifteenth of its height. The frames `feet`
    /// are at their poses, and all other joints near `q`. The slightly bent knees avoid the singularity of straight
    /// legs. `up` is the upward direction, shape (3,). Returns `q` for a robot without a free base, and if the feet
    /// cannot stay.
    ///
    /// Raises `UnknownNameError` for an unknown frame, `InvalidValueError` for another shape.
    #[pyo3(signature = (feet, q, *, up = None))]
    fn crouched_configuration<'py>(
        &self,
        py: Python<'py>,
        feet: Vec<String>,
        q: &Bound<'py, PyAny>,
        up: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let feet = feet.iter().map(|foot| self.model.frame(foot).or_raise());
        let feet = feet.collect::<PyResult<Vec<_>>>()?;
        let q = self.by_position(q, "q")?;
        let q = arrays::vector_of(&q, "q", self.model.configuration_len())?.to_vec();
        let up = match up {
            Some(up) => arrays::array(up, "up")?,
            None => [0.0, 0.0, 1.0],
        };
        let (model, map) = (&self.model, self.inner.map());
        let stance = py.detach(|| kinopt::ik::crouched_configuration(model, map, &feet, &q, up));
        Ok(arrays::list(py, &stance.or_raise()?))
    }

    /// Visual shapes of a link, or with `collision` its collision shapes: a list of `Shape`; empty for frames that are
    /// no links.
    ///
    /// Raises `UnknownNameError` for an unknown frame.
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

    /// Contact points of a foot, in its frame, shape (N, 3), metres. They are the origins of its link and of the links
    /// fixed to it, and the corners of their collision shapes. `tasks.SupportPolygon(on={foot: robot.sole(foot)})`
    /// balances over it. Mesh files are not opened, so meshes add no points.
    ///
    /// Raises `UnknownNameError` for an unknown frame.
    fn sole<'py>(&self, py: Python<'py>, foot: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = self.inner.sole(self.model.frame(foot).or_raise()?);
        let numbers: Vec<f64> = points.iter().flat_map(|point| point.to_array()).collect();
        arrays::list(py, &numbers).reshape([points.len(), 3])
    }

    /// Total mass of all links that joints move, kg. Raises `InvalidValueError` if the file states no masses, or if a
    /// mass depends on the volume of a mesh (MJCF without `inertial`). Mesh files are not opened.
    #[getter]
    fn mass(&self) -> PyResult<f64> {
        self.inner.total_mass().or_raise()
    }

    /// Centre of mass in the world: shape (3,) for a configuration `q` of shape (nq,), (N, 3) for (N, nq); metres.
    ///
    /// Masses are those of the file's links (`<inertial>`); links fixed in the world do not count, as in Pinocchio.
    /// Raises `InvalidValueError` if the file states no masses, or a negative one, or if a mass or its centre depends
    /// on a mesh (MJCF), and for other shapes.
    fn center_of_mass<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        centres(
            &self.by_position(q, "q")?,
            &self.model,
            &self.inner.masses().or_raise()?,
        )
    }

    /// Jacobian of the centre of mass: three rows in m/s in world axes, a column for each number of a velocity. It has
    /// shape (3, nv) for a configuration `q` of shape (nq,), (N, 3, nv) for (N, nq).
    ///
    /// Raises `InvalidValueError` as `center_of_mass`.
    fn center_of_mass_jacobian<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let q = self.by_position(q, "q")?;
        centres_jacobians(&q, &self.model, &self.inner.masses().or_raise()?)
    }

    /// The configuration closest to all zeros within the limits, shape (nq,), radians and metres, quaternions w, x, y,
    /// z. Mimic joints follow their source joints.
    fn neutral<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.inner.neutral())
    }

    /// Configurations sampled uniformly within the limits, shape (nq,) or (n, nq): see `Model.random_configuration`.
    /// Mimic joints follow their source joints.
    ///
    /// Raises `InvalidValueError` for a seed or an `n` that is no whole number of at least 0.
    #[pyo3(signature = (n = None, *, seed = None))]
    fn random_configuration<'py>(
        &self,
        py: Python<'py>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] n: Option<usize>,
        seed: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (robot, nq) = (&self.inner, self.model.configuration_len());
        random_configurations(py, seed, n, nq, |seed| robot.random_configuration(seed))
    }

    /// Integrates a velocity over a unit of time from a configuration, without limits, as Pinocchio's `integrate`: q +
    /// v for joints of one number, exp for balls and free joints. Shapes (nq,) and (nv,), (N, nq) and (N, nv), or one
    /// row for all of the other; radians and metres. Velocities of balls and free joints are in their own moving axes,
    /// linear first. Quaternions of `q` are w, x, y, z.
    ///
    /// Raises `InvalidValueError` for other shapes, numbers that are not finite, quaternions of length zero.
    fn integrate<'py>(
        &self,
        q: &Bound<'py, PyAny>,
        v: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.model().integrate(q, v)
    }

    /// The velocity that leads from `q0` to `q1` in a unit of time, as Pinocchio's `difference`. Shapes (nq,) twice,
    /// (N, nq) twice, or one row for all of the other.
    ///
    /// Raises `InvalidValueError` as `integrate`.
    fn difference<'py>(
        &self,
        q0: &Bound<'py, PyAny>,
        q1: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.model().difference(q0, q1)
    }

    /// Interpolates from `q0` (`share` 0) to `q1` (`share` 1). Shapes are as in `difference`.
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

    /// True if a configuration, shape (nq,), is within all limits, including cones. Every mimic joint must have the
    /// value of its source joint's relation, up to 1e-9 rad or m.
    ///
    /// Raises `InvalidValueError` for another shape.
    fn is_within_limits(&self, q: &Bound<'_, PyAny>) -> PyResult<bool> {
        let q = self.by_position(q, "q")?;
        let q = arrays::vector_of(&q, "q", self.model.configuration_len())?;
        Ok(self.inner.is_within_limits(&q))
    }

    /// The configuration with mimic joints computed from their source joints. Shape (nq,) for `q` of shape (nq,), (N,
    /// nq) for (N, nq), radians and metres. Forward kinematics does not apply mimic relations.
    ///
    /// Raises `InvalidValueError` for other shapes and for numbers that are not finite.
    fn apply_mimics<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let nq = self.model.configuration_len();
        let q = self.by_position(q, "q")?;
        of_one((&q, "q", nq), nq, |q, applied| {
            applied.copy_from_slice(&self.inner.apply_mimics(q)?);
            Ok(())
        })
    }

    /// Converts a configuration to the order of Pinocchio's `buildModelFromUrdf` for the robot's URDF, with a root
    /// joint for `base_joint`. Joints are depth first, siblings by name. Quaternions are x, y, z, w (here w, x, y, z).
    /// A continuous joint has its cosine and sine (here its angle). Shape (n,) for `q` of shape (nq,), (N, n) for (N,
    /// nq), radians and metres.
    ///
    /// Raises `InvalidValueError` for other shapes and for a robot from MJCF.
    fn to_pinocchio<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let order = self.pinocchio_order()?;
        let nq = self.model.configuration_len();
        of_one((q, "q", nq), order.coordinates(), |q, other| {
            order.write(q, other);
            Ok(())
        })
    }

    /// Converts a configuration `q` in the order of Pinocchio, shape (n,) or (N, n): the inverse of `to_pinocchio`.
    /// Continuous joints are from -pi to pi.
    ///
    /// Raises `InvalidValueError` as `to_pinocchio`.
    #[allow(
        clippy::wrong_self_convention,
        reason = "the name in Python, beside `to_`"
    )]
    fn from_pinocchio<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let order = self.pinocchio_order()?;
        let nq = self.model.configuration_len();
        of_one((q, "q", order.coordinates()), nq, |other, q| {
            order.read(other, q);
            Ok(())
        })
    }

    /// Converts a configuration to MuJoCo's `qpos` for the robot's file: joints depth first, siblings in the order of
    /// the file, quaternions w, x, y, z. For a robot from MJCF it is `q` itself. Shape (nq,) for `q` of shape (nq,),
    /// (N, nq) for (N, nq), radians and metres.
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

    /// Converts MuJoCo's `qpos`, shape (nq,) or (N, nq): the inverse of `to_mujoco`.
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

    /// The Jacobian of a frame, shape (6, nv) for a configuration `q` of shape (nq,), (N, 6, nv) for (N, nq). Its rows
    /// are the velocity of the origin (m/s), then the angular velocity (rad/s), in world axes. Its columns are
    /// velocities as in `integrate`: Pinocchio's `LOCAL_WORLD_ALIGNED`. `kinopt.Jacobian` computes several frames.
    ///
    /// Raises `UnknownNameError` for an unknown frame, `InvalidValueError` as `integrate`.
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
    /// Mesh files are searched next to the robot's file and, for `package://`, in the folders above it and in
    /// `packages`. `meshes` selects their shape: "hull" (convex hull), "parts" (convex hulls of connected parts),
    /// "pieces" (up to 16 convex pieces that contain the mesh) or "triangles" (the mesh itself). A missing mesh is an
    /// error, or with `leave_out_missing` a note. An `srdf` disables collision pairs.
    ///
    /// Raises `FileError` for a missing mesh, `InvalidFileError` for a malformed one, `InvalidValueError` for an
    /// invalid shape.
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
        let options = CollisionOptions {
            packages,
            meshes: meshes.to_owned(),
            leave_out_missing,
        };
        let model = py.detach(|| CollisionModel::of(&self.inner, &options))?;
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
