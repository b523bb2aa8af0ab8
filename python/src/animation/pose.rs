//! Poses: a local transform for each bone and a weight for each morph target; one of them, or many.

use std::sync::{Arc, Mutex, PoisonError};

use kinopt::animation::{Armature as Bones, LocalTransform, Pose as Locals};
use kinopt::glam::{Quat, Vec3A};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::armature::Armature;
use super::blend::BoneMask;
use crate::arrays::{self, place};
use crate::error::{OrRaise, invalid};
use crate::items::Items;
use crate::transforms::{
    Order, flat, given, numbers, one_to_array, quaternion, quaternions, shaped, vector, vectors,
};

/// A local transform for each bone of an armature and a weight for each of its morph targets.
///
/// Bones are scaled, then turned, then moved, in their parents. Numbers are float32, lengths in the
/// armature's unit. A pose can be changed; calls from many threads come one after another.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Pose {
    armature: Arc<Bones>,
    locals: Mutex<Locals>,
}

impl Pose {
    pub(crate) fn of(armature: &Arc<Bones>, locals: Locals) -> Self {
        Self {
            armature: Arc::clone(armature),
            locals: Mutex::new(locals),
        }
    }

    /// A copy as it is now.
    pub(crate) fn now(&self) -> Locals {
        self.with(|locals| locals.clone())
    }

    /// Does something with it that makes no Python objects.
    pub(crate) fn with<T>(&self, run: impl FnOnce(&mut Locals) -> T) -> T {
        run(&mut self.locals.lock().unwrap_or_else(PoisonError::into_inner))
    }

    /// The armature's bones.
    pub(crate) fn bones(&self) -> &Arc<Bones> {
        &self.armature
    }

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

/// An array that nobody can write to: a pose would not hear of it.
fn frozen(array: Bound<'_, PyArrayDyn<f32>>) -> PyResult<Bound<'_, PyArrayDyn<f32>>> {
    arrays::freeze(&array)?;
    Ok(array)
}

/// The parts of poses as arrays, N of them or one.
struct Parts<'a, 'py> {
    translations: Option<&'a Bound<'py, PyAny>>,
    rotations: Option<(&'a Bound<'py, PyAny>, Order)>,
    scales: Option<&'a Bound<'py, PyAny>>,
    morph_weights: Option<&'a Bound<'py, PyAny>>,
}

impl Parts<'_, '_> {
    fn pose(&self, armature: &Bones) -> PyResult<Locals> {
        let mut pose = armature.rest().clone();
        let bones = armature.bones();
        let sized = |what: &str, given: usize| match given == bones {
            true => Ok(()),
            false => Err(invalid(format!("{given} {what} for {bones} bones"))),
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

/// Finite weights, one for each morph target.
fn weights_of(value: &Bound<'_, PyAny>, armature: &Bones) -> PyResult<Vec<f32>> {
    let weights = numbers(value, "morph_weights", Some(armature.morph_targets().len()))?;
    match weights.iter().all(|weight| weight.is_finite()) {
        true => Ok(weights),
        false => Err(invalid("morph_weights are not all finite")),
    }
}

fn rotations(order: Order) -> impl Fn(&Locals) -> Vec<f32> {
    move |locals| {
        let rotations = locals.rotations().iter();
        rotations.flat_map(|&q| order.to_array(q)).collect()
    }
}

#[pymethods]
impl Pose {
    /// A pose of an armature: what is not given is at rest. `translations` and `scales` have shape
    /// (bones, 3), `rotations_xyzw` or `rotations_wxyz` (bones, 4), of any length above 0,
    /// `morph_weights` (targets,).
    ///
    /// Raises `InvalidValueError` for another shape and for numbers that are not finite.
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
            rotations: given(rotations_xyzw, rotations_wxyz, "rotations")?,
            scales,
            morph_weights,
        };
        Ok(Self::of(armature, parts.pose(armature)?))
    }

    /// The armature it is of.
    #[getter]
    fn armature(&self) -> Armature {
        Arc::clone(&self.armature).into()
    }

    /// Where the bones are in their parents, shape (bones, 3), float32.
    #[getter]
    fn translations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.array(py, |locals| flat(locals.translations()).collect(), 3)
    }

    /// How the bones are turned in their parents, shape (bones, 4), float32: unit quaternions x, y, z, w.
    #[getter]
    fn rotations_xyzw<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.array(py, rotations(Order::Xyzw), 4)
    }

    /// How the bones are turned in their parents, shape (bones, 4), float32: unit quaternions w, x, y, z.
    #[getter]
    fn rotations_wxyz<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.array(py, rotations(Order::Wxyz), 4)
    }

    /// How the bones are scaled along their own axes, shape (bones, 3), float32.
    #[getter]
    fn scales<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.array(py, |locals| flat(locals.scales()).collect(), 3)
    }

    /// The weights of the morph targets, shape (targets,), float32; may be assigned.
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

    /// Sets one morph target's weight.
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

    /// A bone's place in its parent, shape (4, 4), float32: parent_from_bone.
    fn local<'py>(&self, py: Python<'py>, bone: &str) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let bone = self.armature.bone(bone).or_raise()?;
        let local = self.with(|locals| locals.local(bone)).or_raise()?;
        one_to_array(py, &local.to_affine())
    }

    /// Moves a bone in its parent; what is not given stays. A quaternion of shape (4,) and any length is
    /// made of unit length; `translation` and `scale` have shape (3,).
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
        let rotation = given(rotation_xyzw, rotation_wxyz, "rotations")?;
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

    /// Goes the share (taken into [0, 1]) of the way to another pose: rotations by slerp the shorter way
    /// round, everything else straight; by `mask`, each bone and morph target by its share as well.
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

    /// Makes this pose the same as another one of its armature.
    fn copy_from(&self, other: &Bound<'_, Self>) -> PyResult<()> {
        let other = other.get().now();
        self.with(|locals| {
            // Nothing of the way is to one of another size.
            locals.cross_fade(&other, 0.0)?;
            locals.copy_from(&other);
            Ok::<(), kinopt::animation::SizeMismatch>(())
        })
        .or_raise()
    }

    /// A pose of its own with the same numbers.
    pub(crate) fn copy(&self) -> Self {
        Self::of(&self.armature, self.now())
    }

    fn __copy__(&self) -> Self {
        self.copy()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rebuild = py.get_type::<Self>().getattr("_rebuild")?;
        let text = serde_json::to_string(&self.now()).or_raise()?;
        Ok((rebuild, (self.armature(), text))
            .into_pyobject(py)?
            .into_any())
    }

    #[staticmethod]
    fn _rebuild(armature: &Bound<'_, Armature>, text: &str) -> PyResult<Self> {
        let armature = &armature.get().inner;
        let locals: Locals = serde_json::from_str(text).or_raise()?;
        // Of one size, or an error.
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

/// Poses of one armature, such as a clip's at many times; nothing changes them.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Poses {
    pub(crate) armature: Arc<Bones>,
    pub(crate) list: Arc<Vec<Locals>>,
}

impl Poses {
    pub(crate) fn of(armature: &Arc<Bones>, list: Vec<Locals>) -> Self {
        Self {
            armature: Arc::clone(armature),
            list: Arc::new(list),
        }
    }

    fn array<'py>(
        &self,
        py: Python<'py>,
        numbers: impl Fn(&Locals) -> Vec<f32> + Sync,
        shape: &[usize],
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let all: Vec<f32> = py.detach(|| self.list.iter().flat_map(&numbers).collect());
        frozen(shaped(py, all, &[&[self.list.len()], shape].concat())?)
    }
}

#[pymethods]
impl Poses {
    /// N poses of an armature, as `Pose` with N before each shape; or of a list of `poses`.
    #[new]
    #[pyo3(signature = (
        armature, poses = None, *, translations = None, rotations_xyzw = None, rotations_wxyz = None,
        scales = None, morph_weights = None
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        armature: &Bound<'_, Armature>,
        poses: Option<&Bound<'_, PyAny>>,
        translations: Option<&Bound<'_, PyAny>>,
        rotations_xyzw: Option<&Bound<'_, PyAny>>,
        rotations_wxyz: Option<&Bound<'_, PyAny>>,
        scales: Option<&Bound<'_, PyAny>>,
        morph_weights: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let armature = &armature.get().inner;
        let rotations = given(rotations_xyzw, rotations_wxyz, "rotations")?;
        let stacks = [
            translations,
            rotations.map(|(q, _)| q),
            scales,
            morph_weights,
        ];
        if let Some(poses) = poses {
            if stacks.iter().any(Option::is_some) {
                return Err(invalid("poses are given as a list and as arrays"));
            }
            let (list, _) = asked(poses)?;
            for pose in &list {
                armature.rest().clone().cross_fade(pose, 0.0).or_raise()?;
            }
            return Ok(Self::of(armature, list));
        }
        let mut lengths = stacks.iter().flatten().map(|stack| stack.len());
        let count = lengths.next().transpose()?.unwrap_or(0);
        for length in lengths {
            if length? != count {
                return Err(invalid("the arrays are of different numbers of poses"));
            }
        }
        let mut list = Vec::with_capacity(count);
        for i in 0..count {
            let own = (
                item(translations, i)?,
                item(scales, i)?,
                item(morph_weights, i)?,
            );
            let turned = match rotations {
                Some((q, order)) => Some((q.get_item(i)?, order)),
                None => None,
            };
            let parts = Parts {
                translations: own.0.as_ref(),
                rotations: turned.as_ref().map(|(q, order)| (q, *order)),
                scales: own.1.as_ref(),
                morph_weights: own.2.as_ref(),
            };
            list.push(parts.pose(armature)?);
        }
        Ok(Self::of(armature, list))
    }

    /// The armature they are of.
    #[getter]
    fn armature(&self) -> Armature {
        Arc::clone(&self.armature).into()
    }

    /// Where the bones are in their parents, shape (N, bones, 3), float32.
    #[getter]
    fn translations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let numbers = |locals: &Locals| flat(locals.translations()).collect();
        self.array(py, numbers, &[self.armature.bones(), 3])
    }

    /// How the bones are turned in their parents, shape (N, bones, 4), float32: x, y, z, w.
    #[getter]
    fn rotations_xyzw<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.array(py, rotations(Order::Xyzw), &[self.armature.bones(), 4])
    }

    /// How the bones are turned in their parents, shape (N, bones, 4), float32: w, x, y, z.
    #[getter]
    fn rotations_wxyz<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        self.array(py, rotations(Order::Wxyz), &[self.armature.bones(), 4])
    }

    /// How the bones are scaled along their own axes, shape (N, bones, 3), float32.
    #[getter]
    fn scales<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let numbers = |locals: &Locals| flat(locals.scales()).collect();
        self.array(py, numbers, &[self.armature.bones(), 3])
    }

    /// The weights of the morph targets, shape (N, targets), float32.
    #[getter]
    fn morph_weights<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let numbers = |locals: &Locals| locals.morph_weights().to_vec();
        self.array(py, numbers, &[self.armature.morph_targets().len()])
    }

    fn __iter__(slf: &Bound<'_, Self>) -> PyResult<Items> {
        Items::of(slf)
    }

    fn __len__(&self) -> usize {
        self.list.len()
    }

    fn __getitem__(&self, i: isize) -> PyResult<Pose> {
        let pose = &self.list[place(i, self.list.len())?];
        Ok(Pose::of(&self.armature, pose.clone()))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let rebuild = py.get_type::<Self>().getattr("_rebuild")?;
        let text = serde_json::to_string(&*self.list).or_raise()?;
        Ok((rebuild, (self.armature(), text))
            .into_pyobject(py)?
            .into_any())
    }

    #[staticmethod]
    fn _rebuild(armature: &Bound<'_, Armature>, text: &str) -> PyResult<Self> {
        let armature = &armature.get().inner;
        let list: Vec<Locals> = serde_json::from_str(text).or_raise()?;
        for pose in &list {
            armature.rest().clone().cross_fade(pose, 0.0).or_raise()?;
        }
        Ok(Self::of(armature, list))
    }

    fn __repr__(&self) -> String {
        format!(
            "Poses({} of {} bones)",
            self.list.len(),
            self.armature.bones()
        )
    }
}

/// One pose's part of an array of many.
fn item<'py>(stack: Option<&Bound<'py, PyAny>>, i: usize) -> PyResult<Option<Bound<'py, PyAny>>> {
    stack.map(|stack| stack.get_item(i)).transpose()
}

/// The poses of a `Pose`, of `Poses` or of a list; and how many, where it is not one alone.
pub(crate) fn asked(value: &Bound<'_, PyAny>) -> PyResult<(Vec<Locals>, Option<usize>)> {
    if let Ok(pose) = value.cast::<Pose>() {
        return Ok((vec![pose.get().now()], None));
    }
    if let Ok(poses) = value.cast::<Poses>() {
        let list = Vec::clone(&poses.get().list);
        let count = list.len();
        return Ok((list, Some(count)));
    }
    let poses = value.try_iter().ok().map(|items| {
        let poses = items.map(|item| Ok(item?.cast::<Pose>()?.get().now()));
        poses.collect::<PyResult<Vec<_>>>().ok()
    });
    let list = poses.flatten().ok_or_else(|| {
        let kind = value.get_type();
        invalid(format!(
            "expected a Pose, Poses or a list of them, not {kind}"
        ))
    })?;
    let count = list.len();
    Ok((list, Some(count)))
}
