//! Scenes: armature, meshes, skins and clips of a glTF file.

use std::collections::BTreeSet;

use glam::{Affine3A, Vec4};

use super::Note;
use crate::animation::{Armature, Clip};
use crate::skinning::{MorphTargets, SkinWeights};
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::skeleton::BoneId;
use kinopt_mesh::mesh::TriangleMesh;

/// An armature with meshes and clips.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Bones of all nodes of the file, and the morph targets of all meshes. The rest pose is that of the nodes and may
    /// differ from the bind pose of skins.
    pub armature: Armature,
    /// Meshes, each with its bone.
    pub meshes: Vec<SceneMesh>,
    /// Animations.
    pub clips: Vec<Clip>,
    /// Changes and omissions of the reader; ignored by the writer.
    pub notes: Vec<Note>,
}

impl Scene {
    /// The bones that may rotate, in their order: the joints of all skins, or all bones of a scene without skins.
    #[must_use]
    pub fn turning_bones(&self) -> BTreeSet<BoneId> {
        let skins = self.meshes.iter().filter_map(|mesh| mesh.skin.as_ref());
        let turning: BTreeSet<BoneId> = skins.flat_map(|skin| &skin.joints).copied().collect();
        match turning.is_empty() {
            true => self.armature.bone_ids().collect(),
            false => turning,
        }
    }
}

/// A mesh on a bone.
#[derive(Clone, Debug, PartialEq)]
pub struct SceneMesh {
    /// Name; need not be unique.
    pub name: String,
    /// Bone of the mesh. A mesh without a skin moves with it. A mesh with a skin moves with the skin's joints only.
    pub bone: BoneId,
    /// The mesh at rest: in the frame of the bone, or for a skin in the frame from which [`Skin::joint_from_mesh`]
    /// maps.
    pub mesh: TriangleMesh,
    /// Empty, or one per vertex: x, y, z and the sign of the bitangent.
    pub tangents: Vec<Vec4>,
    /// Morph targets; may be empty.
    pub morph_targets: MorphTargets,
    /// Index of its first morph weight in the armature's morph weights.
    pub first_morph_weight: usize,
    /// Skin, if the mesh has one.
    pub skin: Option<Skin>,
}

/// Binding of a mesh to joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    /// Name; may be empty.
    pub name: String,
    /// Bones that are its joints, in the order of the bones of `weights`.
    pub joints: Vec<BoneId>,
    /// Inverse bind matrix B_j⁻¹ of each joint: mesh → joint in the bind pose, as the file states it. A vertex moves by
    /// Σ_j w_j W_j B_j⁻¹.
    pub joint_from_mesh: Vec<Affine3A>,
    /// Weight of each joint on each vertex.
    pub weights: SkinWeights,
}

/// Error for parts of a scene that do not match.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("mesh `{mesh}`: {problem}")]
#[non_exhaustive]
pub struct SceneError {
    /// Name of the mesh.
    pub mesh: String,
    /// The part and its sizes: tangents, vertices with weights and so on.
    #[source]
    pub problem: SizeMismatch,
}

impl SceneMesh {
    /// Indices of its morph weights in the armature's morph weights.
    pub(super) fn morph_weights(&self) -> std::ops::Range<usize> {
        let first = self.first_morph_weight;
        first..first.saturating_add(self.morph_targets.targets().len())
    }

    /// Checks that its parts match in size and exist in the armature.
    pub(super) fn check(&self, armature: &Armature) -> Result<(), SceneError> {
        let check_count = |what, given, expected| {
            let mesh = || self.name.clone();
            let checked = SizeMismatch::check(what, given, expected);
            checked.map_err(|problem| SceneError {
                mesh: mesh(),
                problem,
            })
        };
        let exists =
            |bone: BoneId| check_count("bones at least", armature.bones(), bone.index() + 1);
        let vertices = self.mesh.positions().len();
        if !self.tangents.is_empty() {
            check_count("tangents", self.tangents.len(), vertices)?;
        }
        if !self.morph_targets.targets().is_empty() {
            let target_vertices = self.morph_targets.vertex_count();
            check_count("vertices of morph targets", target_vertices, vertices)?;
            let (last, target_count) = (self.morph_weights().end, armature.morph_targets().len());
            check_count(
                "morph targets in the armature",
                target_count,
                last.max(target_count),
            )?;
        }
        if armature.bone_at(self.bone.index()).is_none() {
            exists(self.bone)?;
        }
        let Some(skin) = &self.skin else {
            return Ok(());
        };
        let (joints, joint_from_mesh) = (skin.joints.len(), &skin.joint_from_mesh);
        check_count("inverse bind matrices", joint_from_mesh.len(), joints)?;
        let finite = joint_from_mesh.iter().filter(|m| m.is_finite()).count();
        check_count(
            "finite inverse bind matrices",
            finite,
            joint_from_mesh.len(),
        )?;
        let weights = &skin.weights;
        check_count("bones in the weights", weights.bone_count(), joints)?;
        check_count("vertices with weights", weights.vertex_count(), vertices)?;
        let unknown_joint = skin
            .joints
            .iter()
            .find(|joint| armature.bone_at(joint.index()).is_none());
        unknown_joint.map_or(Ok(()), |joint| exists(*joint))
    }
}
