//! Writing of bones as nodes.

use glam::{Quat, Vec3};
use gltf_json::Index;
use gltf_json::scene::{Node, UnitQuaternion};

use super::UnwritableScene;
use crate::animation::Armature;
use kinopt_kinematics::skeleton::BoneId;

/// The bones of an armature as nodes, in their rest pose.
pub(super) fn from_armature(armature: &Armature) -> Vec<Node> {
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

/// A node with the children `roots` that rotates the up axis to y, the up axis of glTF (section 3.4). `None` if the up
/// axis is y.
pub(super) fn up_rotation_node(
    armature: &Armature,
    up: Vec3,
    roots: &[Index<Node>],
) -> Result<Option<Node>, UnwritableScene> {
    let axis = up
        .try_normalize()
        .ok_or(UnwritableScene::BadUp(up.to_array()))?;
    if axis == Vec3::Y || roots.is_empty() {
        return Ok(None);
    }
    let mut name = "up".to_owned();
    while armature.names().contains(&name) {
        name.push('\'');
    }
    let rotation = Quat::from_rotation_arc(axis, Vec3::Y);
    Ok(Some(Node {
        name: Some(name),
        rotation: Some(UnitQuaternion(rotation.to_array())),
        children: Some(roots.to_vec()),
        ..Node::default()
    }))
}
