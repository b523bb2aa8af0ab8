//! Frames of a MoveIt planning scene: the planning frame, and frames with a known transform to it.

use kinopt_kinematics::spatial::Placement;
use kinopt_robot::yaml::Node;

/// Default name of the planning frame.
const WORLD: &str = "world";

/// Frames by name. In `fixed_frame_transforms` the planning frame is the child, as MoveIt's `Transforms` writes and
/// reads them.
#[derive(Clone, Debug, Default)]
pub(super) struct Frames {
    planning_frame: Option<String>,
    /// Frames in which the state of the robot is given.
    of_state: Vec<String>,
    others: Vec<(String, Placement<f64>)>,
}

impl Frames {
    /// Collects the frames in which the state of the robot is given.
    pub(super) fn of_state(root: &Node<'_>) -> Self {
        let state = root.get("robot_state");
        let parts = ["joint_state", "multi_dof_joint_state"].iter();
        let named = parts.filter_map(|part| frame_of(state?.get(part)?));
        Self {
            of_state: named.map(str::to_owned).collect(),
            ..Self::default()
        }
    }

    /// Adds a fixed transform: the placement of its header's frame in its child frame.
    pub(super) fn add(&mut self, transform: &Node<'_>, child_from_header: Placement<f64>) {
        let child = transform.get("child_frame_id").and_then(Node::text);
        let Some(child) = child.map(without_slash).filter(|child| !child.is_empty()) else {
            return;
        };
        let planning_frame = self.planning_frame.get_or_insert_with(|| child.to_owned());
        if let (Some(header), true) = (frame_of(transform), planning_frame == child) {
            self.others.push((header.to_owned(), child_from_header));
        }
    }

    /// Name of the planning frame.
    pub(super) fn planning_frame(&self) -> &str {
        self.planning_frame.as_deref().unwrap_or(WORLD)
    }

    /// Placement of a frame in the planning frame; `None` if it is unknown.
    pub(super) fn placement(&self, frame: &str) -> Option<Placement<f64>> {
        let is_planning_frame = frame == self.planning_frame()
            || self.of_state.iter().any(|state_frame| state_frame == frame);
        if is_planning_frame {
            return Some(Placement::identity());
        }
        let mut others = self.others.iter();
        others
            .find(|(name, _)| name == frame)
            .map(|(_, placement)| *placement)
    }
}

/// The frame in a node's header, if it names one.
pub(super) fn frame_of<'n>(node: &'n Node<'_>) -> Option<&'n str> {
    let frame = node
        .get("header")?
        .get("frame_id")?
        .text()
        .map(without_slash);
    frame.filter(|frame| !matches!(*frame, "" | "~" | "null"))
}

/// Removes the leading slash of frame names in older files.
fn without_slash(name: &str) -> &str {
    name.strip_prefix('/').unwrap_or(name)
}
