//! Blending: layers and weighted means of poses.

use std::sync::Arc;

use kinopt::animation::{Layer as Over, LayerMode};
use pyo3::prelude::*;

use super::bones_and_poses::{Pose, Poses, poses_of};
use super::mask::BoneMask;
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::transforms::numbers;

/// A layer over a base pose, with a weight and a mask.
///
/// Without a `reference` it replaces the base by cross-fade. With a `reference` it is additive: the difference from
/// that pose.
///
/// `weight` is within [0, 1] for a cross-fade. For an additive layer it is any finite number; 1 adds the whole
/// difference from `reference`.
///
/// Raises `InvalidValueError` for a weight that is not finite.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Layer {
    inner: Over,
    mask: Py<BoneMask>,
    reference: Option<Py<Pose>>,
}

#[pymethods]
impl Layer {
    #[new]
    #[pyo3(signature = (mask, weight = 1.0, reference = None))]
    fn new(
        mask: &Bound<'_, BoneMask>,
        weight: f32,
        reference: Option<&Bound<'_, Pose>>,
    ) -> PyResult<Self> {
        if !weight.is_finite() {
            return Err(invalid(format!("the weight {weight} is not finite")));
        }
        let mode = match reference {
            Some(reference) => LayerMode::Additive {
                reference: reference.get().now(),
            },
            None => LayerMode::Override,
        };
        let inner = Over {
            mode,
            weight,
            mask: mask.get().inner.clone(),
        };
        let reference = reference.map(|pose| Py::new(pose.py(), pose.get().copy()));
        Ok(Self {
            inner,
            mask: mask.clone().unbind(),
            reference: reference.transpose()?,
        })
    }

    /// Weight of the layer.
    #[getter]
    fn weight(&self) -> f32 {
        self.inner.weight
    }

    /// Mask of bones and morph targets.
    #[getter]
    fn mask(&self, py: Python<'_>) -> Py<BoneMask> {
        self.mask.clone_ref(py)
    }

    /// Reference pose of an additive layer; None for a cross-fade.
    #[getter]
    fn reference(&self, py: Python<'_>) -> PyResult<Option<Py<Pose>>> {
        let copy = |pose: &Py<Pose>| Py::new(py, pose.get().copy());
        self.reference.as_ref().map(copy).transpose()
    }

    /// Applies the layer's pose to a base pose, which is changed.
    ///
    /// Raises `InvalidValueError` for poses or a mask of different armatures.
    fn apply(&self, base: &Bound<'_, Pose>, layer: &Bound<'_, Pose>) -> PyResult<()> {
        let layer = layer.get().now();
        base.get()
            .with(|base| self.inner.apply(base, &layer))
            .or_raise()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (self.mask(py), self.inner.weight, self.reference(py)?);
        pickling::by_class::<Self>(py, parts)
    }

    fn __repr__(&self) -> String {
        let mode = match self.inner.mode {
            LayerMode::Additive { .. } => "on top",
            _ => "in place",
        };
        format!("Layer({mode}, weight={})", self.inner.weight)
    }
}

/// Weighted mean of poses, a new pose; `weights`, shape (N,), of at least 0, need not sum to one.
///
/// Raises `InvalidValueError` for a weight that is negative or not finite, for no weight above 0, and for poses of
/// different armatures.
#[pyfunction]
pub(crate) fn blend_poses(poses: &Bound<'_, PyAny>, weights: &Bound<'_, PyAny>) -> PyResult<Pose> {
    let (list, _) = poses_of(poses)?;
    let armature = match poses.cast::<Poses>() {
        Ok(poses) => Some(Arc::clone(&poses.get().armature)),
        Err(_) => {
            let first = poses.try_iter()?.next().transpose()?;
            let pose = first.as_ref().and_then(|pose| pose.cast::<Pose>().ok());
            pose.map(|pose| Arc::clone(pose.get().bones()))
        }
    };
    let armature = armature.ok_or_else(|| invalid("there are no poses to blend"))?;
    let weights = numbers(weights, "weights", Some(list.len()))?;
    let weighted: Vec<_> = list.iter().zip(weights).collect();
    let mut out = armature.rest().clone();
    kinopt::animation::blend_poses(&weighted, &mut out).or_raise()?;
    Ok(Pose::of(&armature, out))
}
