//! What moves as one, and what is next to each other.

use crate::model::{FrameId, JointId, Model};

/// The joint that moves a frame: the first moving one above it; `None` for what stands in the world.
pub(crate) fn carrier(model: &Model, frame: FrameId) -> Option<JointId> {
    moving(model, model.frames()[frame.index()].joint)
}

fn moving(model: &Model, mut joint: Option<JointId>) -> Option<JointId> {
    while let Some(id) = joint {
        let own = &model.joints()[id.index()];
        if own.moves() {
            return Some(id);
        }
        joint = own.parent;
    }
    None
}

/// All pairs of links but those of one body and of adjacent ones: no body with shapes is between those.
pub(crate) fn pairs_apart(model: &Model, links: &[FrameId]) -> Vec<[FrameId; 2]> {
    let carriers: Vec<Option<JointId>> = links.iter().map(|l| carrier(model, *l)).collect();
    // The next body towards the root that has shapes; `None` where there is none.
    let next = |body: Option<JointId>| {
        let mut body = moving(model, model.joints()[body?.index()].parent);
        while !carriers.contains(&body) {
            body = moving(model, model.joints()[body?.index()].parent);
        }
        Some(body)
    };
    let above: Vec<Option<Option<JointId>>> = carriers.iter().map(|body| next(*body)).collect();
    let mut pairs = Vec::new();
    for a in 0..links.len() {
        for b in a + 1..links.len() {
            let one_body = carriers[a] == carriers[b];
            let adjacent = above[a] == Some(carriers[b]) || above[b] == Some(carriers[a]);
            if !one_body && !adjacent {
                pairs.push([links[a], links[b]]);
            }
        }
    }
    pairs
}
