//! Motion capture by joint positions.

use std::path::PathBuf;
use std::sync::Arc;

use kinopt::io::c3d;
use kinopt::motion::retarget::{self, JointRotations, UpAxis};
use kinopt::spatial::Vector3;
use numpy::ndarray::{Ix2, Ix3};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods};
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
/// joint indices, parent first, if known.
///
/// `rotations` of shape (T, J, 4) are those of the joints: unit quaternions w, x, y, z from their axes to the world, for
/// characters. They need `bones`, and `rest`: positions (J, 3) and rotations (J, 4) of the joints in the rest pose.
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

/// Positions and rotations of the joints in the rest pose.
type RestPose<'py> = (Bound<'py, PyAny>, Bound<'py, PyAny>);

/// Positions and rotations of the joints in the rest pose, as arrays.
type RestArrays<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

/// Reads the rotations of joints, which need the pairs of parent and child and a rest pose.
fn joint_rotations(
    joints: usize,
    bones: Option<&[(usize, usize)]>,
    rotations: &Bound<'_, PyAny>,
    rest: Option<&RestPose<'_>>,
) -> PyResult<JointRotations> {
    let (Some(bones), Some((positions, rest_rotations))) = (bones, rest) else {
        return Err(invalid("rotations need bones and rest"));
    };
    let mut parents = vec![None; joints];
    for (parent, child) in bones {
        parents[*child] = Some(*parent);
    }
    let quaternions = |numbers: &[f64]| -> Vec<[f64; 4]> {
        let rows = numbers.chunks_exact(4);
        rows.map(|q| [q[0], q[1], q[2], q[3]]).collect()
    };
    let check = |shape: &[usize], name: &str, width: usize| match shape.ends_with(&[joints, width])
    {
        true => Ok(()),
        false => Err(invalid(format!(
            "{name} has shape {}, expected (…, {joints}, {width})",
            arrays::shape_text(shape)
        ))),
    };
    let turned: Numbers<'_, Ix3> = arrays::numbers(rotations, "rotations", "(frames, joints, 4)")?;
    check(turned.shape(), "rotations", 4)?;
    let at: Numbers<'_, Ix2> = arrays::numbers(positions, "rest positions", "(joints, 3)")?;
    check(at.shape(), "rest positions", 3)?;
    let rest: Numbers<'_, Ix2> = arrays::numbers(rest_rotations, "rest rotations", "(joints, 4)")?;
    check(rest.shape(), "rest rotations", 4)?;
    let points = at.chunks_exact(3);
    Ok(JointRotations {
        parents,
        rest_positions: points.map(|at| Vector3::new(at[0], at[1], at[2])).collect(),
        rest_rotations: quaternions(&rest),
        rotations: quaternions(&turned),
    })
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
    #[pyo3(signature = (positions, joints, fps, up = None, bones = None, rotations = None, rest = None))]
    #[allow(
        clippy::too_many_arguments,
        reason = "arguments of a Python constructor"
    )]
    fn new(
        py: Python<'_>,
        positions: &Bound<'_, PyAny>,
        joints: Vec<String>,
        fps: f64,
        up: Option<&str>,
        bones: Option<Vec<(usize, usize)>>,
        rotations: Option<&Bound<'_, PyAny>>,
        rest: Option<RestPose<'_>>,
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
        let rotations = rotations.map(|rotations| {
            joint_rotations(joints.len(), bones.as_deref(), rotations, rest.as_ref())
        });
        let rotations = rotations.transpose()?;
        let numbers = &*numbers;
        let capture = py.detach(|| {
            let capture = retarget::Capture::new(joints, numbers, fps)?;
            match rotations {
                Some(rotations) => capture.with_rotations(rotations),
                None => Ok(capture),
            }
        });
        Ok(Self::of(capture.or_raise()?, up, UpAxis::Z, bones))
    }

    /// Positions and rotations of a clip's bones, at `fps` frames a second from its start to its end. `up` is as in `Capture`; it is
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

    /// Rotations of the joints, shape (T, J, 4), quaternions w, x, y, z; None for a capture of positions.
    #[getter]
    fn rotations<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray3<f64>>>> {
        let Some(posed) = self.inner.rotations() else {
            return Ok(None);
        };
        let numbers = PyArray1::from_iter(py, posed.rotations.into_iter().flatten());
        let shape = [self.inner.frames(), self.inner.names().len(), 4];
        numbers.reshape(shape).map(Some)
    }

    /// Rest pose: positions (J, 3) and rotations (J, 4) of the joints; None for a capture of positions.
    #[getter]
    fn rest<'py>(&self, py: Python<'py>) -> PyResult<Option<RestArrays<'py>>> {
        let Some(posed) = self.inner.rotations() else {
            return Ok(None);
        };
        let joints = self.inner.names().len();
        let positions = posed.rest_positions.iter().flat_map(|at| at.to_array());
        let positions = PyArray1::from_iter(py, positions).reshape([joints, 3])?;
        let rotations = PyArray1::from_iter(py, posed.rest_rotations.into_iter().flatten());
        Ok(Some((positions, rotations.reshape([joints, 4])?)))
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
                capture.rotations(slf.py())?,
                capture.rest(slf.py())?,
            ),
        )
    }
}
