//! Bones into the document.

use gltf_json::Index;
use gltf_json::scene::{Node, UnitQuaternion};

use crate::animation::Armature;
use crate::skeleton::BoneId;

/// The armature's bones as nodes, with their rest pose.
pub(super) fn of(armature: &Armature) -> Vec<Node> {
    let mut nodes = Vec::with_capacity(armature.bones());
    let mut children: Vec<Vec<Index<Node>>> = vec![Vec::new(); armature.bones()];
    for (index, name) in armature.names().iter().enumerate() {
        let bone = BoneId::new(index);
        if let Some(siblings) = armature
            .parent(bone)
            .and_then(|p| children.get_mut(p.index()))
        {
            siblings.push(Index::new(index as u32));
        }
        let rest = armature.rest().local_of(bone);
        nodes.push(Node {
            name: Some(name.clone()),
            translation: Some(rest.translation.to_array()),
            rotation: Some(UnitQuaternion(rest.rotation.to_array())),
            scale: Some(rest.scale.to_array()),
            ..Node::default()
        });
    }
    for (node, children) in nodes.iter_mut().zip(children) {
        node.children = (!children.is_empty()).then_some(children);
    }
    nodes
}
