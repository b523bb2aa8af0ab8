//! Reader of C3D files.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use c3dio::C3d;
use glam::DVec3;

use super::{MarkerCapture, MarkerError};
use crate::io::{FileLocation, MAX_FILE_BYTES, ReadError, ReadProblem, read_with};

/// Units of length by name, metres.
const UNITS: [(&str, f64); 5] = [
    ("m", 1.0),
    ("dm", 0.1),
    ("cm", 0.01),
    ("mm", 0.001),
    ("in", 0.0254),
];

/// Reads the markers of a C3D file of at most 1 GiB.
///
/// # Errors
/// As [`from_bytes`], or the file cannot be opened.
pub fn read(path: impl AsRef<Path>) -> Result<MarkerCapture, ReadError> {
    read_with(path.as_ref(), MAX_FILE_BYTES, from_bytes)
}

/// Reads markers from the bytes of a C3D file; `name` is used for messages.
///
/// # Errors
/// Returns an error for a damaged file, for a file without markers, and for an unknown unit of length.
pub fn from_bytes(bytes: &[u8], name: &str) -> Result<MarkerCapture, ReadError> {
    // c3dio panics on some damaged files.
    let parsed = catch_unwind(AssertUnwindSafe(|| {
        C3d::from_bytes(bytes).map_err(|error| error.to_string())
    }));
    let damaged =
        |reason: String| ReadError::of_file(name, format!("not a C3D file, or damaged: {reason}"));
    let file = match parsed {
        Ok(Ok(file)) => file,
        Ok(Err(reason)) => return Err(damaged(reason)),
        Err(_) => return Err(damaged("its sections do not fit".to_owned())),
    };
    markers(&file)
        .map_err(|error| ReadError::new(name, FileLocation::File, ReadProblem::invalid(error)))
}

fn markers(file: &C3d) -> Result<MarkerCapture, MarkerError> {
    let points = &file.points;
    let unit: String = points.units.iter().collect();
    let unit = unit.trim_matches(|letter: char| letter.is_whitespace() || letter == '\0');
    let known = UNITS
        .iter()
        .find(|(name, _)| unit.eq_ignore_ascii_case(name));
    let (_, metres) = known.ok_or_else(|| MarkerError::UnknownUnit(unit.to_owned()))?;
    let (frames, columns) = (points.points.rows(), points.points.cols());
    let stated = usize::from(points.last_frame.saturating_sub(points.first_frame)) + 1;
    if frames < stated {
        return Err(MarkerError::Truncated {
            read: frames,
            stated,
        });
    }
    let markers = columns.min(points.labels.len());
    let mut positions = Vec::with_capacity(frames * markers);
    for frame in 0..frames {
        for marker in 0..markers {
            let point = points.points.get(frame, marker);
            let seen = point.filter(|point| point.residual >= 0.0);
            let position = seen.map(|point| DVec3::from(point.point.map(f64::from)) * *metres);
            positions.push(position.filter(|position| position.is_finite()));
        }
    }
    let labels = points.labels.get(..markers).unwrap_or_default();
    MarkerCapture::new(labels, positions, f64::from(points.frame_rate))
}
