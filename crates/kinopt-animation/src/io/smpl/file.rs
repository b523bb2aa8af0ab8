//! Reader of .npz files of AMASS and of body models.

use std::path::Path;

use super::{BodyModel, RestJoints, SmplArrays, SmplError, SmplMotion};
use crate::io::numpy::{NumpyArchive, NumpyArray};
use crate::io::{FileLocation, ReadError, ReadProblem};

/// Names of the frame rate.
const FRAME_RATES: [&str; 4] = ["mocap_frame_rate", "mocap_framerate", "fps", "frame_rate"];
/// Frames per second of a file without a frame rate.
const DEFAULT_FRAME_RATE: f64 = 30.0;
/// Rotations of the parts of a body, of which some files have one array each: SMPL-X in the order of its joints.
const PARTS: [&str; 5] = [
    "root_orient",
    "pose_body",
    "pose_jaw",
    "pose_eye",
    "pose_hand",
];

/// Returns true if an archive is a motion of the SMPL family: it has `poses`, or `root_orient` and `pose_body`.
pub(crate) fn is_motion(archive: &NumpyArchive) -> bool {
    let has = |name: &str| archive.names().any(|known| known == name);
    has("trans") && (has("poses") || (has("root_orient") && has("pose_body")))
}

impl SmplMotion {
    /// Returns true if an archive is a motion of the SMPL family.
    #[must_use]
    pub fn is_in(archive: &NumpyArchive) -> bool {
        is_motion(archive)
    }

    /// Creates the motion of an archive. `name` names the clip, and the file in messages.
    ///
    /// # Errors
    /// Returns an error that lists the arrays of the file if one is missing, and the errors of [`new`](Self::new).
    pub fn of_archive(
        archive: &NumpyArchive,
        name: &str,
        rest_joints: &RestJoints,
    ) -> Result<Self, ReadError> {
        let arrays = arrays_of(archive)?;
        let clip = Path::new(name).file_stem().unwrap_or_default();
        let motion = Self::new(&clip.to_string_lossy(), &arrays, rest_joints);
        motion.map_err(|error| invalid(name, error))
    }
}

/// Reads a motion from a .npz file with the arrays of AMASS: `poses`, `trans`, `mocap_frame_rate`, and optionally
/// `betas` and `jtr`.
///
/// # Errors
/// Returns an error if the file cannot be read, and the errors of [`SmplMotion::of_archive`].
pub fn read(path: impl AsRef<Path>, rest_joints: &RestJoints) -> Result<SmplMotion, ReadError> {
    let path = path.as_ref();
    let archive = NumpyArchive::read(path)?;
    SmplMotion::of_archive(&archive, &path.display().to_string(), rest_joints)
}

/// Reads a body model from a .npz file with `J_regressor`, `v_template` and `shapedirs`.
///
/// # Errors
/// Returns an error if the file cannot be read, and an error that lists its arrays if one is missing.
pub fn read_body_model(path: impl AsRef<Path>) -> Result<BodyModel, ReadError> {
    let path = path.as_ref();
    let archive = NumpyArchive::read(path)?;
    let numbers = |name: &str| archive.array(name).map(|array| array.numbers.as_slice());
    let model = BodyModel::new(
        numbers("J_regressor")?,
        numbers("v_template")?,
        numbers("shapedirs")?,
    );
    model.map_err(|error| invalid(&path.display().to_string(), error))
}

fn invalid(file: &str, error: SmplError) -> ReadError {
    ReadError::new(file, FileLocation::File, ReadProblem::invalid(error))
}

fn arrays_of(archive: &NumpyArchive) -> Result<SmplArrays, ReadError> {
    let translations = archive.array("trans")?.numbers.clone();
    let poses = match archive.get("poses")? {
        Some(poses) => poses.numbers.clone(),
        None => stacked_parts(archive, translations.len() / 3)?,
    };
    let frame_rate = archive.first_of(&FRAME_RATES)?;
    let frame_rate = frame_rate.and_then(|array| array.numbers.first().copied());
    let betas = archive.get("betas")?;
    let joints = archive.get("jtr")?;
    let numbers = |array: Option<&NumpyArray>| array.map(|array| array.numbers.clone());
    Ok(SmplArrays {
        poses,
        translations,
        betas: numbers(betas).unwrap_or_default(),
        frame_rate: frame_rate.unwrap_or(DEFAULT_FRAME_RATE),
        joints: numbers(joints),
    })
}

/// Rotations of all parts, frame by frame.
fn stacked_parts(archive: &NumpyArchive, frames: usize) -> Result<Vec<f64>, ReadError> {
    archive
        .array("poses")
        .or_else(|missing| match is_motion(archive) {
            true => archive.array("root_orient"),
            false => Err(missing),
        })?;
    let mut parts = Vec::new();
    for name in PARTS {
        if let Some(part) = archive.get(name)? {
            parts.push(&part.numbers);
        }
    }
    let mut poses = Vec::new();
    for frame in 0..frames {
        for part in &parts {
            let width = part.len() / frames;
            poses.extend_from_slice(&part[frame * width..(frame + 1) * width]);
        }
    }
    Ok(poses)
}
