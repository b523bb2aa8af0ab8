//! Masks: weights of bones and morph targets.

use std::sync::Arc;

use kinopt::animation::{Armature as Bones, BoneMask as Mask};
use numpy::PyArrayDyn;
use pyo3::prelude::*;
use pyo3::types::PyType;

use super::bones_and_poses::Armature;
use crate::error::OrRaise;
use crate::pickling;
use crate::transforms::{numbers, shaped};

/// Immutable mask: a weight within [0, 1] for each bone and each morph target of an armature.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct BoneMask {
    pub(crate) inner: Mask,
    armature: Arc<Bones>,
}

impl BoneMask {
    fn with(&self, inner: Mask) -> Self {
        let armature = Arc::clone(&self.armature);
        Self { inner, armature }
    }
}

#[pymethods]
impl BoneMask {
    /// Mask of the whole armature: all weights are 1.
    #[classmethod]
    fn all(_class: &Bound<'_, PyType>, armature: &Bound<'_, Armature>) -> Self {
        let armature = Arc::clone(&armature.get().inner);
        let inner = Mask::all(&armature);
        Self { inner, armature }
    }

    /// Empty mask: all weights are 0.
    #[classmethod]
    fn none(_class: &Bound<'_, PyType>, armature: &Bound<'_, Armature>) -> Self {
        let armature = Arc::clone(&armature.get().inner);
        let inner = Mask::none(&armature);
        Self { inner, armature }
    }

    /// The mask with another weight of one bone.
    ///
    /// Raises `UnknownNameError`, and `InvalidValueError` for a share that is not within [0, 1].
    #[pyo3(signature = (bone, share = 1.0))]
    fn with_bone(&self, bone: &str, share: f32) -> PyResult<Self> {
        let bone = self.armature.bone(bone).or_raise()?;
        Ok(self.with(self.inner.clone().with_bone(bone, share).or_raise()?))
    }

    /// The mask with another weight of a bone and its descendants.
    ///
    /// Raises as `with_bone`.
    #[pyo3(signature = (root, share = 1.0))]
    fn with_subtree(&self, root: &str, share: f32) -> PyResult<Self> {
        let root = self.armature.bone(root).or_raise()?;
        let mask = self.inner.clone().with_subtree(&self.armature, root, share);
        Ok(self.with(mask.or_raise()?))
    }

    /// The mask with another weight of one morph target.
    ///
    /// Raises `UnknownNameError`, and `InvalidValueError` for a share that is not within [0, 1].
    #[pyo3(signature = (target, share = 1.0))]
    fn with_morph_target(&self, target: &str, share: f32) -> PyResult<Self> {
        let target = self.armature.morph_target(target).or_raise()?;
        let mask = self.inner.clone().with_morph_target(target, share);
        Ok(self.with(mask.or_raise()?))
    }

    /// Weights of the bones, shape (bones,), float32.
    #[getter]
    fn bones<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        shaped(py, self.inner.bones().to_vec(), &[self.inner.bones().len()])
    }

    /// Weights of the morph targets, shape (targets,), float32.
    #[getter]
    fn morph_targets<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let weights = self.inner.morph_targets().to_vec();
        let count = weights.len();
        shaped(py, weights, &[count])
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let armature = Armature::from(Arc::clone(&self.armature));
        let parts = (armature, self.bones(py)?, self.morph_targets(py)?);
        pickling::by_rebuild::<Self>(py, parts)
    }

    #[staticmethod]
    fn _rebuild(
        armature: &Bound<'_, Armature>,
        bones: &Bound<'_, PyAny>,
        morph_targets: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let armature = Arc::clone(&armature.get().inner);
        let mut inner = Mask::none(&armature);
        for (i, share) in numbers(bones, "bones", Some(armature.bones()))?
            .into_iter()
            .enumerate()
        {
            if let Some(bone) = armature.bone_at(i) {
                inner = inner.with_bone(bone, share).or_raise()?;
            }
        }
        let targets = Some(armature.morph_targets().len());
        for (i, share) in numbers(morph_targets, "targets", targets)?
            .into_iter()
            .enumerate()
        {
            inner = inner.with_morph_target(i, share).or_raise()?;
        }
        Ok(Self { inner, armature })
    }

    fn __repr__(&self) -> String {
        let moved = self.inner.bones().iter().filter(|share| **share > 0.0);
        format!(
            "BoneMask({} of {} bones)",
            moved.count(),
            self.inner.bones().len()
        )
    }
}
