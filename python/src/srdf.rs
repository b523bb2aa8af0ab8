//! SRDF: semantic description of a robot.

use std::path::PathBuf;

use kinopt::model::JointId;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

use crate::arrays;
use crate::error::OrRaise;
use crate::pickling;
use crate::problem::ParameterMap;
use crate::robot::Robot;
use crate::robot::text_of;

/// Content of an SRDF file: groups of joints, group states, passive joints, and disabled collision pairs of a robot.
/// Created by `read` and `parse`.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Srdf {
    inner: kinopt::robot::Srdf,
    robot: Py<Robot>,
    text: String,
    file: String,
    lenient: bool,
}

impl Srdf {
    fn of(text: String, robot: Py<Robot>, file: String, lenient: bool) -> PyResult<Self> {
        let reader = kinopt::robot::Srdf::reader();
        let reader = match lenient {
            true => reader.lenient(),
            false => reader,
        };
        let inner = reader.parse(&text, &file, &robot.get().inner).or_raise()?;
        Ok(Self {
            inner,
            robot,
            text,
            file,
            lenient,
        })
    }

    pub(crate) fn inner(&self) -> &kinopt::robot::Srdf {
        &self.inner
    }

    pub(crate) fn model(&self) -> &kinopt::Model {
        &self.robot.get().model
    }

    fn joint_names(&self, joints: &[JointId]) -> Vec<String> {
        let model = &self.robot.get().model;
        let name = |id: &JointId| model.joints()[id.index()].name.clone();
        joints.iter().map(name).collect()
    }

    fn frame_name(&self, frame: kinopt::model::FrameId) -> &str {
        &self.robot.get().model.frames()[frame.index()].name
    }

    /// Returns the numbers of a configuration, or of neutral.
    fn configuration(&self, q: Option<&Bound<'_, PyAny>>) -> PyResult<Vec<f64>> {
        let model = &self.robot.get().model;
        match q {
            None => Ok(self.robot.get().inner.neutral()),
            Some(q) => {
                let q = arrays::vector_of(q, "at", model.configuration_len())?.to_vec();
                q.iter()
                    .try_for_each(|&value| arrays::finite(value, "a number of at").map(drop))?;
                Ok(q)
            }
        }
    }

    /// Returns the joints that are not mimic joints.
    fn leading(&self, joints: &[JointId]) -> Vec<JointId> {
        let mimics = self.robot.get().inner.mimics();
        let follows = |joint: &JointId| mimics.iter().any(|mimic| mimic.joint == *joint);
        joints
            .iter()
            .copied()
            .filter(|joint| !follows(joint))
            .collect()
    }
}

#[pymethods]
impl Srdf {
    /// Reads the SRDF file of a robot. With `lenient`, elements with unknown names of joints, links or groups are
    /// ignored and listed in `repairs`.
    ///
    /// Raises `FileError` if the file cannot be read. Raises `InvalidFileError`, which names the element, for unknown
    /// joints, links and groups, groups that contain themselves, and values that are not numbers.
    #[classmethod]
    #[pyo3(signature = (path, robot, *, lenient = false))]
    fn read(
        _class: &Bound<'_, PyType>,
        path: PathBuf,
        robot: Py<Robot>,
        lenient: bool,
    ) -> PyResult<Self> {
        let (text, file) = text_of(&path)?;
        Self::of(text, robot, file, lenient)
    }

    /// Reads a document from a string; `name` is its name in messages, `lenient` is as in `read`.
    ///
    /// Raises `InvalidFileError` as `read`.
    #[classmethod]
    #[pyo3(signature = (text, robot, name = "robot.srdf", *, lenient = false))]
    fn parse(
        _class: &Bound<'_, PyType>,
        text: String,
        robot: Py<Robot>,
        name: &str,
        lenient: bool,
    ) -> PyResult<Self> {
        Self::of(text, robot, name.to_owned(), lenient)
    }

    /// Elements that a lenient read ignored, one text each.
    #[getter]
    fn repairs(&self) -> Vec<String> {
        let repairs = self.inner.repairs.iter();
        repairs.map(ToString::to_string).collect()
    }

    /// The moving joints of each group, parents before children, by the name of the group.
    #[getter]
    fn groups<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let groups = PyDict::new(py);
        for group in &self.inner.groups {
            groups.set_item(&group.name, self.joint_names(&group.joints))?;
        }
        Ok(groups)
    }

    /// Names of the group states, each with its group.
    #[getter]
    fn states(&self) -> Vec<(&str, &str)> {
        let states = self.inner.states.iter();
        states.map(|state| (&*state.name, &*state.group)).collect()
    }

    /// A group state as a whole configuration, shape (nq,): its values, and those of `at` (default: neutral) for all
    /// other joints; radians and metres. A name that several groups define merges their states; `group/name` selects
    /// one.
    ///
    /// Raises `UnknownNameError` for an unknown state, `InvalidValueError` for an `at` of another shape and for numbers
    /// that are not finite.
    #[pyo3(signature = (name, at = None))]
    fn state<'py>(
        &self,
        py: Python<'py>,
        name: &str,
        at: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let q = self.configuration(at)?;
        let state = self.inner.state(name, &q).or_raise()?;
        Ok(arrays::list(py, &state))
    }

    /// Passive joints that move.
    #[getter]
    fn passive_joints(&self) -> Vec<String> {
        self.joint_names(&self.inner.passive_joints)
    }

    /// End effectors: (name, its group, the link it is fixed to, the group that carries it or None).
    #[getter]
    fn end_effectors(&self) -> Vec<(&str, &str, &str, Option<&str>)> {
        let ends = self.inner.end_effectors.iter();
        ends.map(|end| {
            let link = self.frame_name(end.parent_link);
            (&*end.name, &*end.group, link, end.parent_group.as_deref())
        })
        .collect()
    }

    /// Virtual joints, as in `from_urdf(base_joint=)`: (name, "fixed", "floating" or "planar", the parent frame, the
    /// child link).
    #[getter]
    fn virtual_joints(&self) -> Vec<(&str, &str, &str, &str)> {
        let joints = self.inner.virtual_joints.iter();
        joints
            .map(|joint| {
                let link = self.frame_name(joint.child_link);
                (&*joint.name, &*joint.kind, &*joint.parent_frame, link)
            })
            .collect()
    }

    /// Disabled collision pairs: (link, link, reason).
    #[getter]
    fn disabled_pairs(&self) -> Vec<(&str, &str, &str)> {
        let pairs = self.inner.disabled_pairs.iter();
        pairs
            .map(|pair| {
                let [one, other] = pair.links.map(|link| self.frame_name(link));
                (one, other, &*pair.reason)
            })
            .collect()
    }

    /// The parameter map in which only the joints of a group move. The others are locked at the values of `at`, shape
    /// (nq,) (default: neutral).
    ///
    /// Raises `UnknownNameError` for an unknown group, `InvalidValueError` for an `at` of another shape.
    #[pyo3(signature = (group, at = None))]
    fn only<'py>(
        &self,
        py: Python<'py>,
        group: &str,
        at: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let joints = &self.inner.group(group).or_raise()?.joints;
        let options = PyDict::new(py);
        options.set_item("only", self.joint_names(&self.leading(joints)))?;
        options.set_item("at", arrays::list(py, &self.configuration(at)?))?;
        let class = py.get_type::<ParameterMap>();
        class.call((self.robot.bind(py),), Some(&options))
    }

    /// The parameter map in which passive joints, except mimic joints, are locked at the values of `at`, shape (nq,)
    /// (default: neutral).
    ///
    /// Raises `InvalidValueError` for an `at` of another shape.
    #[pyo3(signature = (at = None))]
    fn driven<'py>(
        &self,
        py: Python<'py>,
        at: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (q, model) = (self.configuration(at)?, &self.robot.get().model);
        let lock = PyDict::new(py);
        for id in self.leading(&self.inner.passive_joints) {
            let joint = &model.joints()[id.index()];
            let Some(first) = model.coordinate(id) else {
                continue;
            };
            match &q[first..first + joint.kind.coordinates()] {
                [value] => lock.set_item(&joint.name, *value)?,
                quaternion => lock.set_item(&joint.name, quaternion.to_vec())?,
            }
        }
        let options = PyDict::new(py);
        options.set_item("lock", lock)?;
        let class = py.get_type::<ParameterMap>();
        class.call((self.robot.bind(py),), Some(&options))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let arguments = (&*self.text, self.robot.bind(py), &*self.file, self.lenient);
        pickling::by_rebuild::<Self>(py, arguments)
    }

    #[classmethod]
    fn _rebuild(
        _class: &Bound<'_, PyType>,
        text: String,
        robot: Py<Robot>,
        file: String,
        lenient: bool,
    ) -> PyResult<Self> {
        Self::of(text, robot, file, lenient)
    }

    fn __repr__(&self) -> String {
        format!(
            "Srdf({} groups, {} states, {} passive joints)",
            self.inner.groups.len(),
            self.inner.states.len(),
            self.inner.passive_joints.len()
        )
    }
}
