//! Swing and twist limits (cones) of a skeleton's bones, in JSON: an addition to files without limits.
//!
//! The file is an object keyed by bone name, with angles in degrees:
//!
//! ```json
//! {
//!   "LeftArm":     {"swing": 90, "twist": [-60, 60]},
//!   "LeftForeArm": {"axis": [0, 1, 0], "swing": 2, "twist": [-150, 0]},
//!   "Neck":        {"swing": [45, 25], "about": [1, 0, 0], "twist": [-70, 70]}
//! }
//! ```
//!
//! - `swing`: largest angle between the bone's axis and its direction at rest, above 0 and at most 180; 180 by default.
//!   With two numbers the first limits the rotation about `about`, the second the rotation across it.
//! - `twist`: range of the rotation about the bone's axis, within -180 and 180; unlimited by default.
//! - `angle`: largest total rotation angle about any axis, above 0 and at most 180; by default only swing and twist
//!   limit it.
//! - `axis`: twist axis in the bone's frame; along the bone by default. The second line of the example is a hinge.
//! - `about`: first axis of a swing of two numbers, in the bone's frame.
//!
//! A bone that is not listed has no limits. Unknown keys and repeated bones are errors.

use std::fmt;
use std::path::Path;

use serde::Deserialize;
use serde::de::{Deserializer, Error, MapAccess, Visitor};

use super::{FileLocation, ReadError, read_with};
use kinopt_kinematics::model::{BallLimits, Limits};
use kinopt_kinematics::skeleton::{BoneCone, Cones};
use kinopt_kinematics::spatial::Vector3;

/// Largest file size that is read, bytes.
const MAX_FILE_SIZE: u64 = 1 << 24;

/// The angle π, in degrees.
const HALF_TURN: f64 = 180.0;

/// Reads a file of joint limits.
///
/// # Errors
/// A [`ReadError`] that names the file and a path in it such as `LeftArm.swing`. Causes are invalid JSON, an unknown
/// key, an angle out of range, or a swing of two numbers without `about`.
/// [`BallSkeleton::new`](kinopt_kinematics::skeleton::BallSkeleton::new) checks that the skeleton has the bones.
pub fn read(path: impl AsRef<Path>) -> Result<Cones, ReadError> {
    read_with(path.as_ref(), MAX_FILE_SIZE, from_bytes)
}

/// Reads joint limits from the bytes of a file. `name` is the file name for messages.
///
/// ```
/// let cones = kinopt::io::cones::from_bytes(br#"{"Neck": {"swing": 40, "twist": [-70, 70]}}"#, "man.json")?;
/// assert_eq!(cones["Neck"].limits.swing, [40f64.to_radians(); 2]);
/// # Ok::<(), kinopt::io::ReadError>(())
/// ```
///
/// # Errors
/// As [`read`].
pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Cones, ReadError> {
    let Entries(entries) = kinopt_mesh::json::parse(bytes, name)?;
    let mut cones = Cones::new();
    for (bone, entry) in entries {
        let malformed = |(key, problem): (&str, String)| {
            let path = if key.is_empty() {
                bone.clone()
            } else {
                format!("{bone}.{key}")
            };
            ReadError::malformed(name, FileLocation::Json(path), problem)
        };
        let cone = entry.cone().map_err(malformed)?;
        if cones.insert(bone.clone(), cone).is_some() {
            return Err(malformed(("", "the bone is named twice".to_owned())));
        }
    }
    Ok(cones)
}

/// Entry of one bone.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    swing: Option<SwingLimit>,
    twist: Option<[f64; 2]>,
    angle: Option<f64>,
    axis: Option<[f64; 3]>,
    about: Option<[f64; 3]>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(untagged, expecting = "expected degrees, or two of them in an array")]
enum SwingLimit {
    Round(f64),
    Elliptic([f64; 2]),
}

/// All entries of a file, in their order.
#[derive(Debug)]
struct Entries(Vec<(String, Entry)>);

impl Entry {
    /// The limits of the entry, or the faulty key and its problem.
    fn cone(&self) -> Result<BoneCone, (&'static str, String)> {
        let swing = match self.swing {
            None => [HALF_TURN; 2],
            Some(SwingLimit::Round(swing)) => [swing; 2],
            Some(SwingLimit::Elliptic(swing)) => swing,
        };
        let angles = swing.map(|swing| ("swing", swing)).into_iter();
        for (key, angle) in angles.chain(self.angle.map(|angle| ("angle", angle))) {
            if !(angle > 0.0 && angle <= HALF_TURN) {
                let problem = format!("{angle} degrees are not above 0 and at most 180");
                return Err((key, problem));
            }
        }
        let twist = self.twist.map_or(Limits::UNBOUNDED, |[lower, upper]| {
            Limits::new(lower.to_radians(), upper.to_radians())
        });
        if let Some([lower, upper]) = self.twist {
            if !(-HALF_TURN <= lower && lower <= upper && upper <= HALF_TURN) {
                let problem =
                    format!("[{lower}, {upper}] degrees is not a range within [-180, 180]");
                return Err(("twist", problem));
            }
        }
        let elliptic = matches!(self.swing, Some(SwingLimit::Elliptic(_)));
        if elliptic != self.about.is_some() {
            let problem = match elliptic {
                true => "of two numbers needs `about`, the axis of the first",
                false => "is for a swing of two numbers",
            };
            let key = if elliptic { "swing" } else { "about" };
            return Err((key, problem.to_owned()));
        }
        if self.swing.is_none() && self.twist.is_none() && self.angle.is_none() {
            let problem = "none of `swing`, `twist` and `angle` is given";
            return Err(("", problem.to_owned()));
        }
        for (key, axis) in [("axis", self.axis), ("about", self.about)] {
            let length = axis.map(|axis| Vector3::from(axis).norm());
            if length.is_some_and(|length| !(length > 0.0 && length.is_finite())) {
                return Err((key, "has no direction".to_owned()));
            }
        }
        let mut limits = BallLimits::cone(0.0, twist);
        limits.swing = swing.map(f64::to_radians);
        limits.about = self.about.map(Vector3::from);
        limits.angle = self.angle.map(f64::to_radians);
        let axis = self.axis.map(Vector3::from);
        Ok(BoneCone { axis, limits })
    }
}

impl<'de> Deserialize<'de> for Entries {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct ByBone;

        impl<'de> Visitor<'de> for ByBone {
            type Value = Entries;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object with a cone for each bone's name")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Entries, A::Error> {
                let mut entries: Vec<(String, Entry)> = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    entries.push(entry);
                }
                // A skeleton without limits needs no file.
                match entries.is_empty() {
                    true => Err(A::Error::custom("no bone has a cone in it")),
                    false => Ok(Entries(entries)),
                }
            }
        }
        deserializer.deserialize_map(ByBone)
    }
}
