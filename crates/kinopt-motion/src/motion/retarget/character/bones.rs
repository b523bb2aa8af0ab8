//! Bones of a character, with z up.

use glam::{DMat3, DQuat, DVec3};

use kinopt_kinematics::model::Limits;
use kinopt_kinematics::skeleton::Skeleton;
use kinopt_kinematics::spatial::Vector3;

/// Bone of a character at rest.
#[derive(Clone, Debug)]
pub(super) struct CharacterBone {
    pub(super) name: String,
    pub(super) parent: Option<usize>,
    /// Rotation from the bone to the world.
    pub(super) rest: DQuat,
    /// Position of the tail in the world.
    pub(super) position: DVec3,
    /// Rotation from the bone to its parent.
    pub(super) local: DQuat,
    /// Position of the tail in the parent's axes; in the world for a root.
    pub(super) offset: DVec3,
    pub(super) limits: [Limits; 3],
}

impl CharacterBone {
    /// Returns whether the bone can rotate.
    pub(super) fn moves(&self) -> bool {
        self.limits.iter().any(|limits| limits.upper > limits.lower)
    }

    /// Returns whether the bone can have any rotation.
    pub(super) fn is_unlimited(&self) -> bool {
        self.limits
            .iter()
            .all(|limits| *limits == Limits::UNBOUNDED)
    }
}

/// Returns the bones of a skeleton with z up, parents first, with lengths multiplied by a factor.
pub(super) fn bones_of(skeleton: &Skeleton, scale: f64) -> Vec<CharacterBone> {
    let vector = |v: Vector3<f64>| DVec3::from_array(v.to_array());
    let mut bones: Vec<CharacterBone> = Vec::with_capacity(skeleton.bones().len());
    for bone in skeleton.bones() {
        let rotation = bone.model_from_rest.rotation;
        let [x, y, z] = [rotation.x, rotation.y, rotation.z].map(vector);
        let rest = DQuat::from_mat3(&DMat3::from_cols(x, y, z)).normalize();
        let position = vector(bone.model_from_rest.translation) * scale;
        let parent = bone.parent.map(|parent| parent.index());
        let (above, origin) = match parent.and_then(|parent| bones.get(parent)) {
            Some(parent) => (parent.rest.conjugate(), parent.position),
            None => (DQuat::IDENTITY, DVec3::ZERO),
        };
        bones.push(CharacterBone {
            name: bone.name.clone(),
            parent,
            rest,
            position,
            local: (above * rest).normalize(),
            offset: above * (position - origin),
            limits: bone.limits,
        });
    }
    bones
}
