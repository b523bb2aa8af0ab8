//! Problems: targets, tasks and options by name, in text and in JSON files.
//!
//! Nothing in this folder depends on the parser of the command line. A problem holds angles in radians and lengths in
//! metres, unless a value has its own unit.

pub mod body;
pub mod interval;
pub mod methods;
pub mod number_list;
mod sections;
mod solver;
pub mod start;
pub mod target;
pub mod targets_file;
pub mod tasks;
mod text;

use std::fmt::Display;
use std::path::{Path, PathBuf};

use kinopt::model::UnknownName;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

pub use sections::*;
use tasks::Tasks;

use crate::error::ErrorKind;
use crate::json::JsonError;

/// Sections of a file.
const SECTIONS: &str = "model files collisions goal tasks body solve output path";

/// Key of the path of the schema, which editors write.
const SCHEMA: &str = "$schema";

/// Problem of a query.
#[derive(Clone, Debug, Default)]
pub struct ProblemSettings {
    /// Reading of the model.
    pub model: ModelSettings,
    /// Files that may be opened.
    pub files: FileSettings,
    /// Obstacles and collision shapes.
    pub collisions: CollisionSettings,
    /// Targets of frames.
    pub goal: GoalSettings,
    /// Further tasks.
    pub tasks: Tasks,
    /// Held frames, balance, weights and priorities.
    pub body: BodySettings,
    /// Search for a solution.
    pub solve: SolveSettings,
    /// Additional content of reports and files.
    pub output: OutputSettings,
    /// Cartesian paths.
    pub path: PathSettings,
}

impl ProblemSettings {
    /// Problem of the content of a JSON file. Paths in the file are relative to its folder.
    ///
    /// # Errors
    /// An unknown key, or a wrong value; the message has the file, the section and the valid keys.
    pub fn of_value(value: Value, path: &Path) -> Result<Self, JsonError> {
        let file = path.display().to_string();
        let problem = match value {
            Value::Object(sections) => Self::of_sections(sections, &file),
            _ => Err("is not an object of sections".to_owned()),
        };
        let mut problem = problem.map_err(|problem| of_file(&file, problem))?;
        problem.resolve_paths(path.parent().unwrap_or(Path::new("")));
        Ok(problem)
    }

    fn of_sections(mut sections: Map<String, Value>, file: &str) -> Result<Self, String> {
        sections.remove(SCHEMA);
        let tasks = sections.remove("tasks");
        let tasks = tasks
            .map(|tasks| Tasks::of_value(tasks, file))
            .transpose()?;
        let problem = Self {
            model: section(&mut sections, "model")?,
            files: section(&mut sections, "files")?,
            collisions: section(&mut sections, "collisions")?,
            goal: section(&mut sections, "goal")?,
            tasks: tasks.unwrap_or_default(),
            body: section(&mut sections, "body")?,
            solve: section(&mut sections, "solve")?,
            output: section(&mut sections, "output")?,
            path: section(&mut sections, "path")?,
        };
        match sections.keys().next() {
            None => Ok(problem),
            Some(key) => Err(UnknownName::new("section", key, SECTIONS.split(' ')).to_string()),
        }
    }

    fn resolve_paths(&mut self, folder: &Path) {
        let (model, collisions) = (&mut self.model, &mut self.collisions);
        let single = [
            &mut model.joint_limits,
            &mut model.cones,
            &mut model.srdf,
            &mut collisions.world,
            &mut collisions.sphere_model,
        ];
        let lists = [&mut self.files.allow_folder, &mut collisions.package];
        let paths = single.into_iter().flatten();
        for path in paths.chain(lists.into_iter().flatten()) {
            *path = folder.join(PathBuf::as_path(path));
        }
    }
}

/// Section of a file, or its defaults; an unknown key is an error that lists the valid ones.
fn section<T: DeserializeOwned + Default>(
    sections: &mut Map<String, Value>,
    name: &str,
) -> Result<T, String> {
    let section = sections.remove(name).map(serde_json::from_value);
    let section = section.transpose();
    Ok(section
        .map_err(|error| format!("{name}: {error}"))?
        .unwrap_or_default())
}

/// Error about the content of a file.
fn of_file(file: &str, problem: impl Display) -> JsonError {
    JsonError {
        kind: ErrorKind::InvalidFile,
        message: format!("{file}: {problem}"),
    }
}
