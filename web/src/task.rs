//! Tasks as plain objects, converted to residuals of the library.

use kinopt::model::UnknownName;
use kinopt::problem::ProblemBuilder;
use kinopt_bindings::task::{self, AddTask, COMMON_OPTIONS, KINDS, TaskModel, TaskOptions};
use wasm_bindgen::prelude::*;

use crate::arguments::NamedArguments;
use crate::error::{Exception, raise};
use crate::masses::masses_of;
use crate::model::Model;
use crate::names::camel;
use crate::value::Value;

/// A task of a problem, with a target that can be moved.
pub(crate) type BoxedTask = task::BoxedTask<Value>;

/// A task with its kind.
struct TaskObject {
    kind: &'static str,
    options: NamedArguments,
}

impl TaskObject {
    fn new(task: JsValue) -> Result<Self, Exception> {
        let kind = js_sys::Reflect::get(&task, &"kind".into());
        let kind = kind.ok().and_then(|kind| kind.as_string());
        let kind =
            kind.ok_or_else(|| Exception::new("a task is an object with a kind: see `tasks`"))?;
        let Some((kind, names)) = KINDS.iter().find(|(known, _)| camel(known) == kind) else {
            let kinds = KINDS.map(|(known, _)| camel(known));
            let kinds = kinds.iter().map(String::as_str);
            return Err(raise(UnknownName::new("kind of task", &kind, kinds)));
        };
        let known = ["kind"].iter().chain(&COMMON_OPTIONS).chain(*names);
        let options = NamedArguments::of(Some(task), "option of a task", known.copied())?;
        Ok(Self { kind, options })
    }
}

/// Adds a task to a problem.
pub(crate) fn add(
    task: JsValue,
    model: &Model,
    builder: &mut ProblemBuilder<'_>,
) -> Result<BoxedTask, Exception> {
    let on = TaskModel {
        model: &model.inner,
        masses: &|| masses_of(model),
    };
    let TaskObject { kind, options } = TaskObject::new(task)?;
    let add = AddTask {
        builder,
        options: TaskOptions::of(&options)?,
    };
    match kind {
        "bounded" => add_bounded(&options, &on, add),
        _ => task::residual(&options, &on, kind, add),
    }
}

/// Adds the inner task with its interval.
fn add_bounded(
    outer: &NamedArguments,
    on: &TaskModel<'_, Value>,
    add: AddTask<'_, ProblemBuilder<'_>>,
) -> Result<BoxedTask, Exception> {
    let inner = outer.get("task").unwrap_or(JsValue::UNDEFINED);
    let TaskObject { kind, options } = TaskObject::new(inner)?;
    task::bounded(outer, (kind, &options), on, add)
}
