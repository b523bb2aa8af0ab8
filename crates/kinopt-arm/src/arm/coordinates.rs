//! Coordinates of the model that an arm moves or locks.

use super::kinematic_path::Part;
use super::serial_chain::{Serial, source_of};
use kinopt_kinematics::model::{FrameId, JointId, Limits, Model, ParameterMap, Source};

/// Sources of the model's coordinates that the arm moves or locks.
#[derive(Clone, Debug)]
pub(super) struct Coordinates {
    /// Frame in which targets are given; `None` for the world.
    #[cfg_attr(
        not(feature = "collision"),
        expect(dead_code, reason = "collisions alone ask")
    )]
    pub(super) base: Option<FrameId>,
    pub(super) degrees_of_freedom: usize,
    /// (coordinate, source in terms of the arm's joints, limits).
    pub(super) entries: Vec<(usize, Source, Limits)>,
    /// Coordinate of each joint of the arm.
    pub(super) joint_coordinates: Vec<usize>,
}

impl Coordinates {
    pub(super) fn new(
        (source, base): (&Model, Option<FrameId>),
        full: &ParameterMap,
        parts: &[Part],
        serial: &Serial,
    ) -> Self {
        let joint_of = |c: usize| source.moving_joints()[c];
        let is_on_chain = |id: JointId| parts.iter().any(|part| part.is_joint(id));
        let limits: Vec<Limits> = source.limits().collect();
        let mut entries = Vec::new();
        for (c, limits) in limits.into_iter().enumerate() {
            match source_of(full, c) {
                Source::Constant(value) if is_on_chain(joint_of(c)) => {
                    entries.push((c, Source::Constant(value), limits));
                }
                // The chain has no ball joint, and the arm moves none elsewhere.
                Source::Constant(_) | Source::Rotation { .. } => {}
                Source::Variable {
                    variable,
                    ratio,
                    offset,
                } => {
                    let source_joint = joint_of(full.leaders()[variable]);
                    if let Some(variable) = serial.joints.iter().position(|id| *id == source_joint)
                    {
                        let source = Source::of_variable(variable, ratio, offset);
                        entries.push((c, source, limits));
                    }
                }
            }
        }
        let joint_coordinates = serial.joints.iter().filter_map(|&id| source.coordinate(id));
        Self {
            base,
            degrees_of_freedom: source.configuration_len(),
            entries,
            joint_coordinates: joint_coordinates.collect(),
        }
    }
}
