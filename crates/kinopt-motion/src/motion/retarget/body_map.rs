//! Mapping of captured joints to frames of a model.

use std::collections::BTreeMap;
use std::fmt;

use glam::Vec3;
use serde::de::value::MapAccessDeserializer;
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};
use serde_json::Value;

use super::capture::check_named_once;
use super::{HumanBones, RetargetError};
use kinopt_kinematics::bad_option::{BadOption, Range};
use kinopt_kinematics::spatial::{Matrix3, Vector3};

/// Ranges in which squared weights and scaled positions stay finite.
const WEIGHT_RANGE: Range = (|v| (0.0..=1e6).contains(&v), "within [0, 1e6]");
const SCALE_RANGE: Range = (|v| (1e-6..=1e6).contains(&v), "within [1e-6, 1e6]");
const OFFSET_RANGE: Range = (|v| v.abs() <= 1e6, "within [-1e6, 1e6] m");
const FRAME_RATE_RANGE: Range = (|v| (1e-6..=1e6).contains(&v), "within [1e-6, 1e6]");

/// Assignment of a captured joint to a frame of the model.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Drive {
    /// Name of the captured joint.
    pub joint: String,
    /// Name of the model's frame.
    pub frame: String,
    /// Driven point in the frame's coordinates, metres.
    pub offset: Vector3<f64>,
    /// Weight relative to other assignments.
    pub weight: f64,
    /// Ratio of the model's limb length to the subject's, for the limb that ends here; `None` to measure it.
    pub scale: Option<f64>,
}

/// Upward axis of a capture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum UpAxis {
    /// The y axis, common in animation.
    Y,
    /// The z axis, common in robotics.
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

    /// Returns the rotation that maps this axis to z: 90° about x for y, the identity for z.
    #[must_use]
    pub fn turned_to_z(self) -> Matrix3<f64> {
        let [x, y, z] = Vector3::UNITS.map(|axis| self.upright(axis));
        Matrix3::from_columns(x, y, z)
    }

    /// Returns a vector rotated by [`turned_to_z`](Self::turned_to_z), without a matrix product.
    pub(super) fn upright(self, vector: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Y => Vector3::new(vector.x, -vector.z, vector.y),
            Self::Z => vector,
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

/// Mapping of a capture to a model.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct BodyMap {
    /// Joint names in the order of an array, if the map has them.
    pub joints: Vec<String>,
    /// Capture frames per second, if the map has the rate.
    pub frame_rate: Option<f64>,
    /// Upward axis, if the map has it.
    pub up: Option<UpAxis>,
    /// Assignments of captured joints to frames.
    pub drives: Vec<Drive>,
    /// Captured joints that make contact; `None` for those with names of foot parts.
    pub contacts: Option<Vec<String>>,
    /// Table of the character's human bones, for guesses. Its bones take precedence over names.
    pub human_bones: HumanBones,
    /// Table of the subject's human bones, for guesses. Its joints take precedence over names.
    pub source_human_bones: HumanBones,
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
    #[serde(default)]
    human_bones: HumanBones,
    #[serde(default)]
    source_human_bones: HumanBones,
}

/// File format of an assignment with more than the name of a frame.
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

/// File format of an assignment.
#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub(super) enum DriveText {
    Frame(String),
    InFull(DriveInFull),
}

/// Untagged enum with a better error than that of serde, which only reports that no variant matches.
impl<'de> Deserialize<'de> for DriveText {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct DriveTextVisitor;

        impl<'de> Visitor<'de> for DriveTextVisitor {
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

        deserializer.deserialize_any(DriveTextVisitor)
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

    pub(super) fn of(drive: &Drive) -> Self {
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
    /// Parses a map from JSON:
    ///
    /// ```json
    /// {"joints": ["Hips", "LeftFoot"], "fps": 120, "up": "z",
    ///  "drives": {"Hips": "pelvis", "LeftFoot": {"frame": "left_ankle", "weight": 2, "offset": [0, 0, -0.05], "scale": 0.8}},
    ///  "contacts": ["LeftFoot"]}
    /// ```
    ///
    /// All fields are optional. `human_bones` and `source_human_bones` are tables of human bones of the character and the
    /// subject, such as `{"hips": "J_Bip_C_Hips"}`. One file may contain the assignments of several robots, by the names of their files.
    /// `robot` selects one of them. A map without assignments for that robot is [completed](Self::completed) by names.
    ///
    /// # Errors
    /// Returns an error, with its position, if the text is malformed. Returns an error if `drives` is empty, a joint
    /// appears twice, or the frame rate is not positive.
    pub fn from_json(text: &str, robot: &str) -> Result<Self, RetargetError> {
        let map_error = |error: serde_json::Error| RetargetError::Map(error.to_string());
        if text.trim_start().starts_with('[') {
            let message = "a map must be an object with `drives`, not a list";
            return Err(RetargetError::Map(message.to_owned()));
        }
        let file: File = serde_json::from_str(text).map_err(map_error)?;
        if file.drives.as_ref().is_some_and(BTreeMap::is_empty) {
            return Err(RetargetError::NoDrives {
                model: robot.to_owned(),
            });
        }
        if let Some(rate) = file.fps {
            BadOption::check("frames a second", rate, FRAME_RATE_RANGE)?;
        }
        check_named_once(&file.joints)?;
        let drives = file.drives.unwrap_or_default();
        let is_per_robot = |value: &Value| value.is_object() && value.get("frame").is_none();
        let drives = match drives.values().any(is_per_robot) {
            false => drives,
            true => match drives.get(robot) {
                Some(robot_drives) => {
                    serde_json::from_value(robot_drives.clone()).map_err(map_error)?
                }
                None => BTreeMap::new(),
            },
        };
        let drives = drives.into_iter().map(|(joint, value)| {
            let parse_error = |error| RetargetError::Map(format!("drives: {joint}: {error}"));
            let drive: DriveText = serde_json::from_value(value).map_err(parse_error)?;
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
            human_bones: file.human_bones,
            source_human_bones: file.source_human_bones,
        })
    }

    /// Formats the map as JSON for [`from_json`](Self::from_json), with one assignment per line for editing.
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
            let json = serde_json::to_string(&DriveText::of(drive)).unwrap_or_default();
            format!("    {joint}: {json}")
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
    /// Creates an assignment to the origin of a frame, with weight 1.
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

    /// Checks the ranges of all numbers.
    ///
    /// # Errors
    /// Returns an error if a weight, a scale or an offset is out of its range.
    pub(super) fn check(&self) -> Result<(), BadOption> {
        BadOption::check("weight", self.weight, WEIGHT_RANGE)?;
        for offset in self.offset.to_array() {
            BadOption::check("offset", offset, OFFSET_RANGE)?;
        }
        self.scale.map_or(Ok(()), |scale| {
            BadOption::check("scale", scale, SCALE_RANGE)
        })
    }

    /// Returns whether the joint's name contains that of a foot part.
    pub(in crate::motion) fn names_foot_part(&self) -> bool {
        let name = self.joint.to_lowercase();
        ["foot", "toe", "ankle", "heel", "sole"]
            .iter()
            .any(|part| name.contains(part))
    }
}
