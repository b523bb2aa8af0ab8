//! Tasks of Python, converted to residuals of the library.

use kinopt::Model;
use kinopt::task::{Numeric, Quantity};
use kinopt_bindings::Arguments;
use kinopt_bindings::task::{
    AddBounded, AddTask, BoxedTask, TaskBuilder, TaskModel, TaskOptions, Visit,
};
use pyo3::prelude::*;

use super::python_residual::PythonResidual;
use crate::error::invalid;
use crate::masses::masses_of;
use crate::object::{Fields, Object, no_task, quantity_values};

/// Adds a task of `kinopt.tasks` to a problem on `model`, the model of `python_model`.
pub(crate) fn add<B: TaskBuilder<Object>>(
    task: &Bound<'_, PyAny>,
    python_model: &Bound<'_, PyAny>,
    model: &Model,
    builder: &mut B,
) -> PyResult<BoxedTask<Object>> {
    let (kind, fields) = (check(task)?, Fields(task));
    let options = TaskOptions::of(&fields)?;
    let add = AddTask { builder, options };
    let on = TaskModel {
        model,
        masses: &|| masses_of(python_model),
    };
    if kind != "bounded" {
        return residual(task, &on, add);
    }
    let (lower, upper) = (fields.number("lower")?, fields.number("upper")?);
    let bounded = AddBounded { lower, upper, add };
    residual(&task.getattr("task")?, &on, bounded)
}

/// Returns the kind of a task; an error for any other object.
pub(super) fn check(task: &Bound<'_, PyAny>) -> PyResult<String> {
    match task.getattr_opt("_kind")? {
        Some(kind) => kind.extract(),
        None => Err(no_task(task)?),
    }
}

/// Converts the residual of a task that wraps no other task.
fn residual(
    task: &Bound<'_, PyAny>,
    on: &TaskModel<'_, Object>,
    visitor: impl Visit<Object>,
) -> PyResult<BoxedTask<Object>> {
    let kind = check(task)?;
    match kind.as_str() {
        "custom" => visitor.visit(Numeric(PythonResidual::of(task, on.model)?)),
        "bounded" => Err(invalid("nested `Bounded`: use one interval instead")),
        kind => kinopt_bindings::task::residual(&Fields(task), on, kind, visitor),
    }
}

/// Reads a tolerance of metres and radians, or one for each quantity.
pub(crate) fn tolerances(value: &Bound<'_, PyAny>) -> PyResult<Vec<(Quantity, f64)>> {
    Ok(quantity_values(value, "tolerance")?.by([Quantity::Metres, Quantity::Radians]))
}
