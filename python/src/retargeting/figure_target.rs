//! Skeletons as targets of retargeting: rigs, scenes, captures.

use std::path::Path;
use std::sync::Arc;

use kinopt::animation::Armature as Bones;
use kinopt::motion::retarget::{self, UpAxis};
use kinopt_bindings::trajectory_file::{FigureFile, TrajectoryFormat, write_figure};
use numpy::ndarray::Ix2;
use pyo3::prelude::*;

use super::up_axis::up_axis;
use crate::animation::{Armature, Clip};
use crate::arrays::{self, Numbers};
use crate::capture::MotionCapture;
use crate::error::{OrRaise, invalid};
use crate::model::Model;
use crate::pickling;
use crate::rig::Rig;
use crate::scene::{Scene, SceneFile};
use crate::skeleton::Skeleton;

/// Writes the motion of a figure, configurations at a rate, as a .bvh or a .glb with a named clip. Returns false for a
/// robot or a model.
pub(crate) fn write(
    target: &Bound<'_, PyAny>,
    motion: (&[f64], f64),
    clip: &str,
    to: (TrajectoryFormat, &Path),
) -> PyResult<bool> {
    let (py, given) = (target.py(), target.cast::<FigureTarget>());
    let converted = match &given {
        Ok(_) => None,
        Err(_) => FigureTarget::of(target, None)?,
    };
    let Some(figure) = given
        .as_ref()
        .ok()
        .map(|figure| figure.get())
        .or(converted.as_ref())
    else {
        return Ok(false);
    };
    let source = figure.source.bind(py);
    let write = |file: FigureFile<'_>| {
        let written = py.detach(|| write_figure(&figure.inner, file, motion, clip, to));
        written.or_raise().map(|()| true)
    };
    if let Ok(file) = source.cast::<SceneFile>() {
        return write(FigureFile::SceneFile(&file.try_borrow()?.inner));
    }
    if let Ok(scene) = source.cast::<Scene>() {
        return write(FigureFile::Scene(&scene.get().inner));
    }
    if let Ok(capture) = source.cast::<MotionCapture>() {
        let capture = &capture.get().inner;
        let (armature, turning) = (&capture.armature, capture.turning_bones());
        let skeleton = armature.turning_skeleton("capture", &turning).or_raise()?;
        let (channels, skeleton) = (&*capture.channels, &skeleton);
        return write(FigureFile::Capture {
            armature,
            channels,
            skeleton,
        });
    }
    if let Ok(rig) = source.cast::<Rig>() {
        let rig = &*rig.get().inner;
        let skin = rig.mesh.as_ref().zip(rig.weights.as_ref());
        let skeleton = &rig.skeleton;
        return write(FigureFile::Skeleton { skeleton, skin });
    }
    let skeleton = &*source.cast::<Skeleton>()?.get().inner;
    write(FigureFile::Skeleton {
        skeleton,
        skin: None,
    })
}

/// The bones of a rig, a skeleton, a scene or a motion capture on a free base, rotated to an upright pose.
///
/// `up` is the upward axis of the file: by default the axis from the ankles to the pelvis at rest, else "y" for scenes
/// and captures, "z" for rigs and skeletons. The joints
/// of a scene's skins rotate, and the bones of a capture with rotation channels; without any, all bones rotate. A
/// pickled figure of a `SceneFile` has its `Scene` only.
///
/// Raises `InvalidValueError` for other objects, and for bones with children and a non-uniform scale.
#[pyclass(frozen, module = "kinopt.retargeting")]
pub(crate) struct FigureTarget {
    source: Py<PyAny>,
    pub(super) inner: retarget::FigureTarget,
    armature: Arc<Bones>,
}

impl FigureTarget {
    /// Converts a rig, skeleton, scene or capture; `None` for a robot or a model.
    pub(super) fn of(target: &Bound<'_, PyAny>, up: Option<UpAxis>) -> PyResult<Option<Self>> {
        let wrap = |inner: Result<_, retarget::RetargetError>, armature: &Bones| {
            Ok(Some(Self {
                source: target.clone().unbind(),
                inner: inner.or_raise()?,
                armature: Arc::new(armature.clone()),
            }))
        };
        let of_bones = |bones: &kinopt::Skeleton| {
            let up = up.or_else(|| retarget::FigureTarget::up_axis(bones));
            let inner = retarget::FigureTarget::new(bones, up.unwrap_or(UpAxis::Z));
            wrap(inner, &Bones::of_skeleton(bones))
        };
        let of_file = |bones: &Bones, turning| {
            let skeleton = bones.turning_skeleton("figure", &turning).or_raise()?;
            let up = up.or_else(|| retarget::FigureTarget::up_axis(&skeleton));
            let inner = retarget::FigureTarget::new(&skeleton, up.unwrap_or(UpAxis::Y));
            wrap(inner, bones)
        };
        if let Ok(rig) = target.cast::<Rig>() {
            return of_bones(&rig.get().inner.skeleton);
        }
        if let Ok(skeleton) = target.cast::<Skeleton>() {
            return of_bones(&skeleton.get().inner);
        }
        if let Ok(scene) = target.cast::<Scene>() {
            let scene = &scene.get().inner;
            return of_file(&scene.armature, scene.turning_bones());
        }
        if let Ok(file) = target.cast::<SceneFile>() {
            let file = file.try_borrow()?;
            let scene = file.inner.scene();
            return of_file(&scene.armature, scene.turning_bones());
        }
        if let Ok(capture) = target.cast::<MotionCapture>() {
            let capture = &capture.get().inner;
            return of_file(&capture.armature, capture.turning_bones());
        }
        Ok(None)
    }
}

#[pymethods]
impl FigureTarget {
    #[new]
    #[pyo3(signature = (of, up = None))]
    fn new(of: &Bound<'_, PyAny>, up: Option<&str>) -> PyResult<Self> {
        let figure = Self::of(of, up.map(up_axis).transpose()?)?;
        let kind = of.get_type();
        let unsupported = || {
            invalid(format!(
                "expected a rig, a skeleton, a scene or a motion capture, not {kind}"
            ))
        };
        figure.ok_or_else(unsupported)
    }

    /// Model: a free base, then three angles for each bone.
    #[getter]
    fn model(&self) -> Model {
        let inner = Arc::new(self.inner.robot().model().clone());
        Model { inner }
    }

    /// Armature of the clips: that of the scene or capture, or of a rig's skeleton.
    #[getter]
    fn armature(&self) -> Armature {
        Arc::clone(&self.armature).into()
    }

    /// Upward axis of the file.
    #[getter]
    fn up(&self) -> &'static str {
        self.inner.up().name()
    }

    /// A trajectory, configurations of shape (T, nq) at `fps` a second, as a clip of the armature, in the axes of the
    /// file.
    ///
    /// Raises `InvalidValueError` for another shape, no frames, and a rate that is not positive.
    #[pyo3(signature = (q, fps, name = "retargeted"))]
    fn clip(&self, py: Python<'_>, q: &Bound<'_, PyAny>, fps: f64, name: &str) -> PyResult<Clip> {
        let numbers: Numbers<'_, Ix2> = arrays::numbers(q, "q", "(frames, nq)")?;
        let width = self.inner.robot().model().configuration_len();
        let shape = numbers.shape();
        if shape[1] != width {
            return Err(invalid(format!(
                "q has shape {}, expected (frames, {width})",
                arrays::shape_text(shape)
            )));
        }
        let q = &*numbers;
        let clip = py.detach(|| self.inner.clip(name, &self.armature, q, fps));
        Ok(Clip::of(&self.armature, Arc::new(clip.or_raise()?)))
    }

    fn __repr__(&self) -> String {
        let model = self.inner.robot().model();
        format!(
            "FigureTarget({} bones, {} upward)",
            self.armature.bones(),
            self.inner.up().name()
        ) + &format!(" of {} numbers", model.configuration_len())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let figure = slf.get();
        let source = figure.source.bind(slf.py());
        let source = match source.cast::<SceneFile>() {
            Ok(_) => source.getattr("scene")?,
            Err(_) => source.clone(),
        };
        pickling::by_class::<Self>(slf.py(), (source, figure.up()))
    }
}
