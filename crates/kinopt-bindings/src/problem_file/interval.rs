//! Goal bounds: allowed offset of a pose component from its target.

use std::str::FromStr;

use super::number_list::{not_negative, number};

const AXES: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];
const SHAPE: &str = "expected AXIS=WIDTH, AXIS=LOW..HIGH or AXIS=free, \
                     the axis one of x, y, z, rx, ry, rz";

/// Goal bounds of one component of the tip's pose: offset from the target, in metres and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Index of the component: x, y, z, then the rotations about them.
    pub axis: usize,
    /// Lower end of the offset, metres or radians.
    pub low: f64,
    /// Upper end of the offset, metres or radians.
    pub high: f64,
}

impl FromStr for Interval {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (axis, width) = text.split_once('=').ok_or(SHAPE)?;
        let axis = AXES.iter().position(|name| *name == axis.trim());
        let axis = axis.ok_or(SHAPE)?;
        let (low, high) = match (width.trim(), width.split_once("..")) {
            ("free", _) => (f64::NEG_INFINITY, f64::INFINITY),
            (_, Some((low, high))) => (number(low.trim())?, number(high.trim())?),
            (width, None) => {
                let width = not_negative(width)?;
                (-width, width)
            }
        };
        if low > high {
            return Err(format!(
                "{low}..{high}: the lower end is above the upper end"
            ));
        }
        if axis >= 3 && low != -high {
            return Err(format!(
                "bounds of a rotation are symmetric: expected {}=ANGLE, not {low}..{high}",
                AXES[axis]
            ));
        }
        Ok(Self { axis, low, high })
    }
}

impl Interval {
    /// True for a rotation.
    pub fn turns(&self) -> bool {
        self.axis >= 3
    }

    /// Interval of an option, with its unit of angles.
    pub fn typed(mut self, degrees: bool) -> Self {
        if degrees && self.turns() {
            (self.low, self.high) = (self.low.to_radians(), self.high.to_radians());
        }
        self
    }
}
