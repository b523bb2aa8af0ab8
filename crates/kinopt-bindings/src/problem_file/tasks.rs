//! Tasks of a problem file, as named arguments with their location.

use kinopt::Model;
use kinopt::model::{FrameId, Masses, UnknownName};
use kinopt::problem::ProblemBuilder;
use kinopt::spatial::Placement;
use kinopt::task::Role;
use serde_json::{Map, Value as Json, json};

use crate::json::JsonError;
use crate::placement::to_rows;
use crate::task::{AddTask, COMMON_OPTIONS, KINDS, TaskModel, TaskOptions, residual};
use crate::value::{Arguments, OrRaise, Value};

/// Kinds of tasks in a file.
const FILE_KINDS: &str = "gaze, look at, frame velocity, joint coupling, manipulability, posture";
/// Arguments with other names in a file.
const FILE_NAMES: [(&str, &str); 2] = [("time_step", "time_step_s"), ("reference", "q")];

/// Tasks of a file.
#[derive(Clone, Debug, Default)]
pub struct Tasks(pub Vec<FileTask>);

/// A task of a file.
#[derive(Clone, Debug)]
pub struct FileTask {
    /// File and index of the task, for messages.
    location: String,
    kind: &'static str,
    options: TaskOptions,
    arguments: Map<String, Json>,
}

/// Model and start of a search.
pub struct TaskStart<'a> {
    /// The model.
    pub model: &'a Model,
    /// Frame of a name.
    pub frame: &'a dyn Fn(&str) -> Result<FrameId, UnknownName>,
    /// Start configuration, the reference of a posture without its own.
    pub q: &'a [f64],
    /// Placements of all frames at the start.
    pub placements: &'a [Placement<f64>],
}

impl Tasks {
    /// Reads the tasks of a file, with all checks that need no model.
    pub(super) fn of_value(value: Json, file: &str) -> Result<Self, String> {
        let Json::Array(list) = value else {
            return Err("tasks: is not a list of tasks".to_owned());
        };
        if list.is_empty() {
            return Err("tasks: the list has no task".to_owned());
        }
        let tasks = list.into_iter().enumerate().map(|(index, value)| {
            let task = FileTask::of(value, format!("{file}: tasks[{index}]"));
            task.map_err(|problem| format!("tasks[{index}]: {problem}"))
        });
        tasks.collect::<Result<_, _>>().map(Self)
    }

    /// True without tasks.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// True if a task depends on the start configuration.
    #[must_use]
    pub fn depends_on_start(&self) -> bool {
        self.0.iter().any(|task| match task.kind {
            "frame velocity" => true,
            "posture" => !task.arguments.contains_key("q"),
            _ => false,
        })
    }
}

impl FileTask {
    fn of(value: Json, location: String) -> Result<Self, String> {
        let Json::Object(mut arguments) = value else {
            return Err("is not an object that describes a task".to_owned());
        };
        let given = match arguments.remove("task") {
            Some(Json::String(kind)) => kind,
            Some(_) => return Err(format!("`task` is not a name; tasks: {FILE_KINDS}")),
            None => return Err(format!("has no key `task`; tasks: {FILE_KINDS}")),
        };
        let known = KINDS.into_iter().find(|(kind, _)| *kind == given);
        let Some((kind, names)) =
            known.filter(|_| FILE_KINDS.split(", ").any(|kind| kind == given))
        else {
            return Err(format!("unknown task `{given}`; tasks: {FILE_KINDS}"));
        };
        let names = names.iter().map(|name| file_name(name));
        let common = COMMON_OPTIONS.into_iter().filter(|name| *name != "scale");
        let names: Vec<&str> = names.chain(common).collect();
        for (key, value) in &arguments {
            if !names.contains(&key.as_str()) {
                return Err(UnknownName::new("key", key, names).to_string());
            }
            let is_negative = value.as_f64().is_some_and(|number| number < 0.0);
            if is_negative && ["weight", "tolerance"].contains(&key.as_str()) {
                return Err(format!("`{key}` is below 0"));
            }
        }
        // In a file the weight is a factor of all weights.
        if let Some(factor) = arguments.remove("weight") {
            arguments.insert("scale".to_owned(), factor);
        }
        let options = TaskOptions::of(&arguments).map_err(|error| error.message)?;
        Ok(Self {
            location,
            kind,
            options,
            arguments,
        })
    }

    /// Name of the task; by default its kind, with its frame.
    #[must_use]
    pub fn name(&self) -> String {
        match (&self.options.name, self.frame_names().next()) {
            (Some(name), _) => name.clone(),
            (None, Some(frame)) => format!("{} {frame}", self.kind),
            (None, None) => self.kind.to_owned(),
        }
    }

    /// Priority level of the task, if it has one.
    #[must_use]
    pub fn level(&self) -> Option<usize> {
        self.options.level.and_then(|level| level.try_into().ok())
    }

    /// True for a required task, by its role or else by its kind.
    #[must_use]
    pub fn is_goal(&self) -> bool {
        match self.options.role {
            Some(role) => role == Role::Goal,
            None => !["posture", "manipulability"].contains(&self.kind),
        }
    }

    /// Names of the frames on which the task depends; none for a task of joints.
    pub fn frame_names(&self) -> impl Iterator<Item = &str> {
        let frames = ["frame", "base"].into_iter();
        frames.filter_map(|key| self.arguments.get(key)?.as_str())
    }

    /// Error with the location of the task.
    #[must_use]
    pub fn located(&self, error: JsonError) -> JsonError {
        let message = format!("{}: {}", self.location, error.message);
        JsonError { message, ..error }
    }

    /// Adds the task with a priority level to the problem of a search.
    ///
    /// # Errors
    /// If an argument is missing or has another type, or a frame or joint is unknown; the message has the location.
    pub fn add(
        &self,
        builder: &mut ProblemBuilder<'_>,
        start: &TaskStart<'_>,
        level: usize,
    ) -> Result<(), JsonError> {
        let masses = || Masses::new(start.model, []).or_raise::<Json>();
        let on = TaskModel {
            model: start.model,
            masses: &masses,
        };
        let options = TaskOptions {
            name: Some(self.name()),
            level: Some(level as u64),
            ..self.options.clone()
        };
        let add = AddTask { builder, options };
        let arguments = ArgumentsAtStart { task: self, start };
        match residual(&arguments, &on, self.kind, add) {
            Ok(_) => Ok(()),
            Err(error) => Err(self.located(error)),
        }
    }
}

/// Name of an argument in a file.
fn file_name(name: &str) -> &str {
    let renamed = FILE_NAMES.iter().find(|(known, _)| *known == name);
    renamed.map_or(name, |(_, file_name)| file_name)
}

/// Arguments of a task, with the references of a search as defaults.
struct ArgumentsAtStart<'a> {
    task: &'a FileTask,
    start: &'a TaskStart<'a>,
}

impl ArgumentsAtStart<'_> {
    fn frame_of(&self, value: &Json, name: &str) -> Result<FrameId, JsonError> {
        (self.start.frame)(&value.name(name)?).or_raise::<Json>()
    }
}

impl Arguments for ArgumentsAtStart<'_> {
    type Value = Json;

    fn get(&self, name: &str) -> Result<Option<Json>, JsonError> {
        let given = Arguments::get(&self.task.arguments, file_name(name))?;
        Ok(match (given, self.task.kind, name) {
            (Some(given), ..) => Some(given),
            (None, "frame velocity", "previous") => {
                let frame = self.frame(self.start.model, "frame")?;
                let placement = self.start.placements.get(frame.index());
                placement.map(|placement| to_rows(placement).chunks(4).collect::<Json>())
            }
            (None, "posture", "reference") => Some(json!(self.start.q)),
            _ => None,
        })
    }

    fn required(&self, name: &str) -> Result<Json, JsonError> {
        match self.get(name)? {
            Some(value) => Ok(value),
            None => self.task.arguments.required(file_name(name)),
        }
    }

    fn frame(&self, _model: &Model, name: &str) -> Result<FrameId, JsonError> {
        self.frame_of(&self.required(name)?, name)
    }

    fn optional_frame(&self, _model: &Model, name: &str) -> Result<Option<FrameId>, JsonError> {
        let value = self.get(name)?;
        value.map(|value| self.frame_of(&value, name)).transpose()
    }
}
