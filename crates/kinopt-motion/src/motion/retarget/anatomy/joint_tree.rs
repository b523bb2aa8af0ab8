//! Joint tree of a capture or a character: names, parents and positions at rest.

use std::collections::BTreeMap;

use glam::DVec3;

use super::super::Capture;
use kinopt_kinematics::kinematics::ForwardKinematics;
use kinopt_kinematics::model::{LengthUnit, Model};
use kinopt_kinematics::spatial::Vector3;

/// Named joints with parents and positions. All positions share one world with any upward axis.
#[derive(Clone, Debug)]
pub(in super::super) struct JointTree {
    pub(in super::super) names: Vec<String>,
    pub(in super::super) parents: Vec<Option<usize>>,
    pub(in super::super) positions: Vec<DVec3>,
    children: Vec<Vec<usize>>,
}

impl JointTree {
    pub(in super::super) fn new(
        names: Vec<String>,
        parents: Vec<Option<usize>>,
        positions: Vec<DVec3>,
    ) -> Self {
        let mut children = vec![Vec::new(); names.len()];
        for (joint, parent) in parents.iter().enumerate() {
            if let Some(siblings) = parent.and_then(|parent| children.get_mut(parent)) {
                siblings.push(joint);
            }
        }
        Self {
            names,
            parents,
            positions,
            children,
        }
    }

    /// Returns the tree of a capture with rotations, in its rest pose.
    pub(in super::super) fn of_capture(capture: &Capture) -> Option<Self> {
        let (posed, rest) = (capture.posed()?, capture.rest()?);
        let positions = rest.iter().map(|at| DVec3::from_array(at.to_array()));
        Some(Self::new(
            capture.names().to_vec(),
            posed.parents.clone(),
            positions.collect(),
        ))
    }

    /// Returns the tree of a character's model, with the frame of each joint, or `None` for a robot.
    ///
    /// A model in its own unit of length is a character. The first frame on a joint is that of its bone.
    pub(in super::super) fn of_character(model: &Model) -> Option<(Self, Vec<usize>)> {
        if model.length_unit() != LengthUnit::Own {
            return None;
        }
        let mut frame_of_joint = BTreeMap::new();
        let mut frames = Vec::new();
        for (index, frame) in model.frames().iter().enumerate() {
            let Some(joint) = frame.joint else { continue };
            if let std::collections::btree_map::Entry::Vacant(entry) =
                frame_of_joint.entry(joint.index())
            {
                entry.insert(frames.len());
                frames.push((index, joint));
            }
        }
        let parents = frames.iter().map(|(_, joint)| {
            let parent = |joint: usize| model.joints()[joint].parent.map(|id| id.index());
            let mut above = std::iter::successors(parent(joint.index()), |joint| parent(*joint));
            above.find_map(|joint| frame_of_joint.get(&joint).copied())
        });
        let parents = parents.collect();
        let mut kinematics = ForwardKinematics::new(model);
        let placed = kinematics.place(&model.neutral()).ok()?;
        let at = |v: Vector3<f64>| DVec3::from_array(v.to_array());
        let positions = frames
            .iter()
            .map(|(index, _)| at(placed[*index].translation));
        let names = frames
            .iter()
            .map(|(index, _)| model.frames()[*index].name.clone());
        let tree = Self::new(names.collect(), parents, positions.collect());
        Some((tree, frames.into_iter().map(|(index, _)| index).collect()))
    }

    pub(in super::super) fn len(&self) -> usize {
        self.names.len()
    }

    pub(in super::super) fn children(&self, joint: usize) -> &[usize] {
        self.children.get(joint).map_or(&[], Vec::as_slice)
    }

    /// Returns a joint and all joints above it, towards the root.
    pub(in super::super) fn up_from(&self, joint: usize) -> impl Iterator<Item = usize> + '_ {
        let parent = |joint: &usize| self.parents.get(*joint).copied().flatten();
        std::iter::successors(Some(joint), parent)
    }

    /// Returns whether a joint is below another one.
    pub(in super::super) fn is_below(&self, joint: usize, ancestor: usize) -> bool {
        self.up_from(joint).skip(1).any(|above| above == ancestor)
    }

    /// Returns the joints between an ancestor and a joint, from the ancestor outwards, without both.
    pub(in super::super) fn joints_between(
        &self,
        ancestor: usize,
        joint: usize,
    ) -> Option<Vec<usize>> {
        let mut path = Vec::new();
        for above in self.up_from(joint).skip(1) {
            if above == ancestor {
                path.reverse();
                return Some(path);
            }
            path.push(above);
        }
        None
    }

    /// Returns the lowest common ancestor of two joints; a joint counts as its own ancestor.
    pub(in super::super) fn common_ancestor(&self, a: usize, b: usize) -> Option<usize> {
        let above: Vec<usize> = self.up_from(a).collect();
        self.up_from(b).find(|joint| above.contains(joint))
    }

    /// Returns a joint and all joints below it.
    pub(in super::super) fn subtree(&self, joint: usize) -> Vec<usize> {
        let mut found = vec![joint];
        let mut next = 0;
        while let Some(&current) = found.get(next) {
            found.extend_from_slice(self.children(current));
            next += 1;
        }
        found
    }

    /// Distance of two joints.
    pub(in super::super) fn distance(&self, a: usize, b: usize) -> f64 {
        self.positions[a].distance(self.positions[b])
    }
}
