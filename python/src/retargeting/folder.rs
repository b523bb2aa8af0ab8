//! Folders of motion capture files.

use std::ffi::OsString;
use std::path::PathBuf;

use kinopt_bindings::Classify;
use kinopt_bindings::retarget_folder::{FolderError, FolderSettings, MotionFolder};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use super::request::{foot_shapes_of, margin, read_map, retarget_options, target_of, world};
use super::up_axis::up_axis;
use crate::error::{OrRaise, raise};
use crate::object::Options;

/// Options of reading files and of solving trajectories as a whole.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(super) struct ReadOptions {
    joints: Option<Vec<String>>,
    fps: Option<f64>,
    up: Option<String>,
    clip: Option<String>,
    whole: bool,
}

/// Input file, output file, and true if it was done before.
type BegunFile = (OsString, OsString, bool);

/// Starts or continues a folder of `.npz` outputs for the capture files of another folder.
#[pyfunction]
pub(super) fn folder_begun(
    folders: (PathBuf, PathBuf),
    target: &Bound<'_, PyAny>,
    map: Option<&str>,
    skeleton: Option<&str>,
    reading: ReadOptions,
    options: &Bound<'_, PyDict>,
    overwrite: bool,
) -> PyResult<Vec<BegunFile>> {
    let robot = target_of(target)?;
    let up = reading.up.as_deref().map(up_axis).transpose()?;
    let options = Options(options);
    let mut retarget_options = retarget_options(&options, up.unwrap_or_default())?;
    retarget_options.shapes = foot_shapes_of(target);
    let map = map.map(|map| read_map(map, &robot)).transpose()?;
    let world = world(&options)?;
    let request = FolderSettings::new(&robot, retarget_options)
        .with_map(map.as_ref())
        .with_skeleton(skeleton)
        .with_joints(reading.joints.as_deref())
        .with_frame_rate(reading.fps)
        .with_up(up)
        .with_clip(reading.clip.as_deref())
        .with_whole(reading.whole)
        .with_keep_clear(margin(&options)?)
        .with_world(world.map(|world| world.to_json()));
    let (source, into) = folders;
    let movements = MotionFolder::find(&source, &into, "npz").or_raise()?;
    let begun = movements.begin(&request, overwrite).map_err(|error| {
        let hint = match &error {
            FolderError::OtherQuestion { .. } => ": give another folder, or overwrite=True",
            _ => "",
        };
        raise(error.kind(), format!("{error}{hint}"))
    })?;
    let begun_rows = begun.into_iter().map(|movement| {
        (
            movement.source.into(),
            movement.out.into(),
            movement.done_before,
        )
    });
    Ok(begun_rows.collect())
}

/// Temporary path of an output file during writing.
#[pyfunction]
pub(super) fn unfinished(out: PathBuf) -> PathBuf {
    kinopt_bindings::retarget_folder::unfinished(&out)
}
