//! Motion capture: BVH files.

use std::path::PathBuf;
use std::sync::Arc;

use kinopt::io::bvh::{self, BvhChannel, BvhNote};
use kinopt::model::UnknownName;
use pyo3::prelude::*;
use pyo3::types::PyType;

use crate::animation::{Armature, Clip};
use crate::contents::text_or_bytes;
use crate::error::{OrRaise, invalid};
use crate::pickling;

/// Content of a BVH file: a skeleton and its motion by capture frame, in the file's unit of length.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct MotionCapture {
    pub(crate) inner: bvh::MotionCapture,
    armature: Arc<kinopt::animation::Armature>,
    clip: Arc<kinopt::animation::Clip>,
}

impl From<bvh::MotionCapture> for MotionCapture {
    fn from(inner: bvh::MotionCapture) -> Self {
        Self {
            armature: Arc::new(inner.armature.clone()),
            clip: Arc::new(inner.clip.clone()),
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

    /// Parts of the file that the reader ignored, one text each.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.inner.notes.iter().map(ToString::to_string).collect()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let surplus = self.inner.notes.iter().filter_map(|note| match note {
            BvhNote::SurplusFrames {
                line,
                announced,
                surplus,
            } => Some((*line, *announced, *surplus)),
            _ => None,
        });
        let surplus: Vec<(usize, usize, usize)> = surplus.collect();
        let parts = (
            self.armature(),
            self.clip(),
            self.inner.frames,
            self.inner.frame_time,
            self.channels(),
            surplus,
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
        surplus: Vec<(usize, usize, usize)>,
    ) -> PyResult<Self> {
        let named = |name: &String| {
            let found = BvhChannel::ALL.into_iter().find(|own| own.name() == name);
            let names = BvhChannel::ALL.map(BvhChannel::name);
            found
                .ok_or_else(|| UnknownName::new("channel", name, names))
                .or_raise()
        };
        let channels = channels.iter().map(|own| own.iter().map(named).collect());
        let armature = &armature.get().inner;
        let channels = channels.collect::<PyResult<Vec<Vec<_>>>>()?;
        if channels.len() != armature.bones() {
            return Err(invalid("there are not channels for each bone"));
        }
        let note = |(line, announced, surplus)| BvhNote::SurplusFrames {
            line,
            announced,
            surplus,
        };
        let capture = bvh::MotionCapture {
            armature: kinopt::animation::Armature::clone(armature),
            clip: kinopt::animation::Clip::clone(&clip.get().inner),
            frames,
            frame_time,
            channels,
            notes: surplus.into_iter().map(note).collect(),
        };
        Ok(capture.into())
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
