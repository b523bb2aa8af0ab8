//! One joint: where it stands in its parent, how it moves, how far it may.

use super::{BallLimits, JointId};
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

/// Limits so many spreads away (for angles: four turns) stand in for none.
const ENDLESS: f64 = 8.0;

/// A closed interval, in radians or metres; infinite ends are allowed.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(from = "[Option<f64>; 2]", into = "[Option<f64>; 2]")
)]
pub struct Limits {
    /// The smallest value allowed.
    pub lower: f64,
    /// The largest value allowed.
    pub upper: f64,
}

impl Limits {
    /// No limit on either side.
    pub const UNBOUNDED: Self = Self {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
    };

    /// From `lower` to `upper`. What is built with these limits checks that they are in order.
    #[must_use]
    pub const fn new(lower: f64, upper: f64) -> Self {
        Self { lower, upper }
    }

    /// Whether both ends are the same number.
    #[must_use]
    pub fn is_locked(&self) -> bool {
        self.lower == self.upper
    }

    /// Neither NaN nor out of order nor an infinity on the wrong side.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.lower <= self.upper && self.lower < f64::INFINITY && self.upper > f64::NEG_INFINITY
    }

    /// Whether `lower <= value && value <= upper`, to the bit.
    #[must_use]
    pub fn contains(&self, value: f64) -> bool {
        self.lower <= value && value <= self.upper
    }

    /// The nearest value within the limits. NaN stays NaN.
    #[must_use]
    #[inline(always)]
    pub fn clamp(&self, value: f64) -> f64 {
        if value < self.lower {
            self.lower
        } else if value > self.upper {
            self.upper
        } else {
            value
        }
    }

    /// Where random values near `at` are drawn from: the limits, where one is missing or so far
    /// away that it only means that there is none, `spread` from `at` instead.
    pub(crate) fn sampling_range(&self, at: f64, spread: f64) -> (f64, f64) {
        let lower = if at - self.lower <= ENDLESS * spread {
            self.lower
        } else {
            at - spread
        };
        let upper = if self.upper - at <= ENDLESS * spread {
            self.upper
        } else {
            at + spread
        };
        (lower, upper)
    }

    /// The values allowed by both.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        Self::new(self.lower.max(other.lower), self.upper.min(other.upper))
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

/// An open end is none: JSON has no infinity.
#[cfg(feature = "serde")]
impl From<Limits> for [Option<f64>; 2] {
    fn from(limits: Limits) -> Self {
        let open = [f64::NEG_INFINITY, f64::INFINITY];
        let ends = [(limits.lower, open[0]), (limits.upper, open[1])];
        ends.map(|(end, open)| (end != open).then_some(end))
    }
}

#[cfg(feature = "serde")]
impl From<[Option<f64>; 2]> for Limits {
    fn from([lower, upper]: [Option<f64>; 2]) -> Self {
        Self::new(
            lower.unwrap_or(f64::NEG_INFINITY),
            upper.unwrap_or(f64::INFINITY),
        )
    }
}
