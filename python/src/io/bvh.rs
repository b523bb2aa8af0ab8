//! BVH writer.

use std::path::PathBuf;

use kinopt::io::bvh;
use pyo3::prelude::*;

use crate::animation::{Armature, Clip, poses_of};
use crate::error::OrRaise;

/// A clip as BVH text, at `rate` frames a second from its start to its end; a remainder after the last whole frame is
/// omitted.
///
/// Raises `InvalidValueError`: no bones, a name that the format cannot represent, a scaled bone, a clip of another
/// armature's size, a rate that is not positive.
#[pyfunction]
pub(crate) fn bvh_to_text(
    armature: &Bound<'_, Armature>,
    clip: &Bound<'_, Clip>,
    rate: f64,
) -> PyResult<String> {
    let (bones, own) = (&armature.get().inner, &clip.get().inner);
    armature
        .py()
        .detach(|| bvh::to_text(bones, own, rate))
        .or_raise()
}

/// Poses (`Poses` or a list of `Pose`) as BVH text, at `rate` frames a second: for example the results of blending,
/// layers or inverse kinematics.
///
/// Raises `InvalidValueError` as `bvh_to_text` does.
#[pyfunction]
pub(crate) fn bvh_poses_to_text(
    armature: &Bound<'_, Armature>,
    poses: &Bound<'_, PyAny>,
    rate: f64,
) -> PyResult<String> {
    let (bones, (poses, _)) = (&armature.get().inner, poses_of(poses)?);
    armature
        .py()
        .detach(|| bvh::poses_to_text(bones, &poses, rate))
        .or_raise()
}

/// Writes a clip to the BVH file `path`: the armature as its hierarchy, in its unit, and `rate` frames a second of
/// translations and Euler angles (degrees in the file) from the clip's start to its end. `MotionCapture.read` reads it
/// back; a remainder after the last whole frame is omitted.
///
/// Raises `FileError`, and `InvalidValueError` as `bvh_to_text` does.
#[pyfunction]
pub(crate) fn bvh_write(
    armature: &Bound<'_, Armature>,
    clip: &Bound<'_, Clip>,
    rate: f64,
    path: PathBuf,
) -> PyResult<()> {
    let (bones, own) = (&armature.get().inner, &clip.get().inner);
    armature
        .py()
        .detach(|| bvh::write(bones, own, rate, &path))
        .or_raise()
}

/// Writes poses (`Poses` or a list of `Pose`) to the BVH file `path`, at `rate` frames a second: for example the
/// results of blending, layers or inverse kinematics. The format is that of `bvh_write`.
///
/// Raises `FileError`, and `InvalidValueError` as `bvh_to_text` does.
#[pyfunction]
pub(crate) fn bvh_write_poses(
    armature: &Bound<'_, Armature>,
    poses: &Bound<'_, PyAny>,
    rate: f64,
    path: PathBuf,
) -> PyResult<()> {
    let (bones, (poses, _)) = (&armature.get().inner, poses_of(poses)?);
    armature
        .py()
        .detach(|| bvh::write_poses(bones, &poses, rate, &path))
        .or_raise()
}
