//! Joints: placement in the parent, kind, axis and limits.

use super::{BallLimits, JointId, Limits};
use crate::scalar::elementary;
use crate::spatial::{Matrix3, Placement, Vector3};

/// The kind of motion of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum JointKind {
    /// Does not move.
    Fixed,
    /// Rotates about its axis within limits, in radians.
    Revolute,
    /// Rotates about its axis without limits, in radians.
    Continuous,
    /// Translates along its axis within limits, in metres.
    Prismatic,
    /// Rotates about one point, within [`BallLimits`] if it has any.
    ///
    /// Its coordinates are a unit quaternion w, x, y, z.
    Ball,
}

impl JointKind {
    /// True for a ball joint, whose value is a quaternion.
    #[must_use]
    pub const fn is_ball(self) -> bool {
        matches!(self, Self::Ball)
    }

    /// True if the joint moves and so has coordinates in a configuration.
    #[must_use]
    pub const fn moves(self) -> bool {
        !matches!(self, Self::Fixed)
    }

    /// True if the joint rotates the bodies it carries.
    #[must_use]
    pub const fn turns(self) -> bool {
        matches!(self, Self::Revolute | Self::Continuous | Self::Ball)
    }

    /// Number of its coordinates in a configuration.
    #[must_use]
    pub const fn coordinates(self) -> usize {
        match self {
            Self::Fixed => 0,
            Self::Revolute | Self::Continuous | Self::Prismatic => 1,
            Self::Ball => 4,
        }
    }

    /// Number of its components in a velocity.
    #[must_use]
    pub const fn degrees_of_freedom(self) -> usize {
        match self {
            Self::Ball => 3,
            kind => kind.coordinates(),
        }
    }

    /// True if its value is a length.
    #[must_use]
    pub const fn slides(self) -> bool {
        matches!(self, Self::Prismatic)
    }

    /// The kind of a joint of this kind that gets `limits`: a continuous joint with limits becomes revolute.
    #[doc(hidden)]
    pub fn within(self, limits: &Limits) -> Self {
        match self {
            Self::Continuous if *limits != Limits::UNBOUNDED => Self::Revolute,
            kind => kind,
        }
    }

    /// The displacement at a value about or along the unit `axis`, in the joint frame at zero; identity for a ball
    /// joint.
    #[doc(hidden)]
    pub fn joint_from_moved(self, axis: Vector3<f64>, value: f64) -> Placement<f64> {
        match self {
            Self::Fixed | Self::Ball => Placement::identity(),
            Self::Prismatic => Placement::translation(axis * value),
            Self::Revolute | Self::Continuous => Placement::new(
                Matrix3::rotation(axis, elementary::sin_cos(value)),
                Vector3::zero(),
            ),
        }
    }

    /// The name that URDF uses; "ball" has none in URDF.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Fixed => "fixed",
            Self::Revolute => "revolute",
            Self::Continuous => "continuous",
            Self::Prismatic => "prismatic",
            Self::Ball => "ball",
        }
    }
}

/// A joint and the placement of its frame.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Joint {
    /// Name, unique within the model.
    pub name: String,
    /// The parent joint; `None` for the world.
    pub parent: Option<JointId>,
    /// Placement of the joint frame in the parent joint's frame at value zero.
    pub parent_from_joint: Placement<f64>,
    /// The kind of motion.
    pub kind: JointKind,
    /// Unit axis in the joint frame; for a ball joint, the axis of the twist.
    ///
    /// A fixed joint does not use it; a builder sets it to x.
    pub axis: Vector3<f64>,
    /// Range of the value, radians or metres; unbounded for a continuous joint and for a ball joint.
    pub limits: Limits,
    /// Limits of a ball joint; `None`: no limits. `None` for every other kind.
    #[cfg_attr(feature = "serde", serde(default))]
    pub ball: Option<BallLimits>,
}

impl Joint {
    /// A joint from its parts, unchecked. The model builder checks it; the axis need not be of unit length.
    pub fn new(
        name: impl Into<String>,
        parent: Option<JointId>,
        parent_from_joint: impl Into<Placement<f64>>,
        kind: JointKind,
        axis: impl Into<Vector3<f64>>,
        limits: Limits,
    ) -> Self {
        Self {
            name: name.into(),
            parent,
            parent_from_joint: parent_from_joint.into(),
            kind,
            axis: axis.into(),
            limits,
            ball: None,
        }
    }

    /// True if the joint is not fixed and its limits allow more than one value.
    #[doc(hidden)]
    pub fn moves(&self) -> bool {
        self.kind != JointKind::Fixed && !self.limits.is_locked()
    }

    /// True if it moves and rotates the bodies it carries.
    pub(crate) fn turns(&self) -> bool {
        self.moves() && self.kind != JointKind::Prismatic
    }
}
