//! Centre of mass, feet, weights and priority levels of a body.

use std::str::FromStr;

use super::number_list::{number, parse_exactly, positive};
use super::text::named;

/// Target of a centre of mass.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Centre {
    /// The two horizontal coordinates.
    Above([f64; 2]),
    /// All coordinates; `None` for a free one.
    At([Option<f64>; 3]),
}

impl FromStr for Centre {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        let part = |text: &str| match text {
            "free" => Ok(None),
            text => number(text).map(Some),
        };
        match *parts.as_slice() {
            [x, y] => Ok(Self::Above([number(x)?, number(y)?])),
            ["free", "free", "free"] => {
                Err("at least one coordinate must not be `free`".to_owned())
            }
            [x, y, z] => Ok(Self::At([part(x)?, part(y)?, part(z)?])),
            _ => Err(format!(
                "expected x,y or x,y,z, not {} numbers",
                parts.len()
            )),
        }
    }
}

/// Frame in contact with the ground, with a point of the frame.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Foot {
    pub(crate) frame: String,
    pub(crate) at: Option<[f64; 3]>,
}

impl FromStr for Foot {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (frame, at) = match text.rsplit_once('=') {
            Some((frame, at)) => (frame, Some(parse_exactly(at, "the point")?)),
            None => (text, None),
        };
        match frame.trim() {
            "" => Err("expected FRAME or FRAME=x,y,z".to_owned()),
            frame => Ok(Self {
                frame: frame.to_owned(),
                at,
            }),
        }
    }
}

/// Factor of a frame's errors: `FRAME=WEIGHT`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct FrameWeight {
    pub(crate) frame: String,
    pub(crate) weight: f64,
}

impl FromStr for FrameWeight {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (frame, weight) = named(text, "FRAME=WEIGHT")?;
        let weight = positive(weight)?;
        Ok(Self { frame, weight })
    }
}

/// Priority level of a named task: `NAME=LEVEL`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct NamedLevel {
    pub(crate) name: String,
    pub(crate) level: usize,
}

impl FromStr for NamedLevel {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, level) = named(text, "NAME=LEVEL")?;
        let level = level.parse();
        let level =
            level.map_err(|_| format!("`{text}` has no level; expected a whole number from 0"))?;
        Ok(Self { name, level })
    }
}

/// Joint to lock, at a value in radians or metres, or at its start value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Lock {
    pub(crate) joint: String,
    pub(crate) value: Option<f64>,
    /// True if the value of a revolute joint is in degrees.
    pub(crate) degrees: bool,
}

impl FromStr for Lock {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (joint, value) = match text.rsplit_once('=') {
            Some((joint, value)) => (joint, Some(number(value.trim())?)),
            None => (text, None),
        };
        match joint.trim() {
            "" => Err("expected JOINT or JOINT=VALUE".to_owned()),
            joint => Ok(Self {
                joint: joint.to_owned(),
                value,
                degrees: false,
            }),
        }
    }
}

impl Lock {
    /// Lock of an option, with its unit of angles.
    pub(crate) fn typed(&self, degrees: bool) -> Self {
        let lock = self.clone();
        Self { degrees, ..lock }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn centres_and_feet_parse() {
        let centre = |text: &str| text.parse::<Centre>();
        assert_eq!(centre("1,-2"), Ok(Centre::Above([1.0, -2.0])));
        let at = [Some(0.5), None, Some(2.0)];
        assert_eq!(centre("0.5, free,2"), Ok(Centre::At(at)));
        for bad in ["1", "1,2,3,4", "free,free,free", "a,b", "free,1"] {
            assert!(centre(bad).is_err(), "{bad}");
        }
        let foot = |at| Foot {
            frame: "foot".to_owned(),
            at,
        };
        assert_eq!("foot".parse(), Ok(foot(None)));
        assert_eq!("foot=1,2,3".parse(), Ok(foot(Some([1.0, 2.0, 3.0]))));
        for bad in ["", "=1,2,3", "foot=1,2"] {
            assert!(bad.parse::<Foot>().is_err(), "{bad}");
        }
    }

    #[test]
    fn locks_parse() {
        let lock = |joint: &str, value| Lock {
            joint: joint.to_owned(),
            value,
            degrees: false,
        };
        assert_eq!("elbow".parse(), Ok(lock("elbow", None)));
        assert_eq!("a=b=-1.5".parse(), Ok(lock("a=b", Some(-1.5))));
        for bad in ["", "=1", "a=", "a=x", "a=nan"] {
            assert!(bad.parse::<Lock>().is_err(), "{bad}");
        }
    }
}
