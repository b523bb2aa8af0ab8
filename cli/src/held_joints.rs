//! Joints that stay where they are.

use kinopt::model::{JointId, ParameterMap};

/// The joints that a command holds.
#[derive(Clone, Debug)]
pub(crate) struct HeldJoints {
    /// Joints, each at a value in radians or metres.
    pub(crate) locked: Vec<(JointId, f64)>,
    /// The joints that alone may move, and a configuration that holds the others.
    pub(crate) only: Option<(Vec<JointId>, Vec<f64>)>,
    pub(crate) map: ParameterMap,
}
