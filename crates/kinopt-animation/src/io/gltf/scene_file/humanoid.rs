//! Human bones of VRM characters.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::SceneFile;

/// `extensions` with the humanoid of VRM 1 and VRM 0.
#[derive(Deserialize)]
struct HumanoidExtensions {
    #[serde(rename = "VRMC_vrm")]
    first: Option<Vrm<BTreeMap<String, HumanoidNode>>>,
    #[serde(rename = "VRM")]
    zeroth: Option<Vrm<Vec<NamedNode>>>,
}

#[derive(Deserialize)]
struct Vrm<T> {
    humanoid: Option<Humanoid<T>>,
}

#[derive(Deserialize)]
struct Humanoid<T> {
    #[serde(rename = "humanBones")]
    bones: T,
}

#[derive(Deserialize)]
struct HumanoidNode {
    node: usize,
}

#[derive(Deserialize)]
struct NamedNode {
    bone: String,
    node: usize,
}

impl SceneFile {
    /// Returns the name of the bone of each human bone (`hips`, `leftUpperArm`) of a VRM character, by `VRMC_vrm`
    /// (VRM 1) or `VRM` (VRM 0). Other files, and invalid extensions, have none.
    #[must_use]
    pub fn human_bones(&self) -> BTreeMap<String, String> {
        let extensions = self.document.get("extensions");
        let extensions = extensions.and_then(|text| serde_json::from_str(text.get()).ok());
        let Some(HumanoidExtensions { first, zeroth }) = extensions else {
            return BTreeMap::new();
        };
        let first = first
            .and_then(|vrm| vrm.humanoid)
            .map(|humanoid| humanoid.bones);
        let zeroth = zeroth
            .and_then(|vrm| vrm.humanoid)
            .map(|humanoid| humanoid.bones);
        let nodes: Vec<(String, usize)> = match (first, zeroth) {
            (Some(bones), _) => bones
                .into_iter()
                .map(|(bone, node)| (bone, node.node))
                .collect(),
            (None, Some(bones)) => bones
                .into_iter()
                .map(|named| (named.bone, named.node))
                .collect(),
            (None, None) => Vec::new(),
        };
        let names = self.scene.armature.names();
        let named = nodes.into_iter().filter_map(|(human, node)| {
            let bone = self.bone_of.get(node)?;
            Some((human, names.get(bone.index())?.clone()))
        });
        named.collect()
    }
}
