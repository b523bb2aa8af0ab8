//! Units of residual rows, of their errors, weights and tolerances.

use std::fmt;

use kinopt_kinematics::model::LengthUnit;
use kinopt_kinematics::scalar::elementary;

/// The unit of a residual row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Quantity {
    /// A length in metres (in the rig's unit for rigs).
    Metres,
    /// An angle in radians.
    Radians,
    /// A distance in the image, in pixels.
    Pixels,
    /// The unit of a joint: radians or metres.
    JointUnits,
    /// A joint velocity: radians or metres per second.
    JointUnitsPerSecond,
    /// A velocity in metres per second (in the rig's unit for rigs).
    MetresPerSecond,
    /// An angular velocity in radians per second.
    RadiansPerSecond,
    /// A number without unit.
    Ratio,
}

impl Quantity {
    /// The symbol of the unit, for a model with this unit of length.
    #[must_use]
    pub fn unit(self, length: LengthUnit) -> &'static str {
        match (self, length) {
            (Self::Metres, length) => length.symbol(),
            (Self::Radians, _) => "rad",
            (Self::Pixels, _) => "px",
            (Self::JointUnits, LengthUnit::Metres) => "rad or m",
            (Self::JointUnits, LengthUnit::Own) => "rad or units",
            (Self::JointUnitsPerSecond, LengthUnit::Metres) => "rad/s or m/s",
            (Self::JointUnitsPerSecond, LengthUnit::Own) => "rad/s or units/s",
            (Self::MetresPerSecond, LengthUnit::Metres) => "m/s",
            (Self::MetresPerSecond, LengthUnit::Own) => "units/s",
            (Self::RadiansPerSecond, _) => "rad/s",
            (Self::Ratio, _) => "",
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
            Self::MetresPerSecond => "metres per second",
            Self::RadiansPerSecond => "radians per second",
            Self::Ratio => "ratio",
        })
    }
}

/// A row block: consecutive residual rows of one quantity. Their Euclidean norm is the reported error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RowBlock {
    /// The unit of the rows.
    pub quantity: Quantity,
    /// Number of rows.
    pub count: usize,
    /// True if the norm of the rows is a chord.
    chords: bool,
}

impl RowBlock {
    /// `count` rows of `quantity`.
    #[must_use]
    pub const fn new(quantity: Quantity, count: usize) -> Self {
        Self {
            quantity,
            count,
            chords: false,
        }
    }

    /// `count` rows whose norm is the chord 2 sin(θ/2) of an angle θ, such as twice a quaternion's vector part.
    ///
    /// The reported error is the angle, in radians.
    #[must_use]
    pub const fn chords(count: usize) -> Self {
        Self {
            quantity: Quantity::Radians,
            count,
            chords: true,
        }
    }

    /// The error for a norm of these rows, in the quantity's unit.
    #[must_use]
    #[doc(hidden)]
    pub fn error_of(self, norm: f64) -> f64 {
        match self.chords {
            true => angle_of(norm),
            false => norm,
        }
    }
}

/// The angle within [0, π] of a chord of the unit circle.
#[doc(hidden)]
pub fn angle_of(chord: f64) -> f64 {
    2.0 * elementary::asin((0.5 * chord).min(1.0))
}

/// The chord of an angle.
pub(crate) fn chord_of(angle: f64) -> f64 {
    2.0 * elementary::sin(0.5 * angle)
}
