//! Between the arm's numbers and a configuration of the whole model.

use super::query::Arm;
use super::serial::{Serial, source_of};
use super::{QueryError, route::Part};
use crate::model::{JointId, Limits, Model, ParameterMap, Source};

/// Where the coordinates of the model that the arm moves or holds come from.
#[derive(Debug)]
pub(super) struct Coordinates {
    degrees_of_freedom: usize,
    /// (coordinate, source in terms of the arm's joints, limits).
    entries: Vec<(usize, Source, Limits)>,
    /// The coordinate that each joint of the arm is.
    own: Vec<usize>,
}

impl Coordinates {
    pub(super) fn new(
        source: &Model,
        full: &ParameterMap,
        parts: &[Part],
        serial: &Serial,
    ) -> Self {
        let joint_of = |c: usize| source.moving_joints()[c];
        let held = |id: JointId| {
            parts
                .iter()
                .any(|part| matches!(part, Part::Joint { id: other, .. } if *other == id))
        };
        let limits: Vec<Limits> = source.limits().collect();
        let mut entries = Vec::new();
        for (c, limits) in limits.into_iter().enumerate() {
            match source_of(full, c) {
                Source::Constant(value) if held(joint_of(c)) => {
                    entries.push((c, Source::Constant(value), limits));
                }
                Source::Constant(_) => {}
                Source::Variable {
                    variable,
                    ratio,
                    offset,
                } => {
                    let leader = joint_of(full.leaders()[variable]);
                    if let Some(variable) = serial.joints.iter().position(|id| *id == leader) {
                        let source = Source::Variable {
                            variable,
                            ratio,
                            offset,
                        };
                        entries.push((c, source, limits));
                    }
                }
            }
        }
        let own = serial
            .joints
            .iter()
            .filter_map(|&id| source.coordinate(id))
            .collect();
        Self {
            degrees_of_freedom: source.degrees_of_freedom(),
            entries,
            own,
        }
    }
}

impl Arm {
    /// Writes the arm's joints into a configuration of the model the arm was built from (shape: its
    /// degrees of freedom), with the joints between base and tip that are locked and all joints
    /// that follow; the other numbers stay as they are.
    ///
    /// # Errors
    /// Slices of the wrong length.
    pub fn configuration(&self, q_arm: &[f64], q_model: &mut [f64]) -> Result<(), QueryError> {
        let n = self.joint_count();
        self.check_length("q_arm", q_arm.len(), n)?;
        self.check_length(
            "q_model",
            q_model.len(),
            self.coordinates.degrees_of_freedom,
        )?;
        for (coordinate, source, limits) in &self.coordinates.entries {
            q_model[*coordinate] = match *source {
                Source::Constant(value) => value,
                Source::Variable {
                    variable,
                    ratio,
                    offset,
                } => limits.clamp(q_arm[variable] * ratio + offset),
            };
        }
        Ok(())
    }

    /// Reads the arm's joints out of a configuration of the model.
    ///
    /// # Errors
    /// Slices of the wrong length.
    pub fn joint_values(&self, q_model: &[f64], q_arm: &mut [f64]) -> Result<(), QueryError> {
        let n = self.joint_count();
        self.check_length("q_arm", q_arm.len(), n)?;
        self.check_length(
            "q_model",
            q_model.len(),
            self.coordinates.degrees_of_freedom,
        )?;
        for (value, &coordinate) in q_arm.iter_mut().zip(&self.coordinates.own) {
            *value = q_model[coordinate];
        }
        Ok(())
    }
}
