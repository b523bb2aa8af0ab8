//! Passive joints: joints that no actuator drives.

use std::collections::HashSet;

use super::names::ElementNames;
use super::tree::Tag;
use crate::robot::Robot;
use kinopt_kinematics::model::JointId;

/// The moving joints that no actuator drives and that are no mimic joints. Empty for a file without actuators.
pub(super) fn joints(root: Tag<'_>, names: &ElementNames<'_>, robot: &Robot) -> Vec<JointId> {
    let sections = |name| root.children_named(name);
    let actuators = sections("actuator").flat_map(|section| section.children());
    let actuators: Vec<Tag<'_>> = actuators.collect();
    if actuators.is_empty() {
        return Vec::new();
    }
    let mut driven: HashSet<&str> = HashSet::new();
    let mut driven_tendons: HashSet<&str> = HashSet::new();
    for actuator in &actuators {
        driven.extend(actuator.text("joint"));
        driven.extend(actuator.text("jointinparent"));
        driven_tendons.extend(actuator.text("tendon"));
    }
    let tendons = sections("tendon").flat_map(|section| section.children_named("fixed"));
    for tendon in tendons.filter(|tag| {
        tag.text("name")
            .is_some_and(|name| driven_tendons.contains(name))
    }) {
        driven.extend(
            tendon
                .children_named("joint")
                .filter_map(|joint| joint.text("joint")),
        );
    }
    let driven: HashSet<JointId> = driven
        .iter()
        .filter_map(|name| names.joint_named(name))
        .collect();
    let is_mimic = |id: JointId| robot.mimics().iter().any(|mimic| mimic.joint == id);
    let mut moving = robot.model().moving_joints().to_vec();
    moving.dedup();
    moving.retain(|id| !driven.contains(id) && !is_mimic(*id));
    moving
}
