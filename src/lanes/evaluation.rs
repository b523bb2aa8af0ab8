//! What the kernel finds out about a point.

use crate::spatial::{Matrix3, Vector3};

/// Where the tip stands and how it moves.
pub(crate) struct Evaluation<V> {
    pub(crate) position: Vector3<V>,
    pub(crate) rotation: Matrix3<V>,
}

/// What the residual says about a point.
pub(crate) struct Weighed<V> {
    /// Twice the cost.
    pub(crate) cost: V,
    /// Squared position error, square metres.
    pub(crate) position: V,
    /// Squared orientation error, square radians.
    pub(crate) orientation: V,
    /// The cost's gradient by the columns' two halves.
    pub(crate) gradient: (Vector3<V>, Vector3<V>),
    /// What the step should undo.
    pub(crate) twist: (Vector3<V>, Vector3<V>),
}

/// How far the tip is from its goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Errors {
    /// Metres.
    pub(crate) position: f64,
    /// Radians, 0 to π.
    pub(crate) orientation: f64,
}
