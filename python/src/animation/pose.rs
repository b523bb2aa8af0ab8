//! Single poses: a local transform for each bone and a weight for each morph target.

use std::sync::Arc;

use kinopt::animation::Pose as Locals;
use kinopt::glam::{Quat, Vec3A};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::bones_and_poses::{Armature, Pose};
use super::mask::BoneMask;
use super::pose_parts::{Parts, frozen, rotations, weights_of};
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::transforms::{
    Order, flat, one_to_array, quaternion, quaternion_argument, shaped, vector,
};

impl Pose {
    fn array<'py>(
        &self,
        py: Python<'py>,
        numbers: impl FnOnce(&Locals) -> Vec<f32>,
        columns: usize,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let numbers = self.with(|locals| numbers(locals));
        let rows = numbers.len() / columns;
        frozen(shaped(py, numbers, &[rows, columns])?)
    }
}

#[pymethods]
impl Pose {
    #[new]
    #[pyo3(signature = (
        armature, *, translations = None, rotations_xyzw = None, rotations_wxyz = None, scales = None,
        morph_weights = None
    ))]
    fn new(
        armature: &Bound<'_, Armature>,
        translations: Option<&Bound<'_, PyAny>>,
        rotations_xyzw: Option<&Bound<'_, PyAny>>,
        rotations_wxyz: Option<&Bound<'_, PyAny>>,
        scales: Option<&Bound<'_, PyAny>>,
        morph_weights: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let armature = &armature.get().inner;
        let parts = Parts {
            translations,
            rotations: quaternion_argument(rotations_xyzw, rotations_wxyz, "rotations")?,
            scales,
            morph_weights,
        };
        Ok(Self::of(armature, parts.pose(armature)?))
    }

    /// Armature of the pose.
    #[getter]
    fn armature(&self) -> Armature {
        Arc::clone(&self.armature).into()
    }

    /// Local translations of the bones, shape (bones, 3), float32.
    #[getter]
    fn translations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.array(py, |locals| flat(locals.translations()).collect(), 3)
    }

    /// Local rotations of the bones, shape (bones, 4), float32: unit quaternions x, y, z, w.
    #[getter]
    fn rotations_xyzw<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.array(py, rotations(Order::Xyzw), 4)
    }

    /// Local rotations of the bones, shape (bones, 4), float32: unit quaternions w, x, y, z.
    #[getter]
    fn rotations_wxyz<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.array(py, rotations(Order::Wxyz), 4)
    }

    /// Local scales of the bones along their own axes, shape (bones, 3), float32.
    #[getter]
    fn scales<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.array(py, |locals| flat(locals.scales()).collect(), 3)
    }

    /// Weights of the morph targets, shape (targets,), float32; may be assigned.
    #[getter]
    fn morph_weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let weights = self.with(|locals| locals.morph_weights().to_vec());
        let count = weights.len();
        shaped(py, weights, &[count])
    }

    #[setter]
    fn set_morph_weights(&self, weights: &Bound<'_, PyAny>) -> PyResult<()> {
        let weights = weights_of(weights, &self.armature)?;
        self.with(|locals| locals.morph_weights_mut().copy_from_slice(&weights));
        Ok(())
    }

    /// Sets the weight of a morph target.
    ///
    /// Raises `UnknownNameError`, which lists the targets.
    fn set_morph_weight(&self, target: &str, weight: f32) -> PyResult<()> {
        let index = self.armature.morph_target(target).or_raise()?;
        if !weight.is_finite() {
            return Err(invalid(format!("the weight {weight} is not finite")));
        }
        self.with(|locals| locals.morph_weights_mut()[index] = weight);
        Ok(())
    }

    /// Local transform of a bone, shape (4, 4), float32: parent_from_bone.
    ///
    /// Raises `UnknownNameError` for an unknown bone.
    fn local<'py>(&self, py: Python<'py>, bone: &str) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let bone = self.armature.bone(bone).or_raise()?;
        let local = self.with(|locals| locals.local(bone)).or_raise()?;
        one_to_array(py, &local.to_affine())
    }

    /// Sets parts of the local transform of a bone; missing arguments keep their values. A quaternion of shape (4,), x,
    /// y, z, w as `rotation_xyzw` or w, x, y, z as `rotation_wxyz`, of any length, is normalised. `translation` and
    /// `scale` have shape (3,).
    ///
    /// Raises `UnknownNameError`, and `InvalidValueError` for numbers that are not finite.
    #[pyo3(signature = (bone, *, translation = None, rotation_xyzw = None, rotation_wxyz = None, scale = None))]
    fn set_local(
        &self,
        bone: &str,
        translation: Option<&Bound<'_, PyAny>>,
        rotation_xyzw: Option<&Bound<'_, PyAny>>,
        rotation_wxyz: Option<&Bound<'_, PyAny>>,
        scale: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let bone = self.armature.bone(bone).or_raise()?;
        let rotation = quaternion_argument(rotation_xyzw, rotation_wxyz, "rotations")?;
        let rotation: Option<Quat> = rotation
            .map(|(q, order)| quaternion(q, order))
            .transpose()?;
        let translation: Option<Vec3A> =
            translation.map(|v| vector(v, "translation")).transpose()?;
        let scale: Option<Vec3A> = scale.map(|v| vector(v, "scale")).transpose()?;
        self.with(|locals| {
            let mut local = locals.local(bone)?;
            local.translation = translation.unwrap_or(local.translation);
            local.rotation = rotation.unwrap_or(local.rotation);
            local.scale = scale.unwrap_or(local.scale);
            locals.set_local(bone, local)
        })
        .or_raise()
    }

    /// Interpolates towards another pose by the fraction `share` (clamped to [0, 1]): rotations by slerp along the
    /// shorter arc, other properties linearly. With `mask`, `share` is multiplied by the weight of each bone and morph
    /// target.
    ///
    /// Raises `InvalidValueError` for a pose or mask of another armature.
    #[pyo3(signature = (to, share, mask = None))]
    fn cross_fade(
        &self,
        to: &Bound<'_, Self>,
        share: f32,
        mask: Option<&Bound<'_, BoneMask>>,
    ) -> PyResult<()> {
        let to = to.get().now();
        self.with(|locals| match mask {
            Some(mask) => locals.cross_fade_masked(&to, share, &mask.get().inner),
            None => locals.cross_fade(&to, share),
        })
        .or_raise()
    }

    /// Copies another pose of its armature.
    ///
    /// Raises `InvalidValueError` for a pose of another armature.
    fn copy_from(&self, other: &Bound<'_, Self>) -> PyResult<()> {
        let other = other.get().now();
        self.with(|locals| {
            // A cross-fade by 0 changes nothing, but returns an error for another armature size.
            locals.cross_fade(&other, 0.0)?;
            locals.copy_from(&other);
            Ok::<(), kinopt::animation::SizeMismatch>(())
        })
        .or_raise()
    }

    /// Independent copy of the pose.
    pub(crate) fn copy(&self) -> Self {
        Self::of(&self.armature, self.now())
    }

    fn __copy__(&self) -> Self {
        self.copy()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = serde_json::to_string(&self.now()).or_raise()?;
        pickling::by_rebuild::<Self>(py, (self.armature(), text))
    }

    #[staticmethod]
    fn _rebuild(armature: &Bound<'_, Armature>, text: &str) -> PyResult<Self> {
        let armature = &armature.get().inner;
        let locals: Locals = serde_json::from_str(text).or_raise()?;
        // Returns an error for another armature size.
        armature
            .rest()
            .clone()
            .cross_fade(&locals, 0.0)
            .or_raise()?;
        Ok(Self::of(armature, locals))
    }

    fn __repr__(&self) -> String {
        format!(
            "Pose({} bones, {} morph targets)",
            self.armature.bones(),
            self.armature.morph_targets().len()
        )
    }
}
