//! Bodies and their adjacency.

use kinopt_kinematics::model::{FrameId, JointId, Model};

/// The joint that moves a frame: its first moving ancestor; `None` for a fixed frame.
pub(crate) fn carrier(model: &Model, frame: FrameId) -> Option<JointId> {
    moving_ancestor(model, model.frames()[frame.index()].joint)
}

fn moving_ancestor(model: &Model, mut joint: Option<JointId>) -> Option<JointId> {
    while let Some(id) = joint {
        let ancestor = &model.joints()[id.index()];
        if ancestor.moves() {
            return Some(id);
        }
        joint = ancestor.parent;
    }
    None
}

/// Bodies of the links with shapes, by link index: the body of each link, and the next body towards the root.
///
/// A body is the set of frames that move with one joint. Joints without frames, as all but the last of a free joint,
/// form no body.
pub(crate) struct Bodies {
    carriers: Vec<Option<JointId>>,
    /// `None` for the fixed body, which has no body above it.
    parents: Vec<Option<Option<JointId>>>,
}

impl Bodies {
    pub(crate) fn new(model: &Model, links: &[FrameId]) -> Self {
        let carriers: Vec<Option<JointId>> = links.iter().map(|l| carrier(model, *l)).collect();
        let mut has_frames = vec![false; model.joints().len()];
        for joint in model.frame_ids().filter_map(|frame| carrier(model, frame)) {
            has_frames[joint.index()] = true;
        }
        let parent_body = |body: Option<JointId>| {
            let mut body = moving_ancestor(model, model.joints()[body?.index()].parent);
            while let Some(joint) = body.filter(|joint| !has_frames[joint.index()]) {
                body = moving_ancestor(model, model.joints()[joint.index()].parent);
            }
            Some(body)
        };
        Self {
            parents: carriers.iter().map(|body| parent_body(*body)).collect(),
            carriers,
        }
    }

    /// True if two links belong to different bodies that no single joint connects.
    pub(crate) fn are_unconnected(&self, a: usize, b: usize) -> bool {
        self.carriers[a] != self.carriers[b] && !self.is_parent(a, b) && !self.is_parent(b, a)
    }

    /// True if the body of `a` is the parent of that of `b` and of no other body. A forearm is the parent of a hand
    /// alone; a hand is the parent of several fingers.
    pub(crate) fn is_parent_of_only(&self, a: usize, b: usize) -> bool {
        let mut children = (0..self.carriers.len()).filter(|k| self.is_parent(a, *k));
        self.is_parent(a, b) && children.all(|k| self.carriers[k] == self.carriers[b])
    }

    fn is_parent(&self, a: usize, b: usize) -> bool {
        self.parents[b] == Some(self.carriers[a])
    }
}

/// All pairs of links except those of one body and of bodies that one joint connects.
pub(crate) fn unconnected_pairs(model: &Model, links: &[FrameId]) -> Vec<[FrameId; 2]> {
    let bodies = Bodies::new(model, links);
    let pairs = (0..links.len()).flat_map(|a| (a + 1..links.len()).map(move |b| [a, b]));
    let unconnected = pairs.filter(|[a, b]| bodies.are_unconnected(*a, *b));
    unconnected
        .map(|pair| pair.map(|index| links[index]))
        .collect()
}
