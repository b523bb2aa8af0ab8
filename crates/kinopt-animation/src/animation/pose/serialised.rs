//! Serde forms of armatures and poses, checked when read.

use glam::{Affine3A, Quat, Vec3A};
use serde::{Deserialize, Serialize};

use super::{Armature, ArmatureBone, LocalTransform, Pose};
use crate::animation::ClipError;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::skeleton::BoneId;

#[derive(Deserialize)]
pub(super) struct PoseParts {
    translations: Vec<Vec3A>,
    rotations: Vec<Quat>,
    scales: Vec<Vec3A>,
    morph_weights: Vec<f32>,
}

impl TryFrom<PoseParts> for Pose {
    type Error = ClipError;

    fn try_from(parts: PoseParts) -> Result<Self, ClipError> {
        let bones = parts.rotations.len();
        SizeMismatch::check("translations", parts.translations.len(), bones)?;
        SizeMismatch::check("scales", parts.scales.len(), bones)?;
        let pose = Self {
            translations: parts.translations,
            rotations: parts.rotations,
            scales: parts.scales,
            morph_weights: parts.morph_weights,
        };
        let is_invalid = |bone: &usize| !pose.local_of(BoneId::new(*bone)).is_valid();
        match (0..bones).find(is_invalid) {
            Some(bone) => Err(ClipError::NonFiniteTransform { bone }),
            None => Ok(pose),
        }
    }
}

#[derive(Serialize, Deserialize)]
pub(super) struct ArmatureParts {
    names: Vec<String>,
    parents: Vec<Option<usize>>,
    rest: Pose,
    morph_targets: Vec<String>,
    /// Stored, because a skeleton's armature computes it in double precision.
    rest_from_model: Vec<Affine3A>,
}

impl From<Armature> for ArmatureParts {
    fn from(armature: Armature) -> Self {
        let parents = armature.parents.iter();
        Self {
            parents: parents
                .map(|&parent| usize::try_from(parent).ok())
                .collect(),
            names: armature.names,
            rest: armature.rest,
            morph_targets: armature.morph_targets,
            rest_from_model: armature.rest_from_model,
        }
    }
}

impl TryFrom<ArmatureParts> for Armature {
    type Error = ClipError;

    fn try_from(parts: ArmatureParts) -> Result<Self, ClipError> {
        let bones = parts.names.len();
        SizeMismatch::check("parents", parts.parents.len(), bones)?;
        SizeMismatch::check("bones in the rest pose", parts.rest.bones(), bones)?;
        SizeMismatch::check("inverses", parts.rest_from_model.len(), bones)?;
        let names = parts.names.into_iter().zip(parts.parents);
        let listed = names.enumerate().map(|(index, (name, parent))| {
            let rest: LocalTransform = parts.rest.local_of(BoneId::new(index));
            ArmatureBone { name, parent, rest }
        });
        let mut armature = Self::new(listed.collect(), parts.morph_targets)?
            .with_rest_morph_weights(&parts.rest.morph_weights)?;
        armature.rest_from_model = parts.rest_from_model;
        Ok(armature)
    }
}
