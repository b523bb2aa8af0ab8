//! Robots from URDF.

use std::path::PathBuf;
use std::sync::Arc;

use kinopt::spatial::Placement;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

use crate::arrays;
use crate::error::{Kind, OrRaise, raise};
use crate::model::Model;
use crate::pickling;
use crate::placement;

/// A robot: a model with its joints that follow others, its speeds, shapes and masses.
///
/// Every link is a frame under the link's name; the root link stands in the world. A configuration lists
/// the joints that move in the order of the file.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Robot {
    pub(crate) inner: Arc<kinopt::robot::Robot>,
    pub(crate) model: Arc<kinopt::Model>,
    source: Source,
}

/// What a robot is read from, and what was changed since.
#[derive(Clone)]
struct Source {
    text: Arc<str>,
    file: String,
    lenient: bool,
    soft_limits: bool,
    tools: Vec<(String, String, Placement<f64>)>,
}

impl Robot {
    fn build(source: Source) -> PyResult<Self> {
        let reader = kinopt::robot::Robot::reader();
        let reader = match source.lenient {
            true => reader.lenient(),
            false => reader,
        };
        let mut robot = reader.parse(&source.text, &source.file).or_raise()?;
        if source.soft_limits {
            robot = robot.with_soft_limits().or_raise()?;
        }
        for (name, link, tool) in &source.tools {
            robot = robot.with_tool(name, link, tool).or_raise()?;
        }
        Ok(Self {
            model: Arc::new(robot.model().clone()),
            inner: Arc::new(robot),
            source,
        })
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
    /// With `lenient` what can be mended in one way only is mended, and listed in `repairs`. With
    /// `soft_limits` every joint also keeps within its safety controller's limits. Files of meshes are not
    /// opened.
    ///
    /// Raises `FileError` where it cannot be read, `InvalidFileError`, which names the element, for what is
    /// wrong in it.
    #[classmethod]
    #[pyo3(signature = (path, *, lenient = false, soft_limits = false))]
    fn from_urdf(
        _class: &Bound<'_, PyType>,
        path: PathBuf,
        lenient: bool,
        soft_limits: bool,
    ) -> PyResult<Self> {
        let file = path.display().to_string();
        let bytes = std::fs::read(&path)
            .map_err(|error| raise(Kind::File, format!("{file}: cannot be read: {error}")))?;
        let text = String::from_utf8(bytes)
            .map_err(|_| raise(Kind::InvalidFile, format!("{file}: is not UTF-8 text")))?;
        Self::build(Source {
            text: text.into(),
            file,
            lenient,
            soft_limits,
            tools: Vec::new(),
        })
    }

    /// Reads a URDF document from a string; `name` is what messages call it.
    ///
    /// Raises `InvalidFileError`, which names the element, for what is wrong in it.
    #[classmethod]
    #[pyo3(signature = (text, name = "robot.urdf", *, lenient = false, soft_limits = false))]
    fn from_urdf_text(
        _class: &Bound<'_, PyType>,
        text: &str,
        name: &str,
        lenient: bool,
        soft_limits: bool,
    ) -> PyResult<Self> {
        Self::build(Source {
            text: text.into(),
            file: name.to_owned(),
            lenient,
            soft_limits,
            tools: Vec::new(),
        })
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

    /// How many numbers a configuration has.
    #[getter]
    fn degrees_of_freedom(&self) -> usize {
        self.model.configuration_len()
    }

    /// Lower limits in configuration order, shape (dof,), radians or metres; -inf for none.
    #[getter]
    fn lower<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.model().lower(py)
    }

    /// Upper limits in configuration order, shape (dof,), radians or metres; inf for none.
    #[getter]
    fn upper<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.model().upper(py)
    }

    /// Highest speeds in configuration order, shape (dof,), rad/s or m/s; inf for none.
    #[getter]
    fn velocity_limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        self.per_joint(py, |id| self.inner.velocity_limit(id))
    }

    /// Strongest torques and forces in configuration order, shape (dof,), N m or N; inf for none.
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
        Ok(shapes
            .iter()
            .map(|shape| Shape {
                inner: shape.clone(),
            })
            .collect())
    }

    /// The mass of all links that joints move, kg. Raises `InvalidValueError` where the file states none.
    #[getter]
    fn mass(&self) -> PyResult<f64> {
        Ok(self.inner.masses().or_raise()?.total())
    }

    /// Where the centre of mass is at a configuration `q`, shape (dof,): shape (3,), metres, in the world.
    ///
    /// Masses are those of the file's links (`<inertial>`); what stands in the world counts for nothing, as in
    /// Pinocchio. Raises `InvalidValueError` where the file states none, or a negative one, and for other shapes.
    fn center_of_mass<'py>(&self, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let configuration = arrays::copied(q, "q")?;
        let centre = self.inner.centre_of_mass(&configuration).or_raise()?;
        Ok(arrays::list(q.py(), &centre.to_array()))
    }

    /// How the centre of mass moves at a configuration `q`, shape (dof,): its Jacobian, three rows in m/s in world
    /// axes, a column for each number of a velocity.
    ///
    /// Raises `InvalidValueError` as `center_of_mass`.
    fn center_of_mass_jacobian<'py>(
        &self,
        q: &Bound<'py, PyAny>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let configuration = arrays::copied(q, "q")?;
        let columns = self
            .inner
            .centre_of_mass_jacobian(&configuration)
            .or_raise()?;
        let rows = columns.transpose();
        arrays::list(q.py(), rows.as_slice()).reshape([3, rows.nrows()])
    }

    /// The configuration nearest to all zeros within the limits, shape (dof,).
    fn neutral<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.model().neutral(py)
    }

    /// Configurations drawn within the limits: see `Model.random_configuration`.
    ///
    /// Raises `InvalidValueError` for a seed or an `n` that is no whole number of at least 0.
    #[pyo3(signature = (seed = None, n = None))]
    fn random_configuration<'py>(
        &self,
        py: Python<'py>,
        seed: Option<&Bound<'py, PyAny>>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] n: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        self.model().random_configuration(py, seed, n)
    }

    #[classmethod]
    #[allow(clippy::type_complexity, reason = "it is what `__reduce__` gives")]
    fn _rebuild(
        _class: &Bound<'_, PyType>,
        text: &str,
        file: String,
        lenient: bool,
        soft_limits: bool,
        tools: Vec<(String, String, Bound<'_, PyAny>)>,
    ) -> PyResult<Self> {
        let tools = tools.into_iter().map(|(name, link, tool)| {
            Ok((name, link, placement::placement(&tool, "link_from_tool")?))
        });
        Self::build(Source {
            text: text.into(),
            file,
            lenient,
            soft_limits,
            tools: tools.collect::<PyResult<_>>()?,
        })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let source = &self.source;
        let tools = source.tools.iter().map(|(name, link, tool)| {
            Ok((name.clone(), link.clone(), placement::to_array(py, tool)?))
        });
        let tools: Vec<(String, String, Bound<'py, PyArray2<f64>>)> =
            tools.collect::<PyResult<_>>()?;
        let arguments = (
            &*source.text,
            source.file.as_str(),
            source.lenient,
            source.soft_limits,
            tools,
        );
        pickling::by_rebuild::<Self>(py, arguments)
    }

    fn __repr__(&self) -> String {
        format!(
            "Robot({:?}, {} degrees of freedom, {} links)",
            self.model.name(),
            self.model.configuration_len(),
            self.model.frames().len()
        )
    }
}

/// A body of a link: a box, cylinder, capsule, sphere or mesh; lengths in metres.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Shape {
    inner: kinopt::robot::Shape,
}

#[pymethods]
impl Shape {
    /// Its name, which few have.
    #[getter]
    fn name(&self) -> Option<&str> {
        self.inner.name.as_deref()
    }

    /// Where it stands in the link's frame, shape (4, 4).
    #[getter]
    fn link_from_shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        placement::to_array(py, &self.inner.link_from_shape)
    }

    /// "box", "cylinder", "capsule", "sphere" or "mesh".
    #[getter]
    fn kind(&self) -> &'static str {
        use kinopt::robot::Geometry;
        match self.inner.geometry {
            Geometry::Box { .. } => "box",
            Geometry::Cylinder { .. } => "cylinder",
            Geometry::Capsule { .. } => "capsule",
            Geometry::Sphere { .. } => "sphere",
            Geometry::Mesh { .. } => "mesh",
            _ => "other",
        }
    }

    /// Its measures by name: a box has `size` (whole lengths along x, y, z), a cylinder and a capsule
    /// `radius` and `length` (along z; a capsule's without its caps), a sphere `radius`, a mesh `file`
    /// (as it stands in the robot's file) and `scale`.
    #[getter]
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        use kinopt::robot::Geometry;
        let measures = PyDict::new(py);
        match &self.inner.geometry {
            Geometry::Box { size } => measures.set_item("size", *size)?,
            Geometry::Cylinder { radius, length } | Geometry::Capsule { radius, length } => {
                measures.set_item("radius", *radius)?;
                measures.set_item("length", *length)?;
            }
            Geometry::Sphere { radius } => measures.set_item("radius", *radius)?,
            Geometry::Mesh { file, scale } => {
                measures.set_item("file", file)?;
                measures.set_item("scale", *scale)?;
            }
            _ => {}
        }
        Ok(measures)
    }

    fn __repr__(&self) -> String {
        format!(
            "Shape({}, {:?})",
            self.kind(),
            self.inner.name.as_deref().unwrap_or("")
        )
    }
}
