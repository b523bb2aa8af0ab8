//! Read-only joints and frames of a model.

use kinopt::model::JointId;
use kinopt::spatial::Placement;
use kinopt_bindings::placement::to_rows;
use numpy::{PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays;
use crate::placement;

/// One joint of a model.
#[pyclass(frozen, module = "kinopt")]
#[derive(Clone)]
pub(crate) struct Joint {
    /// Unique name within the model.
    #[pyo3(get)]
    name: String,
    /// "revolute", "continuous", "prismatic", "ball" or "fixed".
    #[pyo3(get)]
    kind: &'static str,
    /// Parent joint; None for the world.
    #[pyo3(get)]
    parent: Option<String>,
    /// Unit axis of rotation or translation, in the joint's own frame.
    #[pyo3(get)]
    axis: [f64; 3],
    /// Smallest value, radians or metres.
    #[pyo3(get)]
    lower: f64,
    /// Largest value, radians or metres.
    #[pyo3(get)]
    upper: f64,
    /// Index of its value, or of a ball's quaternion w, x, y, z, in a configuration; None for a fixed joint.
    #[pyo3(get)]
    coordinate: Option<usize>,
    /// Largest swing of a ball joint about two axes across its own, radians; None for no limit.
    #[pyo3(get)]
    swing: Option<[f64; 2]>,
    /// Range of a ball joint's twist about its axis, radians; None for no limit.
    #[pyo3(get)]
    twist: Option<(f64, f64)>,
    /// Largest rotation angle of a ball joint, radians; None for no limit next to swing and twist.
    #[pyo3(get)]
    angle: Option<f64>,
    parent_from_joint: [f64; 16],
}

impl Joint {
    pub(super) fn of(model: &kinopt::Model, joint: &kinopt::model::Joint) -> Self {
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
            parent_from_joint: to_rows(&joint.parent_from_joint),
        }
    }
}

#[pymethods]
impl Joint {
    /// Placement of the joint relative to its parent at value 0, shape (4, 4).
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

/// A frame of a model, fixed to a joint.
#[pyclass(frozen, module = "kinopt")]
#[derive(Clone)]
pub(crate) struct Frame {
    /// Unique name within the model.
    #[pyo3(get)]
    name: String,
    /// The joint that carries it; None for a frame fixed in the world.
    #[pyo3(get)]
    joint: Option<String>,
    joint_from_frame: Placement<f64>,
}

impl Frame {
    pub(super) fn of(model: &kinopt::Model, frame: &kinopt::model::Frame) -> Self {
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
    /// Placement of the frame relative to its joint, shape (4, 4).
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
