//! Serial chain of moving joints from base to tip, the input of the SIMD solver.

use kinopt_kinematics::model::JointKind;
use kinopt_kinematics::spatial::{Placement, Vector3};

use super::trigonometry::MAX_ANGLE;
use super::{LaneError, check};

/// Largest number of moving joints of a [`Chain`].
pub const MAX_JOINTS: usize = 64;

/// A moving joint of a [`Chain`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainJoint {
    /// Placement of the joint at value zero, in the frame of the joint before it (the base for the first).
    ///
    /// It includes fixed joints between the two. The rotation is orthonormal.
    pub parent_from_joint: Placement<f64>,
    /// Axis in the joint's frame, of any nonzero length.
    pub axis: Vector3<f64>,
    /// Revolute or prismatic. A continuous joint counts as revolute and has infinite bounds.
    pub kind: JointKind,
    /// Smallest value, radians or metres; −∞ if unbounded.
    pub lower: f64,
    /// Largest value, radians or metres; +∞ if unbounded.
    pub upper: f64,
}

/// Serial chain of moving joints, the model of the SIMD solver.
///
/// `base_from_tip(q) = Π parent_from_joint_i · motion_i(q_i) · joint_from_tip`.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    joints: Vec<ChainJoint>,
    joint_from_tip: Placement<f64>,
    /// Sum of the lengths of all constant translations from base to tip, metres.
    extent: f64,
}

impl Chain {
    /// Builds a chain from its joints, base to tip, and the tip's placement in the last joint's frame.
    ///
    /// # Errors
    /// Returns a [`LaneError`]. A finite bound of a revolute joint beyond a million radians is an error.
    pub fn new(
        mut joints: Vec<ChainJoint>,
        joint_from_tip: Placement<f64>,
    ) -> Result<Self, LaneError> {
        if joints.is_empty() || joints.len() > MAX_JOINTS {
            return Err(LaneError::ChainLength(joints.len()));
        }
        for (index, joint) in joints.iter_mut().enumerate() {
            joint.kind = match joint.kind {
                JointKind::Fixed | JointKind::Ball => return Err(LaneError::FixedJoint(index)),
                JointKind::Prismatic => JointKind::Prismatic,
                JointKind::Revolute | JointKind::Continuous => JointKind::Revolute,
            };
            let length = joint.axis.norm();
            if !(length.is_finite() && length > 1e-12) {
                return Err(LaneError::Axis(index));
            }
            joint.axis = joint.axis * length.recip();
            let (lower, upper) = (joint.lower, joint.upper);
            let too_far =
                |bound: f64| joint.kind.turns() && bound.is_finite() && bound.abs() > MAX_ANGLE;
            // `lower <= upper` is false for NaN.
            let ordered = lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY;
            if !ordered || too_far(lower) || too_far(upper) {
                return Err(LaneError::Bounds {
                    joint: index,
                    lower,
                    upper,
                });
            }
            if !is_rigid(&joint.parent_from_joint) {
                return Err(LaneError::Placement(index));
            }
        }
        if !is_rigid(&joint_from_tip) {
            return Err(LaneError::Placement(joints.len()));
        }
        Ok(Self {
            extent: extent(&joints, &joint_from_tip),
            joints,
            joint_from_tip,
        })
    }

    /// The same chain with at least this extent, for translations that were composed from longer ones; metres.
    #[must_use]
    pub(crate) fn with_extent(mut self, extent: f64) -> Self {
        self.extent = self.extent.max(extent);
        self
    }

    /// Sum of the lengths of all constant translations from base to tip, metres.
    #[must_use]
    pub(crate) fn extent(&self) -> f64 {
        self.extent
    }

    /// Joints, base to tip.
    #[must_use]
    pub fn joints(&self) -> &[ChainJoint] {
        &self.joints
    }

    /// Placement of the tip in the frame of the last joint.
    #[must_use]
    pub fn joint_from_tip(&self) -> &Placement<f64> {
        &self.joint_from_tip
    }

    /// The same joints with another tip. Returns an error if its placement is not rigid.
    pub(crate) fn with_tip(&self, joint_from_tip: Placement<f64>) -> Result<Self, LaneError> {
        if !is_rigid(&joint_from_tip) {
            return Err(LaneError::Placement(self.joints.len()));
        }
        Ok(Self {
            extent: extent(&self.joints, &joint_from_tip),
            joints: self.joints.clone(),
            joint_from_tip,
        })
    }

    /// The same joints with the last joint's frame as tip.
    pub(crate) fn without_tool(&self) -> Self {
        let joint_from_tip = Placement::identity();
        Self {
            extent: extent(&self.joints, &joint_from_tip),
            joints: self.joints.clone(),
            joint_from_tip,
        }
    }

    /// Pose of the tip in the base frame at the joint values `q` (radians or metres).
    ///
    /// # Errors
    /// Returns an error if the length of `q` is not the number of joints, or a value is not finite.
    pub fn base_from_tip(&self, q: &[f64]) -> Result<Placement<f64>, LaneError> {
        check::length("q", q.len(), self.joints.len())?;
        match q.iter().all(|value| value.is_finite()) {
            true => Ok(self.tip_at(q)),
            false => Err(LaneError::NotFinite("q")),
        }
    }

    /// [`base_from_tip`](Self::base_from_tip) without checks; the length of `q` must be the number of joints.
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

/// Sum of the lengths of the constant translations, metres.
fn extent(joints: &[ChainJoint], joint_from_tip: &Placement<f64>) -> f64 {
    let placements = joints.iter().map(|joint| &joint.parent_from_joint);
    let placements = placements.chain([joint_from_tip]);
    placements
        .map(|placement| placement.translation.norm())
        .sum()
}

/// Returns true if the numbers are finite and the rotation is orthonormal and right-handed, to 1e-6.
pub(crate) fn is_rigid(placement: &Placement<f64>) -> bool {
    let r = &placement.rotation;
    let finite = placement
        .translation
        .to_array()
        .iter()
        .all(|v| v.is_finite());
    let is_close = |value: f64, expected: f64| (value - expected).abs() < 1e-6;
    finite
        && is_close(r.x.norm_squared(), 1.0)
        && is_close(r.y.norm_squared(), 1.0)
        && is_close(r.x.cross(r.y).dot(r.z), 1.0)
        && is_close(r.x.dot(r.y), 0.0)
        && is_close(r.z.norm_squared(), 1.0)
}
