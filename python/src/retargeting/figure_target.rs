//! Skeletons as targets of retargeting: rigs, scenes, captures.

use std::sync::Arc;

use kinopt::animation::Armature as Bones;
use kinopt::motion::retarget::{self, UpAxis};
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
use crate::scene::Scene;
use crate::skeleton::Skeleton;

/// The bones of a rig, a skeleton, a scene or a motion capture on a free base, rotated to an upright pose.
///
/// `up` is the upward axis of the file: by default "y" for scenes and captures, "z" for rigs and skeletons. The joints
/// of a scene's skins rotate, and the bones of a capture with rotation channels; without any, all bones rotate.
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
            let inner = retarget::FigureTarget::new(bones, up.unwrap_or(UpAxis::Z));
            wrap(inner, &Bones::of_skeleton(bones))
        };
        let of_file = |bones: &Bones, turning| {
            let up = up.unwrap_or(UpAxis::Y);
            wrap(
                retarget::FigureTarget::of_armature(bones, &turning, up),
                bones,
            )
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
        pickling::by_class::<Self>(slf.py(), (figure.source.clone_ref(slf.py()), figure.up()))
    }
}
