//! What a glTF file holds that can be posed.

use std::collections::BTreeSet;

use glam::{Affine3A, Vec4};

use super::Note;
use crate::SizeMismatch;
use crate::animation::{Armature, Clip};
use crate::mesh::TriangleMesh;
use crate::skeleton::BoneId;
use crate::skinning::{MorphTargets, SkinWeights};

/// An armature with the meshes that hang on it and the clips that move it.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Every node of the file as a bone, so that whatever is animated can be, and the morph targets
    /// of all meshes. The rest pose is that of the nodes; it need not be the one that skins were
    /// bound in.
    pub armature: Armature,
    /// The meshes, by the node they hang on.
    pub meshes: Vec<SceneMesh>,
    /// The animations.
    pub clips: Vec<Clip>,
    /// What reading changed or left out; not looked at by writing.
    pub notes: Vec<Note>,
}

impl Scene {
    /// The bones that a figure of this scene turns, in their order: the joints of its skins, or all bones where there
    /// is no skin.
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
    /// Its name; need not be unique.
    pub name: String,
    /// The bone it hangs on. One without a skin moves with it; one with a skin moves with the skin's
    /// joints alone.
    pub bone: BoneId,
    /// The mesh as modelled: in the bone's own coordinates, or for a skin in those that
    /// [`Skin::joint_from_mesh`] starts from.
    pub mesh: TriangleMesh,
    /// Empty, or one for each vertex: x, y, z and the bitangent's sign.
    pub tangents: Vec<Vec4>,
    /// Its morph targets; none for most meshes.
    pub morph_targets: MorphTargets,
    /// Where the weights of its morph targets start in those of the armature.
    pub first_morph_weight: usize,
    /// How it follows joints.
    pub skin: Option<Skin>,
}

/// How a mesh follows joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Skin {
    /// Its name; may be empty.
    pub name: String,
    /// The bones that are its joints, in the order of the weights' bones.
    pub joints: Vec<BoneId>,
    /// For each joint the inverse bind matrix B_j⁻¹: mesh → joint when the two were bound, as
    /// given. A vertex follows Σ_j w_j W_j B_j⁻¹.
    pub joint_from_mesh: Vec<Affine3A>,
    /// How strongly each joint moves each vertex.
    pub weights: SkinWeights,
}

/// Parts of a scene that do not go together.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("mesh `{mesh}`: {problem}")]
#[non_exhaustive]
pub struct SceneError {
    /// The mesh.
    pub mesh: String,
    /// Tangents, vertices with weights, …
    #[source]
    pub problem: SizeMismatch,
}

impl SceneMesh {
    /// The places of its morph targets' weights in those of the armature.
    pub(super) fn morph_weights(&self) -> std::ops::Range<usize> {
        let first = self.first_morph_weight;
        first..first.saturating_add(self.morph_targets.targets().len())
    }

    /// Checks that its parts are of one size and exist in the armature.
    pub(super) fn check(&self, armature: &Armature) -> Result<(), SceneError> {
        let same = |what, given, expected| {
            let mesh = || self.name.clone();
            let checked = SizeMismatch::check(what, given, expected);
            checked.map_err(|problem| SceneError {
                mesh: mesh(),
                problem,
            })
        };
        let exists = |bone: BoneId| same("bones at least", armature.bones(), bone.index() + 1);
        let vertices = self.mesh.positions().len();
        if !self.tangents.is_empty() {
            same("tangents", self.tangents.len(), vertices)?;
        }
        if !self.morph_targets.targets().is_empty() {
            let own = self.morph_targets.vertex_count();
            same("vertices of morph targets", own, vertices)?;
            let (last, all) = (self.morph_weights().end, armature.morph_targets().len());
            same("morph targets in the armature", all, last.max(all))?;
        }
        if armature.bone_at(self.bone.index()).is_none() {
            exists(self.bone)?;
        }
        let Some(skin) = &self.skin else {
            return Ok(());
        };
        let (joints, bound) = (skin.joints.len(), &skin.joint_from_mesh);
        same("inverse bind matrices", bound.len(), joints)?;
        let finite = bound.iter().filter(|m| m.is_finite()).count();
        same("finite inverse bind matrices", finite, bound.len())?;
        let weights = &skin.weights;
        same("bones in the weights", weights.bone_count(), joints)?;
        same("vertices with weights", weights.vertex_count(), vertices)?;
        let beyond = skin
            .joints
            .iter()
            .find(|joint| armature.bone_at(joint.index()).is_none());
        beyond.map_or(Ok(()), |joint| exists(*joint))
    }
}
