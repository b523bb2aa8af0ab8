//! Tasks of a problem by name, validated; every error names the file and the position in it.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

use super::task_name::{DefaultLevel, GOALS, TaskName};

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
pub(crate) struct Tasks(pub(crate) Vec<Entry>);

/// Task with its common settings.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    /// File and index of the task, for error messages.
    pub(crate) location: String,
    pub(crate) common: Common,
    pub(crate) kind: Kind,
}

/// Settings of every task.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Common {
    pub(crate) name: Option<String>,
    /// Factor of the errors.
    #[serde(default = "one")]
    pub(crate) weight: f64,
    pub(crate) tolerance: Option<f64>,
    pub(crate) role: Option<Role>,
    pub(crate) level: Option<usize>,
}

fn one() -> f64 {
    1.0
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Role {
    Goal,
    Preference,
}

#[derive(Clone, Debug)]
pub(crate) enum Kind {
    Gaze(GazeEntry),
    LookAt(LookAtEntry),
    FrameVelocity(FrameVelocityEntry),
    JointCoupling(JointCouplingEntry),
    Manipulability(ManipulabilityEntry),
    Posture(PostureEntry),
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct GazeEntry {
    pub(crate) frame: String,
    pub(crate) axis: [f64; 3],
    /// Half angle of the cone, in radians.
    pub(crate) half_angle: f64,
    pub(crate) target: Option<[f64; 3]>,
    pub(crate) direction: Option<[f64; 3]>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct LookAtEntry {
    pub(crate) frame: String,
    pub(crate) axis: [f64; 3],
    pub(crate) target: [f64; 3],
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct FrameVelocityEntry {
    pub(crate) frame: String,
    pub(crate) time_step_s: f64,
    #[serde(default)]
    pub(crate) linear: [f64; 3],
    #[serde(default)]
    pub(crate) angular: [f64; 3],
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct JointCouplingEntry {
    pub(crate) coefficients: BTreeMap<String, f64>,
    #[serde(default)]
    pub(crate) offset: f64,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct ManipulabilityEntry {
    pub(crate) frame: String,
    pub(crate) least: f64,
    pub(crate) base: Option<String>,
    #[serde(default)]
    pub(crate) of: Motions,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Motions {
    #[default]
    Pose,
    Position,
    Orientation,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct PostureEntry {
    /// Configuration; the start if absent.
    pub(crate) q: Option<Vec<f64>>,
    pub(crate) joint_weights: Option<JointWeights>,
}

#[derive(Clone, Debug, Deserialize)]
#[serde(
    untagged,
    expecting = "expected \"by range\", \"upright\", or a weight by joint"
)]
pub(crate) enum JointWeights {
    Word(Share),
    Each(BTreeMap<String, f64>),
}

#[derive(Clone, Copy, Debug, Deserialize)]
pub(crate) enum Share {
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

    pub(crate) fn name(&self) -> String {
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
}

/// Reads an object; an unknown key is an error.
fn read<T: DeserializeOwned>(object: Map<String, Value>) -> Result<T, String> {
    serde_json::from_value(Value::Object(object)).map_err(|error| error.to_string())
}
