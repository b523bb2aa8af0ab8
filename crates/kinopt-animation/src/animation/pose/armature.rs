//! Armatures: bone names, parents and rest pose.

use std::collections::BTreeSet;

use glam::{Affine3A, Quat, Vec3A};

use super::{LocalTransform, Pose};
use crate::animation::ClipError;
use kinopt_kinematics::Buffer;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::model::UnknownName;
use kinopt_kinematics::skeleton::{BoneId, Skeleton};
use kinopt_kinematics::spatial::{Placement, Quaternion};
use kinopt_mesh::mesh::single_precision;

/// One bone of an armature.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmatureBone {
    /// Unique within the armature.
    pub name: String,
    /// Index of the parent, which precedes this bone; `None` for a root.
    pub parent: Option<usize>,
    /// Transform in the parent at rest.
    pub rest: LocalTransform,
}

/// Tree of bones, parents before children, with rest pose and morph target names, in single precision.
///
/// Clips and skins use an armature, tasks use a [`Skeleton`]. [`skeleton`](Self::skeleton) converts an armature to a
/// skeleton, and [`of_skeleton`](Self::of_skeleton) a skeleton to an armature. Both keep the bone ids.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        try_from = "super::serialised::ArmatureParts",
        into = "super::serialised::ArmatureParts"
    )
)]
pub struct Armature {
    pub(super) names: Vec<String>,
    pub(super) parents: Vec<i32>,
    pub(super) morph_targets: Vec<String>,
    pub(super) rest: Pose,
    pub(super) rest_from_model: Vec<Affine3A>,
}

impl Armature {
    /// Checks bones and morph target names and builds an armature.
    ///
    /// # Errors
    /// An [`ClipError`] with the name of the bone.
    pub fn new(bones: Vec<ArmatureBone>, morph_targets: Vec<String>) -> Result<Self, ClipError> {
        let (given, most) = (bones.len(), i32::MAX as usize);
        if given > most {
            return Err(ClipError::TooManyBones { given, most });
        }
        let mut seen = BTreeSet::new();
        for (index, bone) in bones.iter().enumerate() {
            let name = || bone.name.clone();
            if bone.parent.is_some_and(|parent| parent >= index) {
                return Err(ClipError::ParentNotBefore { bone: name() });
            }
            if !bone.rest.is_valid() {
                return Err(ClipError::BadRest { bone: name() });
            }
            if !seen.insert(bone.name.as_str()) {
                let (kind, name) = ("bone", name());
                return Err(ClipError::DuplicateName { kind, name });
            }
        }
        check_targets(&morph_targets)?;
        let locals: Vec<LocalTransform> = bones.iter().map(|bone| bone.rest).collect();
        let parents = bones.iter().map(|b| b.parent.map_or(-1, |p| p as i32));
        let armature = Self {
            parents: parents.collect(),
            rest: Pose::new(&locals, morph_targets.len()),
            rest_from_model: vec![Affine3A::IDENTITY; bones.len()],
            names: bones.into_iter().map(|bone| bone.name).collect(),
            morph_targets,
        };
        Ok(armature.with_inverses())
    }

    /// The armature with these morph target weights at rest; the default is zero.
    ///
    /// # Errors
    /// The number of weights is not the number of morph targets.
    pub fn with_rest_morph_weights(mut self, weights: &[f32]) -> Result<Self, SizeMismatch> {
        let targets = self.morph_targets.len();
        SizeMismatch::check("morph weights", weights.len(), targets)?;
        self.rest.morph_weights.copy_from_slice(weights);
        Ok(self)
    }

    /// The armature with `pose` as rest pose. A [`skeleton`](Self::skeleton) of the result then starts from that pose.
    ///
    /// # Errors
    /// The pose is not of this armature's size.
    pub fn at_rest_in(mut self, pose: &Pose) -> Result<Self, SizeMismatch> {
        self.rest.check_same_size(pose)?;
        self.rest.copy_from(pose);
        Ok(self.with_inverses())
    }

    /// Appends a root at the origin. If a bone has the name already, the new name gets a suffix.
    #[cfg(feature = "gltf")]
    #[doc(hidden)]
    pub fn with_root(mut self, name: &str) -> (Self, BoneId) {
        let mut name = name.to_owned();
        while self.names.contains(&name) {
            name.push('\'');
        }
        let root = BoneId::new(self.names.len());
        self.names.push(name);
        self.parents.push(-1);
        self.rest.push(LocalTransform::IDENTITY);
        self.rest_from_model.push(Affine3A::IDENTITY);
        (self, root)
    }

    /// Computes the inverse model transforms of the rest pose.
    pub(super) fn with_inverses(mut self) -> Self {
        let mut model_from_rest = self.rest_from_model.clone();
        self.propagate(&self.rest, &mut model_from_rest);
        for (inverse, placement) in self.rest_from_model.iter_mut().zip(&model_from_rest) {
            *inverse = placement.inverse();
        }
        self
    }

    /// Armature of a skeleton, with the same bone ids. The rest pose is the one at zero angles. Add morph targets with
    /// [`with_morph_targets`](Self::with_morph_targets).
    #[must_use]
    pub fn of_skeleton(skeleton: &Skeleton) -> Self {
        let bones = skeleton.bones();
        let mut locals = Vec::with_capacity(bones.len());
        let mut parents = Vec::with_capacity(bones.len());
        for bone in bones {
            let parent = bone.parent.map(BoneId::index);
            let placed = match parent.and_then(|index| bones.get(index)) {
                Some(parent) => parent.model_from_rest.inverse() * bone.model_from_rest,
                None => bone.model_from_rest,
            };
            parents.push(parent.map_or(-1, |parent| parent as i32));
            locals.push(local(&placed));
        }
        let inverses = bones.iter().map(|b| affine(&b.model_from_rest.inverse()));
        Self {
            names: bones.iter().map(|bone| bone.name.clone()).collect(),
            parents,
            morph_targets: Vec::new(),
            rest: Pose::new(&locals, 0),
            rest_from_model: inverses.collect(),
        }
    }

    /// The armature with other morph targets, with weight zero at rest. Use it for a skeleton's armature, which has
    /// none. Create clips and poses afterwards.
    ///
    /// # Errors
    /// Two targets share a name.
    pub fn with_morph_targets(mut self, names: Vec<String>) -> Result<Self, ClipError> {
        check_targets(&names)?;
        self.rest.morph_weights = vec![0.0; names.len()];
        self.morph_targets = names;
        Ok(self)
    }

    /// Number of bones.
    #[must_use]
    pub fn bones(&self) -> usize {
        self.names.len()
    }

    /// Bone names, by index.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Morph target names, by index.
    #[must_use]
    pub fn morph_targets(&self) -> &[String] {
        &self.morph_targets
    }

    /// Rest pose; morph weights are zero unless [set](Self::with_rest_morph_weights).
    #[must_use]
    pub fn rest(&self) -> &Pose {
        &self.rest
    }

    /// Inverse model transforms of the bones at rest: from the model to each bone. The inverse bind matrices of a
    /// glTF skin belong to the skin and can differ.
    #[must_use]
    pub fn rest_from_model(&self) -> &[Affine3A] {
        &self.rest_from_model
    }

    /// Finds a bone by name.
    ///
    /// # Errors
    /// The name is unknown; the error lists the valid names.
    pub fn bone(&self, name: &str) -> Result<BoneId, UnknownName> {
        find("bone", &self.names, name).map(BoneId::new)
    }

    /// Finds the index of a morph target by name.
    ///
    /// # Errors
    /// The name is unknown; the error lists the valid names.
    pub fn morph_target(&self, name: &str) -> Result<usize, UnknownName> {
        find("morph target", &self.morph_targets, name)
    }

    /// All bone ids in order.
    pub fn bone_ids(&self) -> impl Iterator<Item = BoneId> + use<> {
        (0..self.bones()).map(BoneId::new)
    }

    /// Bone id of an index; `None` if it is out of range.
    #[must_use]
    pub fn bone_at(&self, index: usize) -> Option<BoneId> {
        (index < self.bones()).then(|| BoneId::new(index))
    }

    /// Parent of a bone; `None` for a root.
    #[must_use]
    pub fn parent(&self, bone: BoneId) -> Option<BoneId> {
        let parent = *self.parents.get(bone.index())?;
        usize::try_from(parent).ok().map(BoneId::new)
    }

    /// Computes model transforms from local transforms: W_j = W_parent(j) L_j. `model_from_bone` has one element for
    /// each bone; a `Vec` is resized. Its previous contents are ignored.
    ///
    /// # Errors
    /// The pose or a slice is not of this armature's size.
    pub fn local_to_model(
        &self,
        pose: &Pose,
        model_from_bone: &mut (impl Buffer<Affine3A> + ?Sized),
    ) -> Result<(), SizeMismatch> {
        let model_from_bone = model_from_bone.sized(self.bones());
        SizeMismatch::check("bones in the pose", pose.bones(), self.bones())?;
        SizeMismatch::check("model transforms", model_from_bone.len(), self.bones())?;
        self.propagate(pose, model_from_bone);
        Ok(())
    }

    /// Computes the skinning matrices S_j = W_j B_j⁻¹ of model transforms, from the rest pose to the posed model.
    /// `posed_from_rest` has one element for each bone; a `Vec` is resized.
    ///
    /// # Errors
    /// A slice is not of this armature's size.
    pub fn skinning_transforms(
        &self,
        model_from_bone: &[Affine3A],
        posed_from_rest: &mut (impl Buffer<Affine3A> + ?Sized),
    ) -> Result<(), SizeMismatch> {
        let posed_from_rest = posed_from_rest.sized(self.bones());
        SizeMismatch::check("model transforms", model_from_bone.len(), self.bones())?;
        SizeMismatch::check("skinning transforms", posed_from_rest.len(), self.bones())?;
        let bones = model_from_bone.iter().zip(&self.rest_from_model);
        for (skinning, (posed, inverse)) in posed_from_rest.iter_mut().zip(bones) {
            *skinning = *posed * *inverse;
        }
        Ok(())
    }

    /// [`local_to_model`](Self::local_to_model) for sizes already checked.
    fn propagate(&self, pose: &Pose, model_from_bone: &mut [Affine3A]) {
        // Slices of equal length remove the bounds checks of the loop.
        let bones = self.parents.len().min(model_from_bone.len());
        let parents = &self.parents[..bones];
        let translations = &pose.translations[..bones];
        let rotations = &pose.rotations[..bones];
        let scales = &pose.scales[..bones];
        for index in 0..bones {
            let local = LocalTransform {
                translation: translations[index],
                rotation: rotations[index],
                scale: scales[index],
            };
            let parent_from_bone = local.to_affine();
            model_from_bone[index] = match usize::try_from(parents[index]) {
                Ok(parent) => model_from_bone[parent] * parent_from_bone,
                Err(_) => parent_from_bone,
            };
        }
    }
}

/// Returns an error if two morph targets share a name.
fn check_targets(names: &[String]) -> Result<(), ClipError> {
    let mut seen = BTreeSet::new();
    match names.iter().find(|name| !seen.insert(name.as_str())) {
        Some(name) => Err(ClipError::DuplicateName {
            kind: "morph target",
            name: name.clone(),
        }),
        None => Ok(()),
    }
}

fn find(kind: &'static str, names: &[String], name: &str) -> Result<usize, UnknownName> {
    let position = names.iter().position(|candidate| candidate == name);
    position.ok_or_else(|| UnknownName::new(kind, name, names.iter().map(String::as_str)))
}

/// A rigid placement in single precision.
fn local(placed: &Placement<f64>) -> LocalTransform {
    let Quaternion { w, v } = Quaternion::from_matrix(&placed.rotation);
    let rotation = Quat::from_xyzw(v.x as f32, v.y as f32, v.z as f32, w as f32);
    LocalTransform {
        translation: Vec3A::from(single_precision(placed.translation)),
        rotation: rotation.normalize(),
        scale: Vec3A::ONE,
    }
}

fn affine(placed: &Placement<f64>) -> Affine3A {
    local(placed).to_affine()
}
