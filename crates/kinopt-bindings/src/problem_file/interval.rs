//! Goal bounds: allowed offset of a pose component from its target.

use std::str::FromStr;

use super::number_list::{not_negative, number};

const AXES: [&str; 6] = ["x", "y", "z", "rx", "ry", "rz"];
const SHAPE: &str = "expected AXIS=WIDTH, AXIS=LOW..HIGH or AXIS=free, \
                     the axis one of x, y, z, rx, ry, rz";

/// Goal bounds of one component of the tip's pose: offset from the target, in metres and radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    /// Index of the component: x, y, z, then the rotations about them.
    pub(crate) axis: usize,
    pub(crate) low: f64,
    pub(crate) high: f64,
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
    pub(crate) fn turns(&self) -> bool {
        self.axis >= 3
    }

    /// Interval of an option, with its unit of angles.
    pub(crate) fn typed(mut self, degrees: bool) -> Self {
        if degrees && self.turns() {
            (self.low, self.high) = (self.low.to_radians(), self.high.to_radians());
        }
        self
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn interval_widths_and_ends_parse() {
        let at = |axis, low, high| Ok(Interval { axis, low, high });
        assert_eq!(Interval::from_str("x=0.01"), at(0, -0.01, 0.01));
        assert_eq!(Interval::from_str("z=-0.01..0.03"), at(2, -0.01, 0.03));
        assert_eq!(Interval::from_str("ry=0.5"), at(4, -0.5, 0.5));
        let free = at(5, f64::NEG_INFINITY, f64::INFINITY);
        assert_eq!(Interval::from_str("rz=free"), free);
        for (bad, reason) in [
            ("x", "AXIS=WIDTH"),
            ("w=1", "rx, ry, rz"),
            ("x=-1", "below 0"),
            ("x=2..1", "above the upper end"),
            ("rx=0..1", "symmetric"),
            ("x=wide", "not a number"),
        ] {
            let error = Interval::from_str(bad).unwrap_err();
            assert!(error.contains(reason), "{bad}: {error}");
        }
    }
}
