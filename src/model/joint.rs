//! One joint: where it stands in its parent, how it moves, how far it may.

use super::{BallLimits, JointId, Limits};
use crate::scalar::elementary;
use crate::spatial::{Matrix3, Placement, Vector3};

/// The way a joint moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum JointKind {
    /// It does not.
    Fixed,
    /// Turns about its axis within limits, in radians.
    Revolute,
    /// Turns about its axis without limits, in radians.
    Continuous,
    /// Slides along its axis within limits, in metres.
    Prismatic,
    /// Turns any way about one point, within [`BallLimits`] if it has any; in a configuration it is a unit
    /// quaternion w, x, y, z.
    Ball,
}

impl JointKind {
    /// Whether it is a ball, whose value is a quaternion.
    #[must_use]
    pub const fn is_ball(self) -> bool {
        matches!(self, Self::Ball)
    }

    /// Whether it moves at all: its value is a number of the configuration.
    #[must_use]
    pub const fn moves(self) -> bool {
        !matches!(self, Self::Fixed)
    }

    /// Whether it turns what it carries.
    #[must_use]
    pub const fn turns(self) -> bool {
        matches!(self, Self::Revolute | Self::Continuous | Self::Ball)
    }

    /// How many numbers of a configuration are its own.
    #[must_use]
    pub const fn coordinates(self) -> usize {
        match self {
            Self::Fixed => 0,
            Self::Revolute | Self::Continuous | Self::Prismatic => 1,
            Self::Ball => 4,
        }
    }

    /// How many ways it can move: how many numbers of a velocity are its own.
    #[must_use]
    pub const fn degrees_of_freedom(self) -> usize {
        match self {
            Self::Ball => 3,
            kind => kind.coordinates(),
        }
    }

    /// Whether its value is a length.
    #[must_use]
    pub const fn slides(self) -> bool {
        matches!(self, Self::Prismatic)
    }

    /// What a joint is that has these limits: one without any that gets some is one with limits.
    pub(crate) fn within(self, limits: &Limits) -> Self {
        match self {
            Self::Continuous if *limits != Limits::UNBOUNDED => Self::Revolute,
            kind => kind,
        }
    }

    /// Where a value about or along a unit axis takes it, in its own frame at zero; a ball stays.
    pub(crate) fn joint_from_moved(self, axis: Vector3<f64>, value: f64) -> Placement<f64> {
        match self {
            Self::Fixed | Self::Ball => Placement::identity(),
            Self::Prismatic => Placement::translation(axis * value),
            Self::Revolute | Self::Continuous => Placement::new(
                Matrix3::rotation(axis, elementary::sin_cos(value)),
                Vector3::zero(),
            ),
        }
    }

    /// What URDF calls it, or would.
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
    /// Unique within the model.
    pub name: String,
    /// The joint it stands on; `None` for the world.
    pub parent: Option<JointId>,
    /// Where the joint's frame stands in its parent's at value zero.
    pub parent_from_joint: Placement<f64>,
    /// How it moves.
    pub kind: JointKind,
    /// Unit axis in the joint's own frame; meaningless for a fixed joint, whose axis a builder
    /// sets to x; that of a ball joint's twist.
    pub axis: Vector3<f64>,
    /// Its range; unbounded for a continuous joint and for a ball.
    pub limits: Limits,
    /// How far a ball joint may go; `None` anywhere, as for any other kind.
    #[cfg_attr(feature = "serde", serde(default))]
    pub ball: Option<BallLimits>,
}

impl Joint {
    /// A joint of its parts. What is built of it checks them; the axis need not be of unit length.
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

    /// Whether its limits leave it room to move.
    pub(crate) fn moves(&self) -> bool {
        self.kind != JointKind::Fixed && !self.limits.is_locked()
    }

    /// Whether it turns what it carries.
    pub(crate) fn turns(&self) -> bool {
        self.moves() && self.kind != JointKind::Prismatic
    }
}
