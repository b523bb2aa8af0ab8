//! Optional members that gltf-json's types require: the nodes of a scene, and the node of an animation channel.

use std::collections::BTreeSet;

use gltf_json::Root;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::{Map, Value};

use crate::io::ReadError;
use crate::json::{parse, parse_by};

/// The parts of a document in which members may be missing.
#[derive(Deserialize)]
struct Outline {
    #[serde(default)]
    scenes: Vec<Scene>,
    #[serde(default)]
    animations: Vec<Animation>,
}

#[derive(Deserialize)]
struct Scene {
    nodes: Option<IgnoredAny>,
}

#[derive(Deserialize)]
struct Animation {
    #[serde(default)]
    channels: Vec<Channel>,
}

#[derive(Deserialize)]
struct Channel {
    target: Option<Target>,
}

#[derive(Deserialize)]
struct Target {
    node: Option<IgnoredAny>,
}

impl Channel {
    fn has_no_node(&self) -> bool {
        let target = self.target.as_ref();
        target.is_some_and(|target| target.node.is_none())
    }
}

/// Channels without a node, as (animation, channel).
pub(super) type Nodeless = BTreeSet<(usize, usize)>;

/// Parses a document with missing members. Scenes without nodes get an empty list. Channels without a node get an
/// arbitrary node and are returned.
pub(super) fn parse_with_omissions(json: &[u8], name: &str) -> Result<(Root, Nodeless), ReadError> {
    // If this fails, parsing the whole document reports the error.
    let outline: Option<Outline> = serde_json::from_slice(json).ok();
    let has_omissions = outline.is_some_and(|outline| {
        let channels = outline
            .animations
            .iter()
            .flat_map(|animation| &animation.channels);
        outline.scenes.iter().any(|scene| scene.nodes.is_none())
            || channels.into_iter().any(Channel::has_no_node)
    });
    if !has_omissions {
        return Ok((parse_by(Root::from_slice, json, name)?, Nodeless::new()));
    }
    let mut document: Map<String, Value> = parse(json, name)?;
    for scene in objects(&mut document, "scenes") {
        scene.entry("nodes").or_insert(Value::Array(Vec::new()));
    }
    let mut nodeless = Nodeless::new();
    for (number, animation) in objects(&mut document, "animations").enumerate() {
        for (channel, object) in objects(animation, "channels").enumerate() {
            let target = object.get_mut("target").and_then(Value::as_object_mut);
            let Some(target) = target.filter(|target| !target.contains_key("node")) else {
                continue;
            };
            target.insert("node".into(), 0.into());
            nodeless.insert((number, channel));
        }
    }
    let completed = Value::Object(document).to_string();
    let root = parse_by(Root::from_slice, completed.as_bytes(), name)?;
    Ok((root, nodeless))
}

/// The objects in a list of a document.
fn objects<'a>(
    document: &'a mut Map<String, Value>,
    list: &str,
) -> impl Iterator<Item = &'a mut Map<String, Value>> {
    let list = document.get_mut(list).and_then(Value::as_array_mut);
    list.into_iter().flatten().filter_map(Value::as_object_mut)
}
