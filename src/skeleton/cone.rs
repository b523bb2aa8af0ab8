//! How far a bone on a ball joint may turn.

use std::collections::BTreeMap;

use crate::model::BallLimits;
use crate::spatial::Vector3;

/// Cones of bones, by their names.
pub type Cones = BTreeMap<String, BoneCone>;

/// How far a bone on a ball joint may turn from where it is at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoneCone {
    /// What it twists about and what the cone is around at rest, in the bone's own axes; of any length but zero.
    /// `None`: along the bone, as [`BallSkeleton::new`](super::BallSkeleton::new) has it. A hinge is a small
    /// swing, and a twist about the hinge's axis.
    pub axis: Option<Vector3<f64>>,
    /// How far it may swing and twist.
    pub limits: BallLimits,
}

impl BoneCone {
    /// Limits about the bone itself.
    #[must_use]
    pub fn new(limits: BallLimits) -> Self {
        Self { axis: None, limits }
    }

    /// Limits about another axis, in the bone's own axes.
    #[must_use]
    pub fn about(axis: impl Into<Vector3<f64>>, limits: BallLimits) -> Self {
        Self {
            axis: Some(axis.into()),
            limits,
        }
    }
}
