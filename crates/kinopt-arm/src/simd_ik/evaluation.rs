//! Results of the kernel at a point.

use kinopt_kinematics::spatial::{Matrix3, Vector3};

/// Pose of the tip in the goal frame; lengths of the solver.
pub(crate) struct Evaluation<V> {
    pub(crate) position: Vector3<V>,
    pub(crate) rotation: Matrix3<V>,
}

/// Residual at a point. For weighted goals only components with a weight count, beyond their dead bands.
pub(crate) struct WeightedResidual<V> {
    /// Twice the cost, lengths of the solver squared.
    pub(crate) twice_cost: V,
    /// Squared position error, lengths of the solver squared.
    pub(crate) position: V,
    /// Squared chord of the orientation error, 2(1 − cos θ) = (2 sin ½θ)²; about θ² for small θ.
    pub(crate) orientation: V,
    /// Vector g, by linear and angular half, with the gradient Jᵀ g of the cost.
    pub(crate) gradient: (Vector3<V>, Vector3<V>),
    /// Twist e, by linear and angular half, that the step should cancel.
    pub(crate) twist: (Vector3<V>, Vector3<V>),
}

/// Position and orientation error of the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Errors {
    /// Distance from the goal, metres; lengths of the solver until `judge` converts it.
    pub(crate) position: f64,
    /// Angle to the goal's orientation, radians, 0 to π.
    pub(crate) orientation: f64,
}
