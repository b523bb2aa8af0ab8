//! Swing and twist limits of a bone on a ball joint.

use std::collections::BTreeMap;

use crate::model::BallLimits;
use crate::spatial::Vector3;

/// Cones by bone name.
pub type Cones = BTreeMap<String, BoneCone>;

/// Limits of a bone's rotation from rest on a ball joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoneCone {
    /// Twist axis and centre of the cone at rest, in the bone's axes; any length but zero. `None`: along the bone, see
    /// [`BallSkeleton::new`](super::BallSkeleton::new). A hinge is a small swing with a twist about its axis.
    pub axis: Option<Vector3<f64>>,
    /// Limits of swing, twist and total angle.
    pub limits: BallLimits,
}

impl BoneCone {
    /// Limits about the axis of the bone.
    #[must_use]
    pub fn new(limits: BallLimits) -> Self {
        Self { axis: None, limits }
    }

    /// Limits about another axis, in the bone's axes.
    #[must_use]
    pub fn about(axis: impl Into<Vector3<f64>>, limits: BallLimits) -> Self {
        Self {
            axis: Some(axis.into()),
            limits,
        }
    }
}
