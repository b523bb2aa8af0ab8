//! Tasks of a problem by name, validated; every error names the file and the position in it.

use std::collections::BTreeMap;

use kinopt::model::{FrameId, Model};
use kinopt::problem::ProblemBuilder;
use kinopt::spatial::Placement;
use kinopt::task::{
    FrameVelocity, Gaze, JointCoupling, LookAt, Manipulability, Posture, Quantity, Residual, Task,
};
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use crate::failure::Outcome;
use crate::frame_name::BareName;
use crate::loaded_model::LoadedModel;
use crate::solve::levels::{DefaultLevel, GOALS};
use crate::solve::task_name::TaskName;

const KINDS: [&str; 6] = [
    "gaze",
    "look at",
    "frame velocity",
    "joint coupling",
    "manipulability",
    "posture",
];

/// Tasks of a file.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tasks(Vec<Entry>);

/// Task with its common settings.
#[derive(Clone, Debug)]
struct Entry {
    /// File and index of the task, for error messages.
    location: String,
    common: Common,
    kind: Kind,
}

/// Settings of every task.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Common {
    name: Option<String>,
    /// Factor of the errors.
    #[serde(default = "one")]
    weight: f64,
    tolerance: Option<f64>,
    role: Option<Role>,
    level: Option<usize>,
}

fn one() -> f64 {
    1.0
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Role {
    Goal,
    Preference,
}

#[derive(Clone, Debug)]
enum Kind {
    Gaze(GazeEntry),
    LookAt(LookAtEntry),
    FrameVelocity(FrameVelocityEntry),
    JointCoupling(JointCouplingEntry),
    Manipulability(ManipulabilityEntry),
    Posture(PostureEntry),
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct GazeEntry {
    frame: String,
    axis: [f64; 3],
    /// Half angle of the cone, in radians.
    half_angle: f64,
    target: Option<[f64; 3]>,
    direction: Option<[f64; 3]>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct LookAtEntry {
    frame: String,
    axis: [f64; 3],
    target: [f64; 3],
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FrameVelocityEntry {
    frame: String,
    time_step_s: f64,
    #[serde(default)]
    linear: [f64; 3],
    #[serde(default)]
    angular: [f64; 3],
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct JointCouplingEntry {
    coefficients: BTreeMap<String, f64>,
    #[serde(default)]
    offset: f64,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct ManipulabilityEntry {
    frame: String,
    least: f64,
    base: Option<String>,
    #[serde(default)]
    of: Motions,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Motions {
    #[default]
    Pose,
    Position,
    Orientation,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct PostureEntry {
    /// Configuration; the start if absent.
    q: Option<Vec<f64>>,
    joint_weights: Option<JointWeights>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected \"by range\", \"upright\", or a weight by joint"
)]
enum JointWeights {
    Word(Share),
    Each(BTreeMap<String, f64>),
}

#[derive(Clone, Copy, Debug, Deserialize)]
enum Share {
    #[serde(rename = "by range")]
    ByRange,
    #[serde(rename = "upright")]
    Upright,
}

impl Tasks {
    /// Reads the tasks of a file, with all checks that need no model.
    ///
    /// # Errors
    /// Anything but a list of tasks with known keys.
    pub(super) fn of_value(value: Value, file: &str) -> Result<Self, String> {
        let Value::Array(list) = value else {
            return Err("tasks: is not a list of tasks".to_owned());
        };
        if list.is_empty() {
            return Err("tasks: the list has no task".to_owned());
        }
        let entries = list.into_iter().enumerate().map(|(index, value)| {
            let entry = Entry::of(value, format!("{file}: tasks[{index}]"));
            entry.map_err(|problem| format!("tasks[{index}]: {problem}"))
        });
        entries.collect::<Result<_, _>>().map(Self)
    }

    /// True without tasks.
    pub(crate) fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// True if a task depends on the start configuration.
    pub(crate) fn depends_on_start(&self) -> bool {
        self.0.iter().any(|entry| match &entry.kind {
            Kind::FrameVelocity(_) => true,
            Kind::Posture(posture) => posture.q.is_none(),
            _ => false,
        })
    }

    /// Names of the tasks, in their order.
    pub(crate) fn names(&self) -> impl Iterator<Item = TaskName> + '_ {
        self.0.iter().map(|entry| TaskName {
            frame: entry.name(),
            held: false,
        })
    }

    /// Level of each task: its own, else that of required tasks, and 0 for soft tasks.
    pub(crate) fn levels(&self) -> impl Iterator<Item = DefaultLevel> + '_ {
        self.0.iter().map(|entry| match entry.common.level {
            Some(level) => DefaultLevel::Given(level),
            None if entry.is_goal() => DefaultLevel::IfPrioritised(GOALS),
            None => DefaultLevel::Given(0),
        })
    }

    /// Frames on which the tasks depend; all frames for a task of joints.
    ///
    /// # Errors
    /// An unknown frame.
    pub(crate) fn frames(&self, loaded: &LoadedModel) -> Outcome<Vec<FrameId>> {
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
    pub(crate) fn add(
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
    fn of(value: Value, location: String) -> Result<Self, String> {
        let Value::Object(mut object) = value else {
            return Err("is not an object that describes a task".to_owned());
        };
        let listed = KINDS.join(", ");
        let kind = match object.remove("task") {
            Some(Value::String(kind)) => kind,
            Some(_) => return Err(format!("`task` is not a name; tasks: {listed}")),
            None => return Err(format!("has no key `task`; tasks: {listed}")),
        };
        let common = ["name", "weight", "tolerance", "role", "level"];
        let common = common.iter().filter_map(|key| object.remove_entry(*key));
        let common: Common = read(common.collect())?;
        for (key, number) in [
            ("weight", Some(common.weight)),
            ("tolerance", common.tolerance),
        ] {
            if number.is_some_and(|number| number < 0.0) {
                return Err(format!("`{key}` is below 0"));
            }
        }
        let kind = match kind.as_str() {
            "gaze" => Kind::Gaze(read(object)?),
            "look at" => Kind::LookAt(read(object)?),
            "frame velocity" => Kind::FrameVelocity(read(object)?),
            "joint coupling" => Kind::JointCoupling(read(object)?),
            "manipulability" => Kind::Manipulability(read(object)?),
            "posture" => Kind::Posture(read(object)?),
            other => return Err(format!("unknown task `{other}`; tasks: {listed}")),
        };
        match &kind {
            Kind::Gaze(task) if task.target.is_some() == task.direction.is_some() => {
                Err("expected either `target` or `direction`".to_owned())
            }
            Kind::JointCoupling(task) if task.coefficients.is_empty() => {
                Err("`coefficients` names no joint".to_owned())
            }
            _ => Ok(Self {
                location,
                common,
                kind,
            }),
        }
    }

    /// True for a required task, by its role or else by its kind.
    fn is_goal(&self) -> bool {
        match (self.common.role, &self.kind) {
            (Some(role), _) => matches!(role, Role::Goal),
            (None, Kind::Posture(_) | Kind::Manipulability(_)) => false,
            (None, _) => true,
        }
    }

    fn name(&self) -> String {
        self.common
            .name
            .clone()
            .unwrap_or_else(|| match &self.kind {
                Kind::Gaze(task) => format!("gaze {}", task.frame),
                Kind::LookAt(task) => format!("look at {}", task.frame),
                Kind::FrameVelocity(task) => format!("frame velocity {}", task.frame),
                Kind::JointCoupling(_) => "joint coupling".to_owned(),
                Kind::Manipulability(task) => format!("manipulability {}", task.frame),
                Kind::Posture(_) => "posture".to_owned(),
            })
    }

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

/// Reads an object; an unknown key is an error.
fn read<T: DeserializeOwned>(object: Map<String, Value>) -> Result<T, String> {
    serde_json::from_value(Value::Object(object)).map_err(|error| error.to_string())
}
