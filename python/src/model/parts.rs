//! What a model consists of: joints and frames, to read.

use kinopt::model::JointId;
use kinopt::spatial::Placement;
use numpy::{PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::arrays;
use crate::placement;

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
    /// Where its value, or a ball's quaternion w, x, y, z, begins in a configuration; None for a fixed joint.
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
