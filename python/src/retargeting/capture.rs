//! Motion capture by joint positions.

use std::path::PathBuf;
use std::sync::Arc;

use kinopt::io::c3d;
use kinopt::motion::retarget::{self, UpAxis};
use numpy::ndarray::Ix3;
use numpy::{PyArray1, PyArray3, PyArrayMethods};
use pyo3::prelude::*;

use super::up_axis::up_axis;
use crate::animation::Clip;
use crate::arrays::{self, Numbers};
use crate::error::{OrRaise, invalid};
use crate::pickling;

/// Positions of a subject's named joints in capture frames at a fixed rate, in any unit of length.
///
/// `positions` of shape (T, J, 3) are those of `joints`, in order, at `fps` frames a second. `up` is the upward axis,
/// "y" or "z". None selects the axis from the ankles to the pelvis of an upright subject, else z. `bones` are pairs of
/// joint indices, if known, for drawing.
///
/// Raises `InvalidValueError` for another shape, a duplicate name, and numbers that are not finite, with the frame and
/// joint.
#[pyclass(frozen, module = "kinopt.retargeting")]
pub(crate) struct Capture {
    pub(super) inner: Arc<retarget::Capture>,
    pub(super) up: UpAxis,
    /// True if `up` was detected, and is not the usual axis of such captures.
    pub(super) is_detected: bool,
    bones: Option<Vec<(usize, usize)>>,
}

impl Capture {
    /// `usual` is the axis of captures that do not show it.
    fn of(
        inner: retarget::Capture,
        up: Option<UpAxis>,
        usual: UpAxis,
        bones: Option<Vec<(usize, usize)>>,
    ) -> Self {
        let up_axis = up.or_else(|| inner.up_axis()).unwrap_or(usual);
        Self {
            inner: Arc::new(inner),
            up: up_axis,
            is_detected: up.is_none() && up_axis != usual,
            bones,
        }
    }
}

#[pymethods]
impl Capture {
    #[new]
    #[pyo3(signature = (positions, joints, fps, up = None, bones = None))]
    fn new(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        joints: Vec<String>,
        fps: f64,
        up: Option<&str>,
        bones: Option<Vec<(usize, usize)>>,
    ) -> PyResult<Self> {
        let up = up.map(up_axis).transpose()?;
        let beyond = |&&(from, to): &&(usize, usize)| from.max(to) >= joints.len();
        if let Some((from, to)) = bones.iter().flatten().find(beyond) {
            return Err(invalid(format!(
                "bones has ({from}, {to}), where there are {} joints",
                joints.len()
            )));
        }
        let numbers: Numbers<'_, Ix3> =
            arrays::numbers(positions, "positions", "(frames, joints, 3)")?;
        let shape = numbers.shape();
        if shape[1..] != [joints.len(), 3] {
            return Err(invalid(format!(
                "positions has shape {}, expected (frames, {}, 3)",
                arrays::shape_text(shape),
                joints.len()
            )));
        }
        let numbers = &*numbers;
        let capture = py.detach(|| retarget::Capture::new(joints, numbers, fps));
        Ok(Self::of(capture.or_raise()?, up, UpAxis::Z, bones))
    }

    /// Positions of a clip's bones, at `fps` frames a second from its start to its end. `up` is as in `Capture`; it is
    /// y if the body is upright along no axis.
    ///
    /// Raises `InvalidValueError` for a rate that is not positive, and for a clip of a file without frames.
    #[staticmethod]
    #[pyo3(signature = (clip, fps, up = None))]
    fn of_clip(
        py: Python<'_>,
        clip: &Bound<'_, Clip>,
        fps: f64,
        up: Option<&str>,
    ) -> PyResult<Self> {
        let up = up.map(up_axis).transpose()?;
        let clip = clip.get();
        let (bones, motion) = (&clip.armature, &clip.inner);
        let capture = py.detach(|| retarget::Capture::of_clip(bones, motion, fps));
        let ids = bones.bone_ids();
        let pairs = ids.filter_map(|bone| Some((bones.parent(bone)?.index(), bone.index())));
        let pairs = Some(pairs.collect());
        Ok(Self::of(capture.or_raise()?, up, UpAxis::Y, pairs))
    }

    /// Joint centres of the markers of the C3D file `path`: those of Plug-in Gait, or of the CMU data base. The joints
    /// have the names of SMPL, positions are metres. `up` is as in `Capture`.
    ///
    /// Raises `FileError`, `InvalidFileError`, and `InvalidValueError` with the missing markers.
    #[staticmethod]
    #[pyo3(signature = (path, up = None))]
    fn of_c3d(py: Python<'_>, path: PathBuf, up: Option<&str>) -> PyResult<Self> {
        let up = up.map(up_axis).transpose()?;
        let markers = py.detach(|| c3d::read(&path)).or_raise()?;
        let capture = py.detach(|| retarget::Capture::of_markers(&markers));
        Ok(Self::of(capture.or_raise()?, up, UpAxis::Z, None))
    }

    /// Names of the joints.
    #[getter]
    fn joints(&self) -> Vec<String> {
        self.inner.names().to_vec()
    }

    /// Frame rate, in frames a second.
    #[getter]
    fn fps(&self) -> f64 {
        self.inner.frame_rate()
    }

    /// Upward axis.
    #[getter]
    fn up(&self) -> &'static str {
        self.up.name()
    }

    /// Pairs of joint indices that bones connect; None if unknown.
    #[getter]
    fn bones(&self) -> Option<Vec<(usize, usize)>> {
        self.bones.clone()
    }

    /// Positions of the joints, shape (T, J, 3).
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let frames = (0..self.inner.frames()).filter_map(|frame| self.inner.frame(frame));
        let numbers = frames.flatten().flat_map(|at| at.to_array());
        let numbers = PyArray1::from_iter(py, numbers);
        numbers.reshape([self.inner.frames(), self.inner.names().len(), 3])
    }

    fn __len__(&self) -> usize {
        self.inner.frames()
    }

    fn __repr__(&self) -> String {
        format!(
            "Capture({} frames of {} joints, {} a second)",
            self.inner.frames(),
            self.inner.names().len(),
            self.inner.frame_rate()
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let capture = slf.get();
        let positions = capture.positions(slf.py())?;
        pickling::by_class::<Self>(
            slf.py(),
            (
                positions,
                capture.joints(),
                capture.fps(),
                capture.up(),
                capture.bones(),
            ),
        )
    }
}
