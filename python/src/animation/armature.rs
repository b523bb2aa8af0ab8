//! Armatures: a tree of bones with their rest pose, and names of morph targets.

use kinopt::animation::{Armature as Bones, ArmatureBone, LocalTransform};
use kinopt::glam::{Affine3A, Quat, Vec3A};
use kinopt::model::Limits;
use numpy::ndarray::Ix3;
use numpy::{PyArray1, PyArrayDyn};
use pyo3::prelude::*;
use pyo3::types::PyType;

use super::bones_and_poses::{Armature, Pose, poses_of};
use crate::arrays::{self, Numbers, shape_text};
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::skeleton::Skeleton;
use crate::transforms::{
    self, Order, one_to_array, quaternion, quaternion_argument, quaternions, shaped, to_array,
    vector, vectors,
};
use crate::vertices::whole;

/// Number of poses between two checks for signals.
const POSES_AT_A_TIME: usize = 256;

impl Armature {
    fn turned(&self, pose: &Bound<'_, Pose>, bone: &str) -> PyResult<Quat> {
        let bone = self.inner.bone(bone).or_raise()?;
        self.inner
            .model_rotation(&pose.get().now(), bone)
            .or_raise()
    }
}

#[pymethods]
impl Armature {
    #[new]
    #[pyo3(signature = (
        names, parents, *, translations = None, rotations_xyzw = None, rotations_wxyz = None, scales = None,
        morph_targets = Vec::new()
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        names: Vec<String>,
        parents: &Bound<'_, PyAny>,
        translations: Option<&Bound<'_, PyAny>>,
        rotations_xyzw: Option<&Bound<'_, PyAny>>,
        rotations_wxyz: Option<&Bound<'_, PyAny>>,
        scales: Option<&Bound<'_, PyAny>>,
        morph_targets: Vec<String>,
    ) -> PyResult<Self> {
        let bones = names.len();
        let parents: Numbers<'_, numpy::ndarray::Ix1, i64> =
            whole(parents, "parents", "one list of indices")?;
        let translations = match translations {
            Some(value) => vectors(value, "translations")?,
            None => vec![Vec3A::ZERO; bones],
        };
        let scales = match scales {
            Some(value) => vectors(value, "scales")?,
            None => vec![Vec3A::ONE; bones],
        };
        let rotations = match quaternion_argument(rotations_xyzw, rotations_wxyz, "rotations")? {
            Some((value, order)) => quaternions(value, order)?,
            None => vec![Quat::IDENTITY; bones],
        };
        let counts = [
            parents.len(),
            translations.len(),
            scales.len(),
            rotations.len(),
        ];
        if counts.iter().any(|&count| count != bones) {
            return Err(invalid(format!(
                "{bones} names, {} parents, {} translations, {} scales and {} rotations",
                counts[0], counts[1], counts[2], counts[3]
            )));
        }
        let listed = names
            .into_iter()
            .enumerate()
            .map(|(index, name)| ArmatureBone {
                name,
                // Keeps every index except -1; one that is too large fails the check of the order.
                parent: (parents[index] != -1)
                    .then(|| usize::try_from(parents[index]).unwrap_or(usize::MAX)),
                rest: LocalTransform {
                    translation: translations[index],
                    rotation: rotations[index],
                    scale: scales[index],
                },
            });
        Bones::new(listed.collect(), morph_targets)
            .or_raise()
            .map(Self::from)
    }

    /// The bones of a skeleton, at rest with all angles zero.
    #[classmethod]
    fn of_skeleton(_class: &Bound<'_, PyType>, skeleton: &Bound<'_, Skeleton>) -> Self {
        Bones::of_skeleton(&skeleton.get().inner).into()
    }

    /// The armature with these morph targets, whose weights are zero at rest.
    ///
    /// Raises `InvalidValueError` for a duplicate name.
    fn with_morph_targets(&self, names: Vec<String>) -> PyResult<Self> {
        let armature = Bones::clone(&self.inner).with_morph_targets(names);
        armature.or_raise().map(Self::from)
    }

    /// The armature with these weights of the morph targets at rest, shape (targets,).
    ///
    /// Raises `InvalidValueError` for another number of weights and for weights that are not finite.
    fn with_rest_morph_weights(&self, weights: &Bound<'_, PyAny>) -> PyResult<Self> {
        let weights = transforms::numbers(weights, "weights", None)?;
        let armature = Bones::clone(&self.inner).with_rest_morph_weights(&weights);
        armature.or_raise().map(Self::from)
    }

    /// The armature with `pose` as its rest pose.
    ///
    /// Raises `InvalidValueError` for a pose of another armature.
    fn at_rest_in(&self, pose: &Bound<'_, Pose>) -> PyResult<Self> {
        let armature = Bones::clone(&self.inner).at_rest_in(&pose.get().now());
        armature.or_raise().map(Self::from)
    }

    /// Number of bones.
    #[getter]
    fn bones(&self) -> usize {
        self.inner.bones()
    }

    /// Names of the bones, in their order.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.inner.names().to_vec()
    }

    /// Index of each bone's parent in `names`, shape (bones,), int64; -1 for roots.
    #[getter]
    fn parents<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let bones = (0..self.inner.bones()).filter_map(|index| self.inner.bone_at(index));
        let parent = |bone| self.inner.parent(bone).map_or(-1, |p| p.index() as i64);
        PyArray1::from_iter(py, bones.map(parent))
    }

    /// Names of the morph targets, in their order.
    #[getter]
    fn morph_targets(&self) -> Vec<String> {
        self.inner.morph_targets().to_vec()
    }

    /// The rest pose, as a new object.
    #[getter]
    fn rest(&self) -> Pose {
        Pose::of(&self.inner, self.inner.rest().clone())
    }

    /// A line for each bone with children whose rest scale a skeleton cannot have. An uneven scale shears the bones
    /// that rotate below it, a negative one mirrors them.
    #[getter]
    fn scale_notes(&self) -> Vec<String> {
        let notes = self.inner.scale_notes();
        notes.iter().map(ToString::to_string).collect()
    }

    /// The same bones with scales of 1 at rest. Translations and rotations in the parents stay, so joints below a
    /// scaled bone move in the model.
    fn without_scale(&self) -> Self {
        Bones::clone(&self.inner).without_scale().into()
    }

    /// Inverse model transforms of the bones at rest: from the model to each bone, shape (bones, 4, 4), float32.
    #[getter]
    fn rest_from_model<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        to_array(py, self.inner.rest_from_model())
    }

    /// Bone transforms in model space: model_from_bone, float32, shape (bones, 4, 4) for a `Pose`, (N, bones, 4, 4) for
    /// `Poses`. `out` receives the result.
    ///
    /// Raises `InvalidValueError` for poses of another armature and for an `out` of another shape or type.
    #[pyo3(signature = (pose, *, out = None))]
    fn local_to_model<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let (poses, count) = poses_of(pose)?;
        let bones = self.inner.bones();
        let shape: Vec<usize> = count.into_iter().chain([bones, 4, 4]).collect();
        let array = arrays::output_array::<f32>(py, out, &shape)?;
        let mut placed: Vec<Affine3A> = Vec::new();
        arrays::fill(&array, |buffer| {
            let pieces = buffer.chunks_mut(POSES_AT_A_TIME * (bones * 16).max(1));
            for (poses, buffer) in poses.chunks(POSES_AT_A_TIME).zip(pieces) {
                py.check_signals()?;
                py.detach(|| {
                    for (pose, buffer) in poses.iter().zip(buffer.chunks_mut((bones * 16).max(1))) {
                        self.inner.local_to_model(pose, &mut placed).or_raise()?;
                        transforms::write(&placed, buffer);
                    }
                    Ok::<(), PyErr>(())
                })?;
            }
            Ok(())
        })?;
        Ok(array)
    }

    /// Skinning matrices of `model_from_bone`, shape (bones, 4, 4) or (N, bones, 4, 4): from the model at rest to the
    /// posed model. The result is float32 of that shape. `out` receives the result.
    ///
    /// Raises `InvalidValueError` for another shape and for an `out` of another shape or type.
    #[pyo3(signature = (model_from_bone, *, out = None))]
    fn skinning_transforms<'py>(
        &self,
        py: Python<'py>,
        model_from_bone: &Bound<'py, PyAny>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let (placed, leading) = transforms::read(model_from_bone, "model_from_bone")?;
        let bones = self.inner.bones();
        match leading.as_slice() {
            [last] | [_, last] if *last == bones => {}
            _ => {
                let shape = shape_text(&[leading.as_slice(), &[4, 4]].concat());
                return Err(invalid(format!(
                    "model_from_bone has shape {shape}, expected ({bones}, 4, 4) or (N, {bones}, 4, 4)"
                )));
            }
        }
        let shape = [leading.as_slice(), &[4, 4]].concat();
        let array = arrays::output_array::<f32>(py, out, &shape)?;
        let mut posed: Vec<Affine3A> = Vec::new();
        arrays::fill(&array, |buffer| {
            py.detach(|| {
                let buffers = buffer.chunks_mut((bones * 16).max(1));
                for (placed, buffer) in placed.chunks(bones.max(1)).zip(buffers) {
                    self.inner
                        .skinning_transforms(placed, &mut posed)
                        .or_raise()?;
                    transforms::write(&posed, buffer);
                }
                Ok(())
            })
        })?;
        Ok(array)
    }

    /// Transform of one bone in model space, shape (4, 4), float32.
    ///
    /// Raises `UnknownNameError` for the bone, `InvalidValueError` for a pose of another armature.
    fn model_from_bone<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, Pose>,
        bone: &str,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let bone = self.inner.bone(bone).or_raise()?;
        let placed = self.inner.model_from_bone(&pose.get().now(), bone);
        one_to_array(py, &placed.or_raise()?)
    }

    /// Rotation of one bone in model space, shape (4,), float32: x, y, z, w; without scale.
    ///
    /// Raises as `model_from_bone`.
    fn model_rotation_xyzw<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, Pose>,
        bone: &str,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let q = self.turned(pose, bone)?;
        shaped(py, Order::Xyzw.to_array(q).to_vec(), &[4])
    }

    /// Rotation of one bone in model space, shape (4,), float32: w, x, y, z; without scale.
    ///
    /// Raises as `model_from_bone`.
    fn model_rotation_wxyz<'py>(
        &self,
        py: Python<'py>,
        pose: &Bound<'py, Pose>,
        bone: &str,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let q = self.turned(pose, bone)?;
        shaped(py, Order::Wxyz.to_array(q).to_vec(), &[4])
    }

    /// Sets the model-space transform of a bone of `pose`, 4 x 4. Its ancestors stay, its descendants move along.
    ///
    /// Raises `InvalidValueError` if the bone would have to shear.
    fn set_model_from_bone(
        &self,
        pose: &Bound<'_, Pose>,
        bone: &str,
        model_from_bone: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let bone = self.inner.bone(bone).or_raise()?;
        let placed = transforms::read_one(model_from_bone, "model_from_bone")?;
        let set = |locals: &mut _| self.inner.set_model_from_bone(locals, bone, placed);
        pose.get().with(set).or_raise()
    }

    /// Sets the model-space rotation of a bone of `pose` by a quaternion of shape (4,). It is x, y, z, w as `xyzw`, or
    /// w, x, y, z as `wxyz`. Its local translation and scale stay.
    ///
    /// Raises `UnknownNameError` for the bone, `InvalidValueError` for a quaternion of length 0, and as
    /// `set_model_from_bone`.
    #[pyo3(signature = (pose, bone, *, xyzw = None, wxyz = None))]
    fn set_model_rotation(
        &self,
        pose: &Bound<'_, Pose>,
        bone: &str,
        xyzw: Option<&Bound<'_, PyAny>>,
        wxyz: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let bone = self.inner.bone(bone).or_raise()?;
        let (q, order) = quaternion_argument(xyzw, wxyz, "rotations")?
            .ok_or_else(|| invalid("a rotation is given as xyzw or as wxyz"))?;
        let q = quaternion(q, order)?;
        let set = |locals: &mut _| self.inner.set_model_rotation(locals, bone, q);
        pose.get().with(set).or_raise()
    }

    /// Sets the model-space position of a bone of `pose`, shape (3,); its rotation and scale stay.
    ///
    /// Raises `UnknownNameError` for the bone, `InvalidValueError` for numbers that are not finite, and as
    /// `set_model_from_bone`.
    fn set_model_translation(
        &self,
        pose: &Bound<'_, Pose>,
        bone: &str,
        origin: &Bound<'_, PyAny>,
    ) -> PyResult<()> {
        let bone = self.inner.bone(bone).or_raise()?;
        let origin = vector(origin, "origin")?;
        let set = |locals: &mut _| self.inner.set_model_translation(locals, bone, origin);
        pose.get().with(set).or_raise()
    }

    /// The skeleton of these bones and their rest pose, for problems and `ReachLayer`. `EulerPoseMap(skeleton,
    /// armature)` converts its configurations to poses. `limits`, shape (bones, 3, 2), are the ranges of first twist,
    /// bend and second twist about the bone's own x, z and x, radians (None: no limits). Bones have length zero: the
    /// tip of a bone is at its tail, the origin of its node.
    ///
    /// Scales of the rest pose are part of the bones' lengths, and mirrored bones rotate as the armature's do. Below a
    /// bone with an uneven scale the armature shears and the skeleton does not. `scale_notes` names those bones,
    /// `ReachLayer` and `Clip.with_ik` solve for the joints of the armature, and `without_scale` drops the scales.
    ///
    /// Raises `InvalidValueError` for limits of another shape or out of order.
    #[pyo3(signature = (name = "armature", limits = None))]
    fn skeleton(&self, name: &str, limits: Option<&Bound<'_, PyAny>>) -> PyResult<Skeleton> {
        let bones = self.inner.bones();
        let mut ranges = vec![[Limits::UNBOUNDED; 3]; bones];
        if let Some(limits) = limits {
            let numbers: Numbers<'_, Ix3> = arrays::numbers(limits, "limits", "(bones, 3, 2)")?;
            if numbers.shape() != [bones, 3, 2] {
                return Err(invalid(format!(
                    "limits has shape {}, expected ({bones}, 3, 2)",
                    shape_text(numbers.shape())
                )));
            }
            let rows = numbers.chunks_exact(2);
            for (range, row) in ranges.iter_mut().flatten().zip(rows) {
                *range = Limits::new(row[0], row[1]);
            }
        }
        let limits = |bone: kinopt::skeleton::BoneId| ranges[bone.index()];
        self.inner
            .skeleton(name, limits)
            .or_raise()
            .map(Skeleton::from)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = serde_json::to_string(&*self.inner).or_raise()?;
        pickling::by_rebuild::<Self>(py, (text,))
    }

    #[staticmethod]
    fn _rebuild(text: &str) -> PyResult<Self> {
        serde_json::from_str::<Bones>(text)
            .or_raise()
            .map(Self::from)
    }

    fn __repr__(&self) -> String {
        format!(
            "Armature({} bones, {} morph targets)",
            self.inner.bones(),
            self.inner.morph_targets().len()
        )
    }
}
