//! Which captured joint drives which frame of a model.

use std::collections::BTreeMap;
use std::fmt;

use glam::Vec3;
use serde::de::value::MapAccessDeserializer;
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use super::RetargetError;
use super::capture::check_named_once;
use crate::bad_option::{BadOption, Range};
use crate::spatial::{Matrix3, Vector3};

/// Weights whose squares, and scales and offsets whose products with places, stay finite.
const WEIGHT: Range = (|v| (0.0..=1e6).contains(&v), "within [0, 1e6]");
const SCALE: Range = (|v| (1e-6..=1e6).contains(&v), "within [1e-6, 1e6]");
const OFFSET: Range = (|v| v.abs() <= 1e6, "within [-1e6, 1e6] m");
const FRAME_RATE: Range = (|v| (1e-6..=1e6).contains(&v), "within [1e-6, 1e6]");

/// What a captured joint drives.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Drive {
    /// The captured joint.
    pub joint: String,
    /// The model's frame.
    pub frame: String,
    /// The frame's point, in its coordinates, metres.
    pub offset: Vector3<f64>,
    /// How much it counts beside the others.
    pub weight: f64,
    /// How long the limb that it ends is, for a metre of the person's; `None` where that is measured.
    pub scale: Option<f64>,
}

/// The axis of a capture that points upward.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum UpAxis {
    /// As in captures for animation.
    Y,
    /// As in robotics.
    #[default]
    Z,
}

impl UpAxis {
    /// Name of the axis: "y" or "z".
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Y => "y",
            Self::Z => "z",
        }
    }

    /// The turn that stands up along z what stands up along this axis: by a quarter about x, or none.
    #[must_use]
    pub fn turned_to_z(self) -> Matrix3<f64> {
        let [x, y, z] = Vector3::UNITS.map(|axis| self.upright(axis));
        Matrix3::from_columns(x, y, z)
    }

    /// A vector so turned, without a product.
    pub(super) fn upright(self, at: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Y => Vector3::new(at.x, -at.z, at.y),
            Self::Z => at,
        }
    }
}

impl From<UpAxis> for Vec3 {
    fn from(up: UpAxis) -> Self {
        match up {
            UpAxis::Y => Self::Y,
            UpAxis::Z => Self::Z,
        }
    }
}

/// A map from a capture to a model.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BodyMap {
    /// The captured joints in the order of an array, where the map says it.
    pub joints: Vec<String>,
    /// Frames a second, where the map says it.
    pub frame_rate: Option<f64>,
    /// Which way is up, where the map says it.
    pub up: Option<UpAxis>,
    /// What drives what.
    pub drives: Vec<Drive>,
    /// The captured joints that stand on something at times; `None` for those whose names tell of feet.
    pub contacts: Option<Vec<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    #[allow(dead_code)]
    about: Option<String>,
    #[serde(default)]
    joints: Vec<String>,
    #[serde(default)]
    fps: Option<f64>,
    #[serde(default)]
    up: Option<UpAxis>,
    #[serde(default)]
    drives: Option<BTreeMap<String, Value>>,
    #[serde(default)]
    contacts: Option<Vec<String>>,
}

/// What a drive is in a file, where more than a frame's name is said.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DriveInFull {
    frame: String,
    #[serde(default, skip_serializing_if = "is_zero")]
    offset: [f64; 3],
    #[serde(default = "one", skip_serializing_if = "is_one")]
    weight: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    scale: Option<f64>,
}

/// What a drive is in a file.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub(super) enum DriveText {
    Frame(String),
    InFull(DriveInFull),
}

/// As of an untagged enum, of which serde would say only that no variant fits.
impl<'de> Deserialize<'de> for DriveText {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct EitherWay;

        impl<'de> Visitor<'de> for EitherWay {
            type Value = DriveText;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a frame's name, or an object with its `frame`")
            }

            fn visit_str<E: de::Error>(self, frame: &str) -> Result<DriveText, E> {
                Ok(DriveText::Frame(frame.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<DriveText, A::Error> {
                let full = DriveInFull::deserialize(MapAccessDeserializer::new(map));
                full.map(DriveText::InFull)
            }
        }

        deserializer.deserialize_any(EitherWay)
    }
}

const fn one() -> f64 {
    1.0
}

fn is_one(weight: &f64) -> bool {
    *weight == 1.0
}

fn is_zero(offset: &[f64; 3]) -> bool {
    *offset == [0.0; 3]
}

impl DriveText {
    pub(super) fn frame(&self) -> &str {
        match self {
            Self::Frame(frame) => frame,
            Self::InFull(full) => &full.frame,
        }
    }

    pub(super) fn into_drive(self, joint: String) -> Drive {
        match self {
            Self::Frame(frame) => Drive::new(joint, frame),
            Self::InFull(full) => Drive {
                offset: Vector3::from(full.offset),
                weight: full.weight,
                scale: full.scale,
                ..Drive::new(joint, full.frame)
            },
        }
    }

    fn of(drive: &Drive) -> Self {
        let full = DriveInFull {
            frame: drive.frame.clone(),
            offset: drive.offset.to_array(),
            weight: drive.weight,
            scale: drive.scale,
        };
        match is_zero(&full.offset) && is_one(&full.weight) && full.scale.is_none() {
            true => Self::Frame(full.frame),
            false => Self::InFull(full),
        }
    }
}

impl BodyMap {
    /// Reads a map from JSON:
    ///
    /// ```json
    /// {"joints": ["Hips", "LeftFoot"], "fps": 120, "up": "z",
    ///  "drives": {"Hips": "pelvis", "LeftFoot": {"frame": "left_ankle", "weight": 2, "offset": [0, 0, -0.05], "scale": 0.8}},
    ///  "contacts": ["LeftFoot"]}
    /// ```
    ///
    /// All may be left out. One file may hold the drives of several robots, under the names of their files: `robot` says which
    /// of them is meant. A map without drives of that robot has none, and is [completed](Self::completed) by names.
    ///
    /// # Errors
    /// Text that is none such, the error says where; `drives` of nothing, a joint of the array named twice, a rate that is not positive.
    pub fn from_json(text: &str, robot: &str) -> Result<Self, RetargetError> {
        let wrong = |error: serde_json::Error| RetargetError::Map(error.to_string());
        if text.trim_start().starts_with('[') {
            let list = "a map is an object whose `drives` say what drives what, not a list";
            return Err(RetargetError::Map(list.to_owned()));
        }
        let file: File = serde_json::from_str(text).map_err(wrong)?;
        if file.drives.as_ref().is_some_and(BTreeMap::is_empty) {
            return Err(RetargetError::NoDrives {
                model: robot.to_owned(),
            });
        }
        if let Some(rate) = file.fps {
            BadOption::check("frames a second", rate, FRAME_RATE)?;
        }
        check_named_once(&file.joints)?;
        let drives = file.drives.unwrap_or_default();
        let of_robots = |value: &Value| value.is_object() && value.get("frame").is_none();
        let drives = match drives.values().any(of_robots) {
            false => drives,
            true => match drives.get(robot) {
                Some(own) => serde_json::from_value(own.clone()).map_err(wrong)?,
                None => BTreeMap::new(),
            },
        };
        let drives = drives.into_iter().map(|(joint, value)| {
            let told = |error| RetargetError::Map(format!("drives: {joint}: {error}"));
            let drive: DriveText = serde_json::from_value(value).map_err(told)?;
            let drive = drive.into_drive(joint);
            drive.check()?;
            Ok(drive)
        });
        Ok(Self {
            drives: drives.collect::<Result<_, RetargetError>>()?,
            joints: file.joints,
            frame_rate: file.fps,
            up: file.up,
            contacts: file.contacts,
        })
    }

    /// As [`from_json`](Self::from_json) reads it: a line for each drive, to be corrected by hand.
    #[must_use]
    pub fn to_json(&self) -> String {
        let text = |value: Value| value.to_string();
        let mut parts: Vec<String> = Vec::new();
        if !self.joints.is_empty() {
            parts.push(format!(
                "\"joints\": {}",
                text(Value::from(self.joints.clone()))
            ));
        }
        if let Some(rate) = self.frame_rate {
            parts.push(format!("\"fps\": {}", text(Value::from(rate))));
        }
        if let Some(up) = self.up {
            parts.push(format!("\"up\": \"{}\"", up.name()));
        }
        let drives = self.drives.iter().map(|drive| {
            let joint = text(Value::from(drive.joint.clone()));
            let told = serde_json::to_string(&DriveText::of(drive)).unwrap_or_default();
            format!("    {joint}: {told}")
        });
        let drives: Vec<String> = drives.collect();
        parts.push(format!("\"drives\": {{\n{}\n  }}", drives.join(",\n")));
        if let Some(contacts) = &self.contacts {
            parts.push(format!(
                "\"contacts\": {}",
                text(Value::from(contacts.clone()))
            ));
        }
        format!("{{\n  {}\n}}\n", parts.join(",\n  "))
    }
}

impl Drive {
    /// A joint that drives a frame's origin, counting as the others do.
    #[must_use]
    pub fn new(joint: impl Into<String>, frame: impl Into<String>) -> Self {
        Self {
            joint: joint.into(),
            frame: frame.into(),
            offset: Vector3::zero(),
            weight: 1.0,
            scale: None,
        }
    }

    /// Checks its numbers.
    ///
    /// # Errors
    /// A weight, a scale or an offset out of its range.
    pub(super) fn check(&self) -> Result<(), BadOption> {
        BadOption::check("weight", self.weight, WEIGHT)?;
        for offset in self.offset.to_array() {
            BadOption::check("offset", offset, OFFSET)?;
        }
        self.scale
            .map_or(Ok(()), |scale| BadOption::check("scale", scale, SCALE))
    }

    /// Whether its name tells of a foot.
    pub(super) fn is_of_a_foot(&self) -> bool {
        let name = self.joint.to_lowercase();
        ["foot", "toe", "ankle", "heel", "sole"]
            .iter()
            .any(|part| name.contains(part))
    }
}
