//! What the kernel finds out about a point.

use crate::spatial::{Matrix3, Vector3};

/// Where the tip stands and how it moves.
pub(crate) struct Evaluation<V> {
    pub(crate) position: Vector3<V>,
    pub(crate) rotation: Matrix3<V>,
}

/// What the residual says about a point; for goals by axes, of what counts and lies beyond its room.
pub(crate) struct Weighed<V> {
    /// Twice the cost, the solver's lengths squared.
    pub(crate) twice_cost: V,
    /// Squared position error, the solver's lengths squared.
    pub(crate) position: V,
    /// Squared chord of the orientation error, 2(1 − cos θ) = (2 sin ½θ)²: θ² where that is small.
    pub(crate) orientation: V,
    /// What Jᵀ turns into the cost's gradient, by the columns' two halves.
    pub(crate) gradient: (Vector3<V>, Vector3<V>),
    /// e: what the step should undo, by the same halves.
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
