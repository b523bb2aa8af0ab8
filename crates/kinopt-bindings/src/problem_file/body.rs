//! Centre of mass, feet, weights and priority levels of a body.

use std::str::FromStr;

use super::number_list::{number, parse_exactly, positive};
use super::text::named;

/// Target of a centre of mass.
#[derive(Clone, Debug, PartialEq)]
pub enum Centre {
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
pub struct Foot {
    /// Name of the frame.
    pub frame: String,
    /// Point in the frame, metres; `None` for the frame's own.
    pub at: Option<[f64; 3]>,
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
pub struct FrameWeight {
    /// Name of the frame.
    pub frame: String,
    /// Factor, above 0.
    pub weight: f64,
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
pub struct NamedLevel {
    /// Name of a target, held frame or task.
    pub name: String,
    /// Level, from 0.
    pub level: usize,
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
pub struct Lock {
    /// Name of the joint or bone.
    pub joint: String,
    /// Value, radians or metres; `None` for that of the start.
    pub value: Option<f64>,
    /// True if the value of a revolute joint is in degrees.
    pub degrees: bool,
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
    pub fn typed(&self, degrees: bool) -> Self {
        let lock = self.clone();
        Self { degrees, ..lock }
    }
}
