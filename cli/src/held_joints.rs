//! Joints that stay where they are.

use kinopt::model::ParameterMap;

/// The joints that a command holds.
#[derive(Clone, Debug)]
pub(crate) struct HeldJoints {
    /// Joints by name, each at a value in radians or metres.
    pub(crate) locked: Vec<(String, f64)>,
    /// The joints that alone may move, and a configuration that holds the others.
    pub(crate) only: Option<(Vec<String>, Vec<f64>)>,
    pub(crate) map: ParameterMap,
}
