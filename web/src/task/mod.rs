//! Tasks as plain objects, converted to residuals of the library.

#[cfg(feature = "bodies")]
mod body_tasks;
#[cfg(feature = "bodies")]
mod bounded;
mod posture;
mod residual;
mod target;

use kinopt::model::UnknownName;
use kinopt::problem::{ProblemBuilder, TaskId};
use kinopt::task::{Residual, Task};
use wasm_bindgen::prelude::*;

use crate::arguments::NamedArguments;
use crate::model::Model;
use crate::raise;
use target::Target;
pub(crate) use target::{AimableTask, Aimed};

/// Common keys of all tasks.
const COMMON_OPTIONS: [&str; 7] = [
    "kind",
    "name",
    "weight",
    "scale",
    "tolerance",
    "role",
    "level",
];

/// A task of a problem, with a target that can be moved.
pub(crate) type BoxedTask = Box<dyn AimableTask>;

/// Adds a task to a problem.
pub(crate) fn add(
    task: JsValue,
    model: &Model,
    builder: &mut ProblemBuilder<'_>,
) -> Result<BoxedTask, JsError> {
    let kind = kind(&task)?;
    #[cfg(feature = "bodies")]
    if kind == "bounded" {
        return bounded::add(task, model, builder);
    }
    let options = residual::task_options(task, &kind)?;
    let adding = Adding {
        builder,
        common: CommonOptions::of(&options)?,
    };
    residual::read(&options, model, &kind, adding)
}

fn kind(task: &JsValue) -> Result<String, JsError> {
    let kind = js_sys::Reflect::get(task, &"kind".into());
    let kind = kind.ok().and_then(|kind| kind.as_string());
    kind.ok_or_else(|| JsError::new("a task is an object with a kind: see `tasks`"))
}

/// Common keys, and those of one kind.
fn known<'a>(names: &[&'a str]) -> Vec<&'a str> {
    COMMON_OPTIONS.iter().chain(names).copied().collect()
}

/// Generic function of a residual.
trait Visit {
    fn visit<R: Target>(self, residual: R) -> Result<BoxedTask, JsError>;
}

struct Adding<'a, 'm> {
    builder: &'a mut ProblemBuilder<'m>,
    common: CommonOptions,
}

impl Visit for Adding<'_, '_> {
    fn visit<R: Target>(self, residual: R) -> Result<BoxedTask, JsError> {
        let task = self.common.task(residual)?;
        let id: TaskId<R> = self.builder.add(task);
        Ok(Box::new(id))
    }
}

/// Common options of a task.
#[derive(Default)]
struct CommonOptions {
    name: Option<String>,
    weight: Option<f64>,
    scale: Option<f64>,
    tolerance: Option<f64>,
    role: Option<String>,
    level: Option<u32>,
}

impl CommonOptions {
    fn of(options: &NamedArguments) -> Result<Self, JsError> {
        Ok(Self {
            name: options.text("name")?,
            weight: options.number("weight")?,
            scale: options.number("scale")?,
            tolerance: options.number("tolerance")?,
            role: options.text("role")?,
            level: options.whole("level")?,
        })
    }

    fn task<R: Residual>(self, residual: R) -> Result<Task<R>, JsError> {
        let rows = residual.rows();
        let mut task = Task::new(residual);
        if let Some(name) = self.name {
            task = task.named(name);
        }
        for row in rows {
            if let Some(weight) = self.weight {
                task = task.weight(row.quantity, weight);
            }
            if let Some(tolerance) = self.tolerance {
                task = task.tolerance(row.quantity, tolerance);
            }
        }
        match self.role.as_deref() {
            None => {}
            Some("goal") => task = task.goal(),
            Some("preference") => task = task.preference(),
            Some(other) => {
                let roles = ["goal", "preference"];
                return Err(raise(UnknownName::new("role", other, roles)));
            }
        }
        if let Some(scale) = self.scale {
            task = task.scale(scale);
        }
        Ok(task.at_level(self.level.unwrap_or(0) as usize))
    }
}
