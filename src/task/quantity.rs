//! What a residual row measures, and so the unit of its error, weight and tolerance.

use std::fmt;

/// The unit of a residual row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[non_exhaustive]
pub enum Quantity {
    /// A length in metres (in the rig's own unit for rigs).
    Metres,
    /// An angle in radians.
    Radians,
    /// A distance in the image, in pixels.
    Pixels,
    /// A joint's own unit: radians or metres.
    JointUnits,
    /// A joint's speed: radians or metres per second.
    JointUnitsPerSecond,
    /// A number without a unit.
    Ratio,
}

impl Quantity {
    /// The unit's symbol.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Metres => "m",
            Self::Radians => "rad",
            Self::Pixels => "px",
            Self::JointUnits => "rad or m",
            Self::JointUnitsPerSecond => "rad/s or m/s",
            Self::Ratio => "",
        }
    }
}

impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Metres => "metres",
            Self::Radians => "radians",
            Self::Pixels => "pixels",
            Self::JointUnits => "joint units",
            Self::JointUnitsPerSecond => "joint units per second",
            Self::Ratio => "ratio",
        })
    }
}

/// Consecutive residual rows of one quantity. Their Euclidean norm is the reported error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rows {
    /// What they measure.
    pub quantity: Quantity,
    /// How many they are.
    pub count: usize,
}

impl Rows {
    /// `count` rows of `quantity`.
    #[must_use]
    pub const fn new(quantity: Quantity, count: usize) -> Self {
        Self { quantity, count }
    }
}
