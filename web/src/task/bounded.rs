//! Tasks with an interval that costs nothing.

use kinopt::problem::ProblemBuilder;
use kinopt::task::Bounded;
use wasm_bindgen::prelude::*;

use super::target::Target;
use super::{About, Adding, BoxedTask, Visit, known, residual};
use crate::given::Given;
use crate::model::Model;

/// Adds the inner task with its interval.
pub(super) fn add(
    task: JsValue,
    model: &Model,
    builder: &mut ProblemBuilder<'_>,
) -> Result<BoxedTask, JsError> {
    let around = Given::new(task, "part of a task", &known(&["task", "lower", "upper"]))?;
    let inner = around.get("task").unwrap_or(JsValue::UNDEFINED);
    let kind = super::kind(&inner)?;
    if kind == "bounded" {
        let message = "nested `bounded`: use one interval instead";
        return Err(JsError::new(message));
    }
    let given = residual::given(inner, &kind)?;
    let room = Room {
        lower: around.number("lower")?.unwrap_or(f64::NEG_INFINITY),
        upper: around.number("upper")?.unwrap_or(f64::INFINITY),
        adding: Adding {
            builder,
            about: About::of(&around)?.or(About::of(&given)?),
        },
    };
    residual::read(&given, model, &kind, room)
}

struct Room<'a, 'm> {
    lower: f64,
    upper: f64,
    adding: Adding<'a, 'm>,
}

impl Visit for Room<'_, '_> {
    fn visit<R: Target>(self, residual: R) -> Result<BoxedTask, JsError> {
        let room = Bounded::between(residual, self.lower, self.upper);
        self.adding.visit(room)
    }
}

impl About {
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
