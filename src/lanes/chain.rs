//! The input: a serial chain of moving joints from a base to a tip.

use crate::model::JointKind;
use crate::spatial::{Placement, Vector3};

use super::trigonometry::MAX_ANGLE;
use super::{LaneError, check};

/// The largest number of moving joints a [`Chain`] can have.
pub const MAX_JOINTS: usize = 64;

/// One moving joint of a [`Chain`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainJoint {
    /// Where the joint stands at value zero in the frame of the joint before it (of the base for the
    /// first). Fixed joints between the two are folded in. The rotation is orthonormal.
    pub parent_from_joint: Placement<f64>,
    /// The axis in the joint's own frame, of any length but zero.
    pub axis: Vector3<f64>,
    /// Turning or sliding; one that turns without limits has infinite bounds.
    pub kind: JointKind,
    /// Smallest value, in radians or metres; −∞ when unbounded (a continuous joint).
    pub lower: f64,
    /// Largest value, in radians or metres; +∞ when unbounded.
    pub upper: f64,
}

/// A serial chain: what the lane engine solves.
///
/// `base_from_tip(q) = Π parent_from_joint_i · motion_i(q_i) · joint_from_tip`.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    joints: Vec<ChainJoint>,
    joint_from_tip: Placement<f64>,
    /// Length of the way from base to tip with the magnitude of every part, slides at zero; metres.
    extent: f64,
}

/// Why a list of joints is no [`Chain`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChainError {
    /// No moving joint, or too many.
    #[error("a chain has 1 to {MAX_JOINTS} moving joints, not {0}")]
    JointCount(usize),
    /// A joint that does not move: it belongs into the placement of the next one.
    #[error("joint {0} of the chain is fixed")]
    Fixed(usize),
    /// An axis that is zero or not finite.
    #[error("joint {0} of the chain has no usable axis")]
    Axis(usize),
    /// Bounds that are NaN, crossed, or leave no finite value.
    #[error("joint {joint} of the chain has bounds [{lower}, {upper}]")]
    Bounds {
        /// Which joint, from 0 at the base.
        joint: usize,
        /// Its lower bound, radians or metres.
        lower: f64,
        /// Its upper bound, radians or metres.
        upper: f64,
    },
    /// A placement that is not finite or whose rotation is not orthonormal to 1e-6.
    #[error("placement {0} of the chain (the tip comes last) is not a rigid motion")]
    Placement(usize),
}

impl Chain {
    /// Checks and keeps the joints, base to tip, and where the tip stands in the last one.
    ///
    /// # Errors
    /// See [`ChainError`]. A finite bound of a revolute joint beyond a million radians is an error.
    pub fn new(
        mut joints: Vec<ChainJoint>,
        joint_from_tip: Placement<f64>,
    ) -> Result<Self, ChainError> {
        if joints.is_empty() || joints.len() > MAX_JOINTS {
            return Err(ChainError::JointCount(joints.len()));
        }
        for (index, joint) in joints.iter_mut().enumerate() {
            joint.kind = match joint.kind {
                JointKind::Fixed | JointKind::Ball => return Err(ChainError::Fixed(index)),
                JointKind::Prismatic => JointKind::Prismatic,
                JointKind::Revolute | JointKind::Continuous => JointKind::Revolute,
            };
            let length = joint.axis.norm();
            if !(length.is_finite() && length > 1e-12) {
                return Err(ChainError::Axis(index));
            }
            joint.axis = joint.axis * length.recip();
            let (lower, upper) = (joint.lower, joint.upper);
            let too_far =
                |bound: f64| joint.kind.turns() && bound.is_finite() && bound.abs() > MAX_ANGLE;
            // `lower <= upper` is false for NaN.
            let ordered = lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY;
            if !ordered || too_far(lower) || too_far(upper) {
                return Err(ChainError::Bounds {
                    joint: index,
                    lower,
                    upper,
                });
            }
            if !is_rigid(&joint.parent_from_joint) {
                return Err(ChainError::Placement(index));
            }
        }
        if !is_rigid(&joint_from_tip) {
            return Err(ChainError::Placement(joints.len()));
        }
        Ok(Self {
            extent: extent(&joints, &joint_from_tip),
            joints,
            joint_from_tip,
        })
    }

    /// The same chain, whose constant ways were put together from longer ones.
    #[must_use]
    pub(crate) fn with_extent(mut self, extent: f64) -> Self {
        self.extent = self.extent.max(extent);
        self
    }

    getters! {
        /// Length of the way from base to tip with the magnitude of every part, slides at zero; metres.
        pub(crate) fn extent(&self) -> f64 = self.extent;
        /// The joints, base to tip.
        pub fn joints(&self) -> &[ChainJoint] = &self.joints;
        /// Where the tip stands in the frame of the last joint.
        pub fn joint_from_tip(&self) -> &Placement<f64> = &self.joint_from_tip;
    }

    /// The same joints with another tip, which is rigid.
    pub(crate) fn with_tip(&self, joint_from_tip: Placement<f64>) -> Result<Self, ChainError> {
        if !is_rigid(&joint_from_tip) {
            return Err(ChainError::Placement(self.joints.len()));
        }
        Ok(Self {
            extent: extent(&self.joints, &joint_from_tip),
            joints: self.joints.clone(),
            joint_from_tip,
        })
    }

    /// The joints alone: the tip is the last joint's frame.
    pub(crate) fn without_tool(&self) -> Self {
        let joint_from_tip = Placement::identity();
        Self {
            extent: extent(&self.joints, &joint_from_tip),
            joints: self.joints.clone(),
            joint_from_tip,
        }
    }

    /// `base_from_tip` at the joint values `q` (radians or metres).
    ///
    /// # Errors
    /// A `q` of another length than the chain has joints, or not finite.
    pub fn base_from_tip(&self, q: &[f64]) -> Result<Placement<f64>, LaneError> {
        check::length("q", q.len(), self.joints.len())?;
        match q.iter().all(|value| value.is_finite()) {
            true => Ok(self.tip_at(q)),
            false => Err(LaneError::NotFinite("q")),
        }
    }

    /// As [`base_from_tip`](Self::base_from_tip), of values that are known to be the chain's.
    pub(crate) fn tip_at(&self, q: &[f64]) -> Placement<f64> {
        debug_assert_eq!(q.len(), self.joints.len());
        let mut base_from_joint = Placement::identity();
        for (joint, &value) in self.joints.iter().zip(q) {
            base_from_joint = base_from_joint
                * joint.parent_from_joint
                * joint.kind.joint_from_moved(joint.axis, value);
        }
        base_from_joint * self.joint_from_tip
    }
}

/// Length of the constant ways, each with its magnitude.
fn extent(joints: &[ChainJoint], joint_from_tip: &Placement<f64>) -> f64 {
    let ways = joints.iter().map(|joint| &joint.parent_from_joint);
    let ways = ways.chain([joint_from_tip]);
    ways.map(|way| way.translation.norm()).sum()
}

/// Whether the numbers are finite and the rotation orthonormal and right-handed, to 1e-6.
pub(crate) fn is_rigid(placement: &Placement<f64>) -> bool {
    let r = &placement.rotation;
    let finite = placement
        .translation
        .to_array()
        .iter()
        .all(|v| v.is_finite());
    let near = |value: f64, wanted: f64| (value - wanted).abs() < 1e-6;
    finite
        && near(r.x.norm_squared(), 1.0)
        && near(r.y.norm_squared(), 1.0)
        && near(r.x.cross(r.y).dot(r.z), 1.0)
        && near(r.x.dot(r.y), 0.0)
        && near(r.z.norm_squared(), 1.0)
}
