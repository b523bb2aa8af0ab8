//! Tasks by kind: conversion of named arguments to residuals of the library.

#[cfg(feature = "bodies")]
mod body;
mod joints;
mod options;
mod residual;
mod target;

use kinopt::Model;
use kinopt::model::Masses;
use kinopt::problem::{ProblemBuilder, TaskId};
#[cfg(feature = "bodies")]
use kinopt::task::Bounded;
use kinopt::task::Task;

pub use options::TaskOptions;
pub use residual::residual;
pub use target::{Aimed, AnyTask, Goal, Move, NoTarget, NumericTarget, Target, moved};

#[cfg(feature = "bodies")]
use crate::error::ErrorKind;
use crate::value::Value;
#[cfg(feature = "bodies")]
use crate::value::{Arguments, ErrorOf};

/// Options of all tasks.
pub const COMMON_OPTIONS: [&str; 6] = ["name", "weight", "scale", "tolerance", "role", "level"];

/// Kinds of tasks, with their options in addition to the common ones. A bounded task wraps one of the others.
pub const KINDS: [(&str, &[&str]); 18] = [
    ("point", &["frame", "target", "at", "base"]),
    ("pose", &["frame", "target", "tool", "goal", "base"]),
    ("orientation", &["frame", "target", "base"]),
    ("look at", &["frame", "axis", "target"]),
    (
        "gaze",
        &["frame", "axis", "half_angle", "target", "direction"],
    ),
    ("distance", &["a", "b", "distance"]),
    ("plane", &["frame", "point", "normal"]),
    ("ray", &["frame", "eye", "through"]),
    ("pixel", &["frame", "camera", "target"]),
    ("posture", &["reference", "joint_weights"]),
    ("smoothness", &["previous", "time_step", "joint_weights"]),
    ("limit centring", &[]),
    ("center of mass", &["target", "free", "base", "masses"]),
    (
        "support polygon",
        &["points", "on", "margin", "up", "masses"],
    ),
    (
        "frame velocity",
        &["frame", "previous", "time_step", "linear", "angular"],
    ),
    ("joint coupling", &["coefficients", "offset"]),
    ("manipulability", &["frame", "least", "base", "of"]),
    ("bounded", &["task", "lower", "upper"]),
];

/// Model of a task.
pub struct TaskModel<'a, V: Value> {
    /// The model.
    pub model: &'a Model,
    /// Masses of the body, for tasks that state none.
    pub masses: &'a dyn Fn() -> Result<Masses, V::Error>,
}

/// A task of a problem with any residual.
pub type BoxedTask<V> = Box<dyn AnyTask<V>>;

/// Object that accepts tasks.
pub trait TaskBuilder<V: Value> {
    /// Adds a task; `residual` is its residual.
    ///
    /// # Errors
    /// If the object has invalid values for the task.
    fn add_task<R>(&mut self, task: Task<R>, residual: R) -> Result<BoxedTask<V>, V::Error>
    where
        R: Target,
        R::Goal: Goal<V>;
}

impl<V: Value + 'static> TaskBuilder<V> for ProblemBuilder<'_> {
    fn add_task<R>(&mut self, task: Task<R>, _: R) -> Result<BoxedTask<V>, V::Error>
    where
        R: Target,
        R::Goal: Goal<V>,
    {
        let id: TaskId<R> = self.add(task);
        Ok(Box::new(id))
    }
}

/// Generic function of a residual.
pub trait Visit<V: Value> {
    /// Calls the function.
    ///
    /// # Errors
    /// Those of the function.
    fn visit<R>(self, residual: R) -> Result<BoxedTask<V>, V::Error>
    where
        R: Target,
        R::Goal: Goal<V>;
}

/// Adds the residual as a task.
pub struct AddTask<'a, B> {
    /// Receiver of the task.
    pub builder: &'a mut B,
    /// Options of the task.
    pub options: TaskOptions,
}

impl<V: Value, B: TaskBuilder<V>> Visit<V> for AddTask<'_, B> {
    fn visit<R>(self, residual: R) -> Result<BoxedTask<V>, V::Error>
    where
        R: Target,
        R::Goal: Goal<V>,
    {
        let initial = residual.clone();
        self.builder.add_task(self.options.task(residual), initial)
    }
}

/// Adds the residual with an interval that costs nothing.
#[cfg(feature = "bodies")]
pub struct AddBounded<'a, B> {
    /// Lower end of the interval, in the unit of each row.
    pub lower: f64,
    /// Upper end of the interval, in the unit of each row.
    pub upper: f64,
    /// Adds the bounded residual.
    pub add: AddTask<'a, B>,
}

#[cfg(feature = "bodies")]
impl<V: Value, B: TaskBuilder<V>> Visit<V> for AddBounded<'_, B> {
    fn visit<R>(self, residual: R) -> Result<BoxedTask<V>, V::Error>
    where
        R: Target,
        R::Goal: Goal<V>,
    {
        self.add
            .visit(Bounded::between(residual, self.lower, self.upper))
    }
}

/// Adds a task of a kind with an interval that costs nothing, `lower` to `upper` of the arguments `outer`.
///
/// # Errors
/// If the task is bounded itself, or an argument is missing or has another type.
#[cfg(feature = "bodies")]
pub fn bounded<A: Arguments>(
    outer: &A,
    (kind, inner): (&str, &A),
    on: &TaskModel<'_, A::Value>,
    add: AddTask<'_, ProblemBuilder<'_>>,
) -> Result<BoxedTask<A::Value>, ErrorOf<A>>
where
    A::Value: 'static,
{
    if kind == "bounded" {
        let message = "nested `bounded`: use one interval instead".to_owned();
        return Err(A::Value::error(ErrorKind::InvalidValue, message));
    }
    let bounded = AddBounded {
        lower: outer.number_or("lower", f64::NEG_INFINITY)?,
        upper: outer.number_or("upper", f64::INFINITY)?,
        add: AddTask {
            builder: add.builder,
            options: add.options.or(TaskOptions::of(inner)?),
        },
    };
    residual(inner, on, kind, bounded)
}
