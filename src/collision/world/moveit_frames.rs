//! The frames of a planning scene: its own, and those that it says how they stand in that.

use crate::spatial::Placement;
use crate::yaml::Node;

/// What a scene's frame is called where it does not say.
const WORLD: &str = "world";

/// Frames by name. In `fixed_frame_transforms` the scene's own frame is the child, as MoveIt's `Transforms` writes and reads them.
#[derive(Clone, Debug, Default)]
pub(super) struct Frames {
    own: Option<String>,
    /// Those in which the state of the robot stands.
    of_state: Vec<String>,
    others: Vec<(String, Placement<f64>)>,
}

impl Frames {
    /// Those that a robot's state is given in.
    pub(super) fn of_state(root: &Node<'_>) -> Self {
        let state = root.get("robot_state");
        let parts = ["joint_state", "multi_dof_joint_state"].iter();
        let named = parts.filter_map(|part| frame_of(state?.get(part)?));
        Self {
            of_state: named.map(str::to_owned).collect(),
            ..Self::default()
        }
    }

    /// Adds a fixed frame: where its header's stands in its child.
    pub(super) fn add(&mut self, transform: &Node<'_>, child_from_header: Placement<f64>) {
        let child = transform.get("child_frame_id").and_then(Node::text);
        let Some(child) = child.map(bare).filter(|child| !child.is_empty()) else {
            return;
        };
        let own = self.own.get_or_insert_with(|| child.to_owned());
        if let (Some(header), true) = (frame_of(transform), own == child) {
            self.others.push((header.to_owned(), child_from_header));
        }
    }

    /// The name of the scene's own.
    pub(super) fn own(&self) -> &str {
        self.own.as_deref().unwrap_or(WORLD)
    }

    /// Where a frame stands in the scene's own.
    pub(super) fn placement(&self, frame: &str) -> Option<Placement<f64>> {
        let is_own = frame == self.own() || self.of_state.iter().any(|own| own == frame);
        if is_own {
            return Some(Placement::identity());
        }
        let mut others = self.others.iter();
        others.find(|(name, _)| name == frame).map(|(_, at)| *at)
    }
}

/// The frame of what has a header, if that names one.
pub(super) fn frame_of<'n>(node: &'n Node<'_>) -> Option<&'n str> {
    let frame = node.get("header")?.get("frame_id")?.text().map(bare);
    frame.filter(|frame| !matches!(*frame, "" | "~" | "null"))
}

/// Without the slash that older files begin names with.
fn bare(name: &str) -> &str {
    name.strip_prefix('/').unwrap_or(name)
}
