//! Motion capture: BVH files.

use std::path::PathBuf;
use std::sync::Arc;

use kinopt::io::bvh::{self, BvhChannel};
use kinopt::io::smpl::{self, RestJoints};
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::animation::{Armature, Clip};
use crate::contents::text_or_bytes;
use crate::error::{OrRaise, invalid};
use crate::io::channels_of;
use crate::pickling;

/// Content of a BVH file: a skeleton and its motion by capture frame, in the file's unit of length.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct MotionCapture {
    pub(crate) inner: bvh::MotionCapture,
    armature: Arc<kinopt::animation::Armature>,
    clip: Arc<kinopt::animation::Clip>,
    /// Repairs made by the reader, one text each: truncated or surplus frames, renamed joints, bytes that are not
    /// UTF-8.
    #[pyo3(get)]
    notes: Vec<String>,
}

impl From<bvh::MotionCapture> for MotionCapture {
    fn from(inner: bvh::MotionCapture) -> Self {
        Self {
            armature: Arc::new(inner.armature.clone()),
            clip: Arc::new(inner.clip.clone()),
            notes: inner.notes.iter().map(ToString::to_string).collect(),
            inner,
        }
    }
}

#[pymethods]
impl MotionCapture {
    /// Reads a BVH file.
    ///
    /// Raises `FileError` if it cannot be opened, `InvalidFileError` with the line if it is malformed.
    #[classmethod]
    fn read(class: &Bound<'_, PyType>, path: PathBuf) -> PyResult<Self> {
        let capture = class.py().detach(|| bvh::read(&path));
        capture.or_raise().map(Self::from)
    }

    /// Reads motion capture from the text or the bytes of a BVH file. `name` is used in messages and names the clip.
    ///
    /// Raises `InvalidFileError` with the line.
    #[classmethod]
    #[pyo3(signature = (data, name = "capture.bvh"))]
    fn from_bytes(
        class: &Bound<'_, PyType>,
        data: &Bound<'_, PyAny>,
        name: &str,
    ) -> PyResult<Self> {
        let data = text_or_bytes(data, "data")?;
        let capture = class.py().detach(|| bvh::from_bytes(&data, name));
        capture.or_raise().map(Self::from)
    }

    /// Reads a motion of SMPL, SMPL-H or SMPL-X from a .npz file with the arrays of AMASS: `poses`, `trans`,
    /// `mocap_frame_rate`, and optionally `betas` and `jtr`. Bones have the names of SMPL's joints, lengths are metres.
    ///
    /// Rest joints are those of `jtr`. A file without them takes those of `body_model` for its `betas`: the path of a .npz
    /// file with `J_regressor`, `v_template` and `shapedirs`. Else they are those of a default skeleton of `height` metres
    /// (None: 1.7), with a note.
    ///
    /// Raises `FileError` and `InvalidFileError`, and `InvalidValueError` for both `body_model` and `height`.
    #[classmethod]
    #[pyo3(signature = (path, *, body_model = None, height = None))]
    fn read_smpl(
        class: &Bound<'_, PyType>,
        path: PathBuf,
        body_model: Option<PathBuf>,
        height: Option<f64>,
    ) -> PyResult<Self> {
        if body_model.is_some() && height.is_some() {
            return Err(invalid(
                "body_model and height both determine the rest joints: give one of them",
            ));
        }
        let motion = class.py().detach(|| {
            let rest_joints = match (body_model, height) {
                (Some(path), None) => RestJoints::BodyModel(smpl::read_body_model(path)?),
                (None, Some(height)) => RestJoints::Height(height),
                _ => RestJoints::Default,
            };
            smpl::read(&path, &rest_joints)
        });
        let motion = motion.or_raise()?;
        let notes = motion.notes.iter().map(ToString::to_string).collect();
        Ok(Self {
            notes,
            ..bvh::MotionCapture::from(motion).into()
        })
    }

    /// One bone for each joint and End Site, in the order of the file.
    #[getter]
    fn armature(&self) -> Armature {
        Arc::clone(&self.armature).into()
    }

    /// The motion, in seconds from the first frame.
    #[getter]
    fn clip(&self) -> Clip {
        Clip::of(&self.armature, Arc::clone(&self.clip))
    }

    /// Number of capture frames.
    #[getter]
    fn frames(&self) -> usize {
        self.inner.frames
    }

    /// Time from one capture frame to the next, in seconds.
    #[getter]
    fn frame_time(&self) -> f64 {
        self.inner.frame_time
    }

    /// The channels of each bone in the order of the file: "Xposition", "Zrotation", ...; none for End Sites.
    #[getter]
    fn channels(&self) -> Vec<Vec<&'static str>> {
        let names = |channels: &Vec<BvhChannel>| channels.iter().map(|c| c.name()).collect();
        self.inner.channels.iter().map(names).collect()
    }

    /// The capture as BVH text, with its own channels, frames and frame time.
    ///
    /// Raises `InvalidValueError` for a name that the format cannot hold.
    fn to_text(&self, py: Python<'_>) -> PyResult<String> {
        py.detach(|| self.inner.to_text()).or_raise()
    }

    /// Writes the capture to the BVH file `path`, as `to_text` has it.
    ///
    /// Raises `FileError`, and `InvalidValueError` as `to_text` does.
    fn write(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        py.detach(|| self.inner.write(&path)).or_raise()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (
            self.armature(),
            self.clip(),
            self.inner.frames,
            self.inner.frame_time,
            self.channels(),
            self.notes.clone(),
        );
        pickling::by_rebuild::<Self>(py, parts)
    }

    #[staticmethod]
    fn _rebuild(
        armature: &Bound<'_, Armature>,
        clip: &Bound<'_, Clip>,
        frames: usize,
        frame_time: f64,
        channels: Vec<Vec<String>>,
        notes: Vec<String>,
    ) -> PyResult<Self> {
        let armature = &armature.get().inner;
        let channels = channels_of(&channels)?;
        if channels.len() != armature.bones() {
            return Err(invalid("channels must have one entry for each bone"));
        }
        let capture = bvh::MotionCapture {
            armature: kinopt::animation::Armature::clone(armature),
            clip: kinopt::animation::Clip::clone(&clip.get().inner),
            frames,
            frame_time,
            channels,
            notes: Vec::new(),
        };
        Ok(Self {
            notes,
            ..capture.into()
        })
    }

    fn __repr__(&self) -> String {
        format!(
            "MotionCapture({:?}, {} bones, {} frames of {} s)",
            self.clip.name(),
            self.armature.bones(),
            self.inner.frames,
            self.inner.frame_time
        )
    }
}
