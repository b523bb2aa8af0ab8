//! Built-in maps of skeletons and robots, from `maps/` of the sources.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::body_map::DriveText;
use super::part_names::bare;
use super::{BodyPart, RetargetError};
use kinopt_kinematics::model::{Model, UnknownName};

const SKELETONS: [(&str, &str); 4] = [
    ("cmu", include_str!("../../../maps/skeletons/cmu.json")),
    (
        "lafan1",
        include_str!("../../../maps/skeletons/lafan1.json"),
    ),
    (
        "mixamo",
        include_str!("../../../maps/skeletons/mixamo.json"),
    ),
    ("smpl", include_str!("../../../maps/skeletons/smpl.json")),
];

const BODIES: [(&str, &str); 1] = [(
    "humanoid",
    include_str!("../../../maps/bodies/humanoid.json"),
)];

/// Built-in skeleton with known joint names: `cmu`, `lafan1`, `mixamo` or `smpl`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct KnownSkeleton {
    name: &'static str,
    joints: Vec<String>,
    known_by: Vec<String>,
    parts: BTreeMap<BodyPart, String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SkeletonFile {
    #[allow(dead_code)]
    about: String,
    joints: Vec<String>,
    #[serde(default)]
    known_by: Vec<String>,
    parts: BTreeMap<BodyPart, String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct BodyFile {
    #[allow(dead_code)]
    about: String,
    parts: BTreeMap<BodyPart, DriveText>,
}

impl KnownSkeleton {
    /// Names of the built-in skeletons.
    pub fn names() -> impl Iterator<Item = &'static str> {
        SKELETONS.iter().map(|(name, _)| *name)
    }

    /// Returns the built-in skeleton of a name.
    ///
    /// # Errors
    /// Returns an error that lists the valid names if the skeleton does not exist.
    pub fn named(name: &str) -> Result<Self, RetargetError> {
        let known = SKELETONS.iter().find(|(key, _)| *key == name);
        let unknown = || UnknownName::new("skeleton", name, Self::names());
        let (name, text) = known.ok_or_else(unknown)?;
        let map_error = |error: serde_json::Error| RetargetError::Map(format!("{name}: {error}"));
        let file: SkeletonFile = serde_json::from_str(text).map_err(map_error)?;
        Ok(Self {
            name,
            joints: file.joints,
            known_by: file.known_by,
            parts: file.parts,
        })
    }

    /// Returns the first built-in skeleton whose parts are all among the joints of a capture.
    #[must_use]
    pub fn of_joints(joints: &[String]) -> Option<Self> {
        let known_skeletons = Self::names().filter_map(|name| Self::named(name).ok());
        let mut known_skeletons = known_skeletons.filter(|known| known.parts_in(joints).is_some());
        known_skeletons.next()
    }

    /// Name of the skeleton.
    #[must_use]
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Joints in the order of arrays; empty if there is no fixed order, as for Mixamo.
    #[must_use]
    pub fn joints(&self) -> &[String] {
        &self.joints
    }

    /// Returns the joint names of an array: all of the skeleton, or the first `joints` of them.
    #[must_use]
    pub fn joints_of_array(&self, joints: usize) -> Option<&[String]> {
        let last = self
            .parts
            .values()
            .filter_map(|joint| self.joints.iter().position(|name| name == joint));
        let min_joints = last.max()? + 1;
        self.joints.get(..joints).filter(|_| joints >= min_joints)
    }

    /// Returns the joint index of each part, or `None` if one is missing. Namespace prefixes of names are ignored.
    pub(super) fn parts_in(&self, joints: &[String]) -> Option<BTreeMap<BodyPart, usize>> {
        let bare_names: Vec<String> = joints.iter().map(|name| bare(name)).collect();
        let position_of = |name: &String| {
            bare_names
                .iter()
                .position(|candidate| *candidate == bare(name))
        };
        if !self.known_by.iter().all(|name| position_of(name).is_some()) {
            return None;
        }
        let parts = self.parts.iter();
        parts
            .map(|(part, name)| Some((*part, position_of(name)?)))
            .collect()
    }
}

/// Built-in robot or character with known frame names.
#[derive(Clone, Debug)]
pub(super) struct KnownBody {
    pub(super) name: &'static str,
    pub(super) parts: BTreeMap<BodyPart, DriveText>,
}

impl KnownBody {
    /// Returns the first built-in body whose frames all exist in a model.
    pub(super) fn of_model(model: &Model) -> Result<Option<Self>, RetargetError> {
        for (name, text) in BODIES {
            let map_error =
                |error: serde_json::Error| RetargetError::Map(format!("{name}: {error}"));
            let BodyFile { parts, .. } = serde_json::from_str(text).map_err(map_error)?;
            let mut frames = parts.values().map(DriveText::frame);
            if frames.all(|frame| model.frame(frame).is_ok()) {
                return Ok(Some(Self { name, parts }));
            }
        }
        Ok(None)
    }
}
