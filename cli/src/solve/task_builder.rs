//! Tasks of a problem file in a problem of the solver.

use std::collections::BTreeMap;

use kinopt::model::{FrameId, Model};
use kinopt::problem::ProblemBuilder;
use kinopt::spatial::Placement;
use kinopt::task::{
    FrameVelocity, Gaze, JointCoupling, LookAt, Manipulability, Posture, Quantity, Residual, Task,
};

use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;
use crate::problem::tasks::{Entry, JointWeights, Kind, Motions, Role, Share, Tasks};

impl Tasks {
    /// Frames on which the tasks depend; all frames for a task of joints.
    ///
    /// # Errors
    /// An unknown frame.
    pub(super) fn frames(&self, loaded: &LoadedModel) -> Outcome<Vec<FrameId>> {
        let mut frames = Vec::new();
        for entry in &self.0 {
            let names = match &entry.kind {
                Kind::Gaze(task) => vec![&task.frame],
                Kind::LookAt(task) => vec![&task.frame],
                Kind::FrameVelocity(task) => vec![&task.frame],
                Kind::Manipulability(task) => task.base.iter().chain([&task.frame]).collect(),
                Kind::JointCoupling(_) | Kind::Posture(_) => {
                    frames.extend(loaded.model.frame_ids());
                    Vec::new()
                }
            };
            for name in names {
                frames.push(entry.frame(loaded, name)?);
            }
        }
        Ok(frames)
    }

    /// Adds the tasks of a search from `start`, each with its priority level.
    ///
    /// # Errors
    /// An unknown name, or a configuration of another length.
    pub(super) fn add(
        &self,
        builder: &mut ProblemBuilder<'_>,
        (loaded, start): (&LoadedModel, &[f64]),
        levels: impl Iterator<Item = usize>,
    ) -> Outcome<()> {
        let mut entries = self.0.iter().zip(levels);
        entries.try_for_each(|(entry, level)| entry.add(builder, (loaded, start), level))
    }
}

impl Entry {
    fn frame(&self, loaded: &LoadedModel, name: &str) -> Outcome<FrameId> {
        let frame = loaded.frame(name, BareName::Tip);
        frame.map_err(|error| failure!("{}: {error}", self.location))
    }

    fn add(
        &self,
        builder: &mut ProblemBuilder<'_>,
        (loaded, start): (&LoadedModel, &[f64]),
        level: usize,
    ) -> Outcome<()> {
        let model = &loaded.model;
        let on_level = &mut OnLevel { builder, level };
        match &self.kind {
            Kind::Gaze(task) => {
                let frame = self.frame(loaded, &task.frame)?;
                let gaze = match (task.target, task.direction) {
                    (Some(target), _) => Gaze::at(frame, task.axis, target, task.half_angle),
                    (None, direction) => {
                        let direction = direction.unwrap_or_default();
                        Gaze::along(frame, task.axis, direction, task.half_angle)
                    }
                };
                self.add_task(on_level, gaze);
            }
            Kind::LookAt(task) => {
                let frame = self.frame(loaded, &task.frame)?;
                self.add_task(on_level, LookAt::new(frame, task.axis, task.target));
            }
            Kind::FrameVelocity(task) => {
                let frame = self.frame(loaded, &task.frame)?;
                let previous = loaded.all_frames(start).get(frame.index()).copied();
                let previous = previous.unwrap_or_else(Placement::identity);
                let velocity = (task.linear, task.angular);
                self.add_task(
                    on_level,
                    FrameVelocity::new(frame, previous, task.time_step_s, velocity),
                );
            }
            Kind::JointCoupling(task) => {
                let joints = task.coefficients.iter().map(|(name, &coefficient)| {
                    let joint = model.joint(name);
                    let joint = joint.map_err(|error| failure!("{}: {error}", self.location))?;
                    Ok((joint, coefficient))
                });
                let joints = joints.collect::<Outcome<Vec<_>>>()?;
                self.add_task(on_level, JointCoupling::new(model, joints, task.offset));
            }
            Kind::Manipulability(task) => {
                let frame = self.frame(loaded, &task.frame)?;
                let base = task.base.as_ref().map(|base| self.frame(loaded, base));
                let residual = Manipulability::new(model, base.transpose()?, frame, task.least);
                self.add_task(
                    on_level,
                    match task.of {
                        Motions::Pose => residual,
                        Motions::Position => residual.of_position(),
                        Motions::Orientation => residual.of_orientation(),
                    },
                );
            }
            Kind::Posture(task) => {
                let q = task.q.as_deref().unwrap_or(start);
                let (given, expected) = (q.len(), model.configuration_len());
                if given != expected {
                    let location = &self.location;
                    return Err(failure!(
                        "{location}: q has {given} numbers; expected {expected}"
                    ));
                }
                let posture = Posture::new(model, q);
                self.add_task(
                    on_level,
                    match &task.joint_weights {
                        None => posture,
                        Some(JointWeights::Word(Share::ByRange)) => posture.by_range(model),
                        Some(JointWeights::Word(Share::Upright)) => posture.upright(model),
                        Some(JointWeights::Each(by_joint)) => {
                            posture.with_weights(self.joint_weights(model, by_joint)?)
                        }
                    },
                );
            }
        }
        Ok(())
    }

    /// Weight of each moving joint; 1 for joints that are not given.
    fn joint_weights(&self, model: &Model, given: &BTreeMap<String, f64>) -> Outcome<Vec<f64>> {
        let mut moving = model.moving_joints().to_vec();
        moving.dedup();
        let mut weights = vec![1.0; moving.len()];
        for (name, &weight) in given {
            let joint = model.joint(name);
            let joint = joint.map_err(|error| failure!("{}: {error}", self.location))?;
            let index = moving.iter().position(|&id| id == joint);
            match index.and_then(|index| weights.get_mut(index)) {
                Some(joint_weight) => *joint_weight = weight,
                None => return Err(failure!("{}: joint `{name}` is fixed", self.location)),
            }
        }
        Ok(weights)
    }

    /// Adds a task with the settings of its entry.
    fn add_task<R: Residual>(&self, OnLevel { builder, level }: &mut OnLevel<'_, '_>, residual: R) {
        let rows = residual.rows();
        let mut task = Task::new(residual)
            .named(self.name())
            .scale(self.common.weight)
            .at_level(*level);
        if let Some(tolerance) = self.common.tolerance {
            let quantities = rows.iter().map(|rows| rows.quantity);
            task = quantities.fold(task, |task, quantity: Quantity| {
                task.tolerance(quantity, tolerance)
            });
        }
        builder.add(match self.common.role {
            None => task,
            Some(Role::Goal) => task.goal(),
            Some(Role::Preference) => task.preference(),
        });
    }
}

/// Problem builder with the priority level of a task.
struct OnLevel<'a, 'm> {
    builder: &'a mut ProblemBuilder<'m>,
    level: usize,
}
