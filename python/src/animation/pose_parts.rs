//! Conversion of poses from and to arrays.

use kinopt::animation::{Armature as Bones, LocalTransform, Pose as Locals};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::transforms::{Order, numbers, quaternions, vectors};

/// Makes an array read-only: writes to it would not change the pose.
pub(super) fn frozen(array: Bound<'_, PyArrayDyn<f32>>) -> PyResult<Bound<'_, PyArrayDyn<f32>>> {
    arrays::freeze(&array)?;
    Ok(array)
}

/// Arguments of one pose or N poses as arrays.
pub(super) struct Parts<'a, 'py> {
    pub(super) translations: Option<&'a Bound<'py, PyAny>>,
    pub(super) rotations: Option<(&'a Bound<'py, PyAny>, Order)>,
    pub(super) scales: Option<&'a Bound<'py, PyAny>>,
    pub(super) morph_weights: Option<&'a Bound<'py, PyAny>>,
}

impl Parts<'_, '_> {
    /// Pose of an armature; missing arguments are at rest.
    pub(super) fn pose(&self, armature: &Bones) -> PyResult<Locals> {
        let mut pose = armature.rest().clone();
        let bones = armature.bones();
        let sized = |what: &str, count: usize| match count == bones {
            true => Ok(()),
            false => Err(invalid(format!("{count} {what} for {bones} bones"))),
        };
        let translations = match self.translations {
            Some(value) => vectors(value, "translations")?,
            None => pose.translations().to_vec(),
        };
        let rotations = match self.rotations {
            Some((value, order)) => quaternions(value, order)?,
            None => pose.rotations().to_vec(),
        };
        let scales = match self.scales {
            Some(value) => vectors(value, "scales")?,
            None => pose.scales().to_vec(),
        };
        sized("translations", translations.len())?;
        sized("rotations", rotations.len())?;
        sized("scales", scales.len())?;
        for (index, ((translation, rotation), scale)) in translations
            .into_iter()
            .zip(rotations)
            .zip(scales)
            .enumerate()
        {
            let local = LocalTransform {
                translation,
                rotation,
                scale,
            };
            if let Some(bone) = armature.bone_at(index) {
                pose.set_local(bone, local).or_raise()?;
            }
        }
        if let Some(weights) = self.morph_weights {
            let weights = weights_of(weights, armature)?;
            pose.morph_weights_mut().copy_from_slice(&weights);
        }
        Ok(pose)
    }
}

/// Reads finite weights, one for each morph target.
pub(super) fn weights_of(value: &Bound<'_, PyAny>, armature: &Bones) -> PyResult<Vec<f32>> {
    let weights = numbers(value, "morph_weights", Some(armature.morph_targets().len()))?;
    match weights.iter().all(|weight| weight.is_finite()) {
        true => Ok(weights),
        false => Err(invalid("morph_weights are not all finite")),
    }
}

/// Quaternions of a pose, one after another.
pub(super) fn rotations(order: Order) -> impl Fn(&Locals) -> Vec<f32> {
    move |locals| {
        let rotations = locals.rotations().iter();
        rotations.flat_map(|&q| order.to_array(q)).collect()
    }
}
