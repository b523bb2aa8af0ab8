//! Read-only joints and frames of a model.

use kinopt::model::JointId;
use pyo3::prelude::*;

use crate::placement::Matrix;

/// One joint of a model.
#[pyclass(frozen, get_all, module = "kinopt")]
#[derive(Clone)]
pub(crate) struct Joint {
    /// Unique name within the model.
    name: String,
    /// "revolute", "continuous", "prismatic", "ball" or "fixed".
    kind: &'static str,
    /// Parent joint; None for the world.
    parent: Option<String>,
    /// Unit axis of rotation or translation, in the joint's own frame.
    axis: [f64; 3],
    /// Smallest value, radians or metres.
    lower: f64,
    /// Largest value, radians or metres.
    upper: f64,
    /// Index of its value, or of a ball's quaternion w, x, y, z, in a configuration; None for a fixed joint.
    coordinate: Option<usize>,
    /// Largest swing of a ball joint about two axes across its own, radians; None for no limit.
    swing: Option<[f64; 2]>,
    /// Range of a ball joint's twist about its axis, radians; None for no limit.
    twist: Option<(f64, f64)>,
    /// Largest rotation angle of a ball joint, radians; None for no limit next to swing and twist.
    angle: Option<f64>,
    /// Placement of the joint relative to its parent at value 0, shape (4, 4).
    parent_from_joint: Matrix,
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
            parent_from_joint: Matrix(joint.parent_from_joint),
        }
    }
}

#[pymethods]
impl Joint {
    fn __repr__(&self) -> String {
        format!(
            "Joint({:?}, {}, {} to {})",
            self.name, self.kind, self.lower, self.upper
        )
    }
}

/// A frame of a model, fixed to a joint.
#[pyclass(frozen, get_all, module = "kinopt")]
#[derive(Clone)]
pub(crate) struct Frame {
    /// Unique name within the model.
    name: String,
    /// The joint that carries it; None for a frame fixed in the world.
    joint: Option<String>,
    /// Placement of the frame relative to its joint, shape (4, 4).
    joint_from_frame: Matrix,
}

impl Frame {
    pub(super) fn of(model: &kinopt::Model, frame: &kinopt::model::Frame) -> Self {
        let name = |joint: JointId| model.joints()[joint.index()].name.clone();
        Self {
            name: frame.name.clone(),
            joint: frame.joint.map(name),
            joint_from_frame: Matrix(frame.joint_from_frame),
        }
    }
}

#[pymethods]
impl Frame {
    fn __repr__(&self) -> String {
        format!(
            "Frame({:?} on {:?})",
            self.name,
            self.joint.as_deref().unwrap_or("world")
        )
    }
}
