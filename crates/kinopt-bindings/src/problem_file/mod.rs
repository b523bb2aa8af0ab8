//! Problems: targets, tasks and options by name, in text and in JSON files.
//!
//! Nothing in this folder depends on the parser of the command line. A problem holds angles in radians and lengths in
//! metres, unless a value has its own unit.

pub(crate) mod body;
pub(crate) mod interval;
pub(crate) mod methods;
pub(crate) mod number_list;
mod schema;
mod sections;
pub(crate) mod start;
pub(crate) mod target;
pub(crate) mod targets_file;
pub(crate) mod task_name;
pub(crate) mod tasks;
mod text;

use std::path::{Path, PathBuf};

use kinopt::model::UnknownName;
use serde::de::DeserializeOwned;
use serde_json::{Map, Value};

pub(crate) use schema::place_of;
pub(crate) use sections::*;
use tasks::Tasks;

use crate::failure::Outcome;
use crate::json_file;

/// Sections of a file.
const SECTIONS: [&str; 9] = [
    "model",
    "files",
    "collisions",
    "goal",
    "tasks",
    "body",
    "solve",
    "output",
    "path",
];

/// Key of the path of the schema, which editors write.
const SCHEMA: &str = "$schema";

/// Problem of a query.
#[derive(Clone, Debug, Default)]
pub(crate) struct Problem {
    pub(crate) model: ModelSettings,
    pub(crate) files: FileSettings,
    pub(crate) collisions: CollisionSettings,
    pub(crate) goal: GoalSettings,
    pub(crate) tasks: Tasks,
    pub(crate) body: BodySettings,
    pub(crate) solve: SolveSettings,
    pub(crate) output: OutputSettings,
    pub(crate) path: PathSettings,
}

impl Problem {
    /// Problem of a JSON file. Paths in the file are relative to its folder.
    ///
    /// # Errors
    /// A missing or damaged file, an unknown key, or a wrong value; the message has the section and the valid keys.
    pub(crate) fn read(path: &Path) -> Outcome<Self> {
        let file = path.display();
        let Value::Object(sections) = json_file::read(path)? else {
            return Err(failure!("{file}: is not an object of sections"));
        };
        let problem = Self::of_sections(sections, &file.to_string());
        let mut problem = problem.map_err(|problem| failure!("{file}: {problem}"))?;
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
            Some(key) => Err(UnknownName::new("section", key, SECTIONS).to_string()),
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

/// Group of options that changes a problem.
pub(crate) trait ProblemOptions {
    /// Replaces values of the problem by those given; `degrees` is the unit of typed angles.
    fn add_to(&self, problem: &mut Problem, degrees: bool);
}

/// Replaces a value by a given one.
pub(crate) fn set<T: Clone>(value: &mut Option<T>, given: Option<&T>) {
    if given.is_some() {
        *value = given.cloned();
    }
}

/// Replaces a list by a given one that is not empty.
pub(crate) fn set_list<T>(list: &mut Vec<T>, given: impl ExactSizeIterator<Item = T>) {
    if given.len() > 0 {
        *list = given.collect();
    }
}
