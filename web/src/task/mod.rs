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

use crate::given::Given;
use crate::model::Model;
use crate::raise;
use target::Target;
pub(crate) use target::{Aimed, Stated};

/// Common keys of all tasks.
const OF_ALL: [&str; 7] = [
    "kind",
    "name",
    "weight",
    "scale",
    "tolerance",
    "role",
    "level",
];

/// A task of a problem, with a target that can be moved.
pub(crate) type BoxedTask = Box<dyn Stated>;

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
    let given = residual::given(task, &kind)?;
    let adding = Adding {
        builder,
        about: About::of(&given)?,
    };
    residual::read(&given, model, &kind, adding)
}

fn kind(task: &JsValue) -> Result<String, JsError> {
    let kind = js_sys::Reflect::get(task, &"kind".into());
    let kind = kind.ok().and_then(|kind| kind.as_string());
    kind.ok_or_else(|| JsError::new("a task is an object with a kind: see `tasks`"))
}

/// Common keys, and those of one kind.
fn known<'a>(own: &[&'a str]) -> Vec<&'a str> {
    OF_ALL.iter().chain(own).copied().collect()
}

/// Generic function of a residual.
trait Visit {
    fn visit<R: Target>(self, residual: R) -> Result<BoxedTask, JsError>;
}

struct Adding<'a, 'm> {
    builder: &'a mut ProblemBuilder<'m>,
    about: About,
}

impl Visit for Adding<'_, '_> {
    fn visit<R: Target>(self, residual: R) -> Result<BoxedTask, JsError> {
        let task = self.about.task(residual)?;
        let id: TaskId<R> = self.builder.add(task);
        Ok(Box::new(id))
    }
}

/// Common options of a task.
#[derive(Default)]
struct About {
    name: Option<String>,
    weight: Option<f64>,
    scale: Option<f64>,
    tolerance: Option<f64>,
    role: Option<String>,
    level: Option<u32>,
}

impl About {
    fn of(given: &Given) -> Result<Self, JsError> {
        Ok(Self {
            name: given.text("name")?,
            weight: given.number("weight")?,
            scale: given.number("scale")?,
            tolerance: given.number("tolerance")?,
            role: given.text("role")?,
            level: given.whole("level")?,
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
