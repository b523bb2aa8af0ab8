//! Tasks with an interval that costs nothing.

use kinopt::problem::ProblemBuilder;
use kinopt::task::Bounded;
use wasm_bindgen::prelude::*;

use super::target::Target;
use super::{Adding, BoxedTask, CommonOptions, Visit, known, residual};
use crate::arguments::NamedArguments;
use crate::model::Model;

/// Adds the inner task with its interval.
pub(super) fn add(
    task: JsValue,
    model: &Model,
    builder: &mut ProblemBuilder<'_>,
) -> Result<BoxedTask, JsError> {
    let outer = NamedArguments::new(
        task,
        "option of a task",
        &known(&["task", "lower", "upper"]),
    )?;
    let inner = outer.get("task").unwrap_or(JsValue::UNDEFINED);
    let kind = super::kind(&inner)?;
    if kind == "bounded" {
        let message = "nested `bounded`: use one interval instead";
        return Err(JsError::new(message));
    }
    let options = residual::task_options(inner, &kind)?;
    let bounded = BoundedVisitor {
        lower: outer.number("lower")?.unwrap_or(f64::NEG_INFINITY),
        upper: outer.number("upper")?.unwrap_or(f64::INFINITY),
        adding: Adding {
            builder,
            common: CommonOptions::of(&outer)?.or(CommonOptions::of(&options)?),
        },
    };
    residual::read(&options, model, &kind, bounded)
}

struct BoundedVisitor<'a, 'm> {
    lower: f64,
    upper: f64,
    adding: Adding<'a, 'm>,
}

impl Visit for BoundedVisitor<'_, '_> {
    fn visit<R: Target>(self, residual: R) -> Result<BoxedTask, JsError> {
        let bounded = Bounded::between(residual, self.lower, self.upper);
        self.adding.visit(bounded)
    }
}

impl CommonOptions {
    /// Fills missing options from another struct.
    fn or(self, other: Self) -> Self {
        Self {
            name: self.name.or(other.name),
            weight: self.weight.or(other.weight),
            scale: self.scale.or(other.scale),
            tolerance: self.tolerance.or(other.tolerance),
            role: self.role.or(other.role),
            level: self.level.or(other.level),
        }
    }
}
