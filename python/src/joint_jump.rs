//! Joint jumps.

use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::pickling;

/// A step of a path, follower or drag in which a joint moves farther than its bound.
#[pyclass(frozen, get_all, module = "kinopt")]
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct JointJump {
    /// Index of the row, target or frame at the end of the step, from 0; 0 for the step that closes a cyclic path.
    pub(crate) index: usize,
    /// Name of the joint that moves farthest, relative to its bound.
    joint: String,
    /// Displacement of that joint, radians. For a prismatic joint of an arm it is the equivalent angle, for one of a
    /// drag it is in metres.
    distance: f64,
    /// True if the step leads to another branch. False for a fast motion or a coarse path: small steps lead there too.
    reconfiguration: bool,
}

impl JointJump {
    pub(crate) fn new(jump: &kinopt::ik::JointJump, joint: &str) -> Self {
        Self {
            index: jump.index,
            joint: joint.to_owned(),
            distance: jump.distance,
            reconfiguration: jump.reconfiguration,
        }
    }

    /// Jumps of an arm.
    pub(crate) fn of_arm(arm: &kinopt::Arm, jumps: &[kinopt::ik::JointJump]) -> Vec<Self> {
        let names: Vec<&str> = arm.joints().collect();
        let jumps = jumps.iter();
        jumps
            .map(|jump| Self::new(jump, names[jump.joint]))
            .collect()
    }
}

#[pymethods]
impl JointJump {
    fn __repr__(&self) -> String {
        let Self { index, joint, .. } = self;
        let kind = match self.reconfiguration {
            true => "reconfiguration",
            false => "continuous",
        };
        format!(
            "JointJump({index}, {joint:?}, {:.3}, {kind})",
            self.distance
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_json::<Self>(py, self)
    }

    #[staticmethod]
    fn _rebuild(json: &str) -> PyResult<Self> {
        pickling::of_json(json)
    }
}
