//! BVH writer.

use std::path::PathBuf;

use kinopt::io::bvh::{self, BvhChannel, BvhFormat};
use kinopt::model::UnknownName;
use pyo3::prelude::*;

use crate::animation::{Armature, Clip, poses_of};
use crate::error::OrRaise;

/// Channels of each bone by name.
type Names = Vec<Vec<String>>;

/// Channels of each bone, of their names.
pub(crate) fn channels_of(names: &Names) -> PyResult<Vec<Vec<BvhChannel>>> {
    let named = |name: &String| {
        let channel = BvhChannel::ALL
            .into_iter()
            .find(|channel| channel.name() == name);
        let names = BvhChannel::ALL.map(BvhChannel::name);
        channel
            .ok_or_else(|| UnknownName::new("channel", name, names))
            .or_raise()
    };
    let channels = names
        .iter()
        .map(|bone_channels| bone_channels.iter().map(named).collect());
    channels.collect()
}

/// A frame rate with the channels that are given, if any.
fn format_of(rate: f64, channels: Option<&[Vec<BvhChannel>]>) -> BvhFormat<'_> {
    let format = BvhFormat::from(rate);
    match channels {
        Some(channels) => format.with_channels(channels),
        None => format,
    }
}

/// A clip as BVH text, with `rate` frames a second from its start to its end. The rest after the last whole frame is
/// not written. `channels` names the channels of each bone in their order, as `MotionCapture.channels` does. By default
/// rotations are about z, x and y. `MotionCapture.to_text` writes a capture with its own channels.
///
/// Raises `InvalidValueError`: no bones, a name that the format cannot represent, a scaled bone, a clip of another
/// armature's size, a rate that is not positive, a channel twice.
#[pyfunction]
#[pyo3(signature = (armature, clip, rate, channels = None))]
pub(crate) fn bvh_to_text(
    armature: &Bound<'_, Armature>,
    clip: &Bound<'_, Clip>,
    rate: f64,
    channels: Option<Names>,
) -> PyResult<String> {
    let (bones, clip) = (&armature.get().inner, &clip.get().inner);
    let channels = channels.as_ref().map(channels_of).transpose()?;
    let format = format_of(rate, channels.as_deref());
    armature
        .py()
        .detach(|| bvh::to_text(bones, clip, format))
        .or_raise()
}

/// Poses (`Poses` or a list of `Pose`) as BVH text, `rate` of them a second, for example the results of blending,
/// layers or inverse kinematics. `channels` are as in `bvh_to_text`.
///
/// Raises `InvalidValueError` as `bvh_to_text` does.
#[pyfunction]
#[pyo3(signature = (armature, poses, rate, channels = None))]
pub(crate) fn bvh_poses_to_text(
    armature: &Bound<'_, Armature>,
    poses: &Bound<'_, PyAny>,
    rate: f64,
    channels: Option<Names>,
) -> PyResult<String> {
    let (bones, (poses, _)) = (&armature.get().inner, poses_of(poses)?);
    let channels = channels.as_ref().map(channels_of).transpose()?;
    let format = format_of(rate, channels.as_deref());
    armature
        .py()
        .detach(|| bvh::poses_to_text(bones, &poses, format))
        .or_raise()
}

/// Writes a clip to the BVH file `path`. The armature is its hierarchy, in the armature's unit. It has `rate` frames a
/// second of translations and Euler angles (degrees, as the format requires) from the clip's start to its end.
/// `MotionCapture.read` reads it back; the rest after the last whole frame is not written. `channels` are as in
/// `bvh_to_text`.
///
/// Raises `FileError`, and `InvalidValueError` as `bvh_to_text` does.
#[pyfunction]
#[pyo3(signature = (armature, clip, rate, path, channels = None))]
pub(crate) fn bvh_write(
    armature: &Bound<'_, Armature>,
    clip: &Bound<'_, Clip>,
    rate: f64,
    path: PathBuf,
    channels: Option<Names>,
) -> PyResult<()> {
    let (bones, clip) = (&armature.get().inner, &clip.get().inner);
    let channels = channels.as_ref().map(channels_of).transpose()?;
    let format = format_of(rate, channels.as_deref());
    armature
        .py()
        .detach(|| bvh::write(bones, clip, format, &path))
        .or_raise()
}

/// Writes poses (`Poses` or a list of `Pose`) to the BVH file `path`, `rate` of them a second. Poses may be results of
/// blending, layers or inverse kinematics. The file is as from `bvh_write`.
///
/// Raises `FileError`, and `InvalidValueError` as `bvh_to_text` does.
#[pyfunction]
#[pyo3(signature = (armature, poses, rate, path, channels = None))]
pub(crate) fn bvh_write_poses(
    armature: &Bound<'_, Armature>,
    poses: &Bound<'_, PyAny>,
    rate: f64,
    path: PathBuf,
    channels: Option<Names>,
) -> PyResult<()> {
    let (bones, (poses, _)) = (&armature.get().inner, poses_of(poses)?);
    let channels = channels.as_ref().map(channels_of).transpose()?;
    let format = format_of(rate, channels.as_deref());
    armature
        .py()
        .detach(|| bvh::write_poses(bones, &poses, format, &path))
        .or_raise()
}
