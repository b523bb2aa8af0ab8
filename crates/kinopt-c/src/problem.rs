//! Problems: tasks on the frames and joints of a robot.

use std::ffi::{CString, c_char};

use kinopt::model::UnknownName;
use kinopt::problem::ProblemBuilder;
use kinopt::robot::Robot;
use kinopt_bindings::json::JsonError;
use kinopt_bindings::problem::NamedProblem;
use kinopt_bindings::task::{
    AddTask, BoxedTask, COMMON_OPTIONS, KINDS, TaskModel, TaskOptions, bounded, residual,
};
use kinopt_bindings::{ErrorKind, OrRaise, Value, parameters};
use serde_json::{Map, Value as Json};

use crate::error::{Failure, KinoptStatus, guard, of_json};
use crate::pointer;
use crate::robot::KinoptRobot;
use crate::settings::{check_names, settings};
use crate::world::{KinoptCollisionModel, KinoptWorld};

/// Tasks on a robot, checked and compiled. It is immutable.
pub struct KinoptProblem {
    pub(crate) inner: NamedProblem<Json>,
    names: Vec<CString>,
}

/// Creates a problem from a JSON list of tasks.
///
/// A task is an object with its `kind` and the options of `docs/reference/options.md`:
/// `[{"kind": "pose", "frame": "left_hand", "target": [[…], …]}, {"kind": "posture", "reference": [0, …], "weight": 0.01}]`.
/// A placement has four rows of four numbers. `settings`: `tolerance`, `preferences`, `bounds`, `locked`, `only`, `held`.
///
/// With a collision model and a world the configurations avoid collisions by `margin` metres; both null for none.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_problem_new(
    robot: *const KinoptRobot,
    tasks: *const c_char,
    collision_model: *const KinoptCollisionModel,
    world: *const KinoptWorld,
    margin: f64,
    settings: *const c_char,
    problem: *mut *mut KinoptProblem,
) -> KinoptStatus {
    guard(|| unsafe {
        let robot = &pointer::object(robot, "robot")?.inner;
        let known = [kinopt_bindings::problem::OPTIONS, parameters::OPTIONS].concat();
        let settings = self::settings(settings, "option of a problem", &known, &[])?;
        let tasks: Vec<Json> =
            serde_json::from_str(pointer::text(tasks, "tasks")?).map_err(|error| {
                Failure::invalid(format!("`tasks` is no JSON list of tasks: {error}"))
            })?;
        let model = pointer::optional_object(collision_model, "collision_model")?;
        let world = pointer::optional_object(world, "world")?;
        let checker = match (model, world) {
            (Some(model), Some(world)) => Some(model.checker(world, margin)?),
            (None, None) => None,
            _ => {
                let message = "`collision_model` and `world` belong together: one of them is null";
                return Err(Failure::invalid(message.to_owned()));
            }
        };
        let mut builder = kinopt::Problem::builder(robot.model());
        let map = parameters::apply(robot.parameters(), robot.model(), &settings);
        builder.parameters(map.map_err(of_json)?.build()?);
        kinopt_bindings::problem::apply(&mut builder, robot.model(), &settings).map_err(of_json)?;
        let added = tasks.into_iter().enumerate().map(|(index, task)| {
            add(task, robot, &mut builder).map_err(|error| {
                let message = format!("tasks[{index}]: {error}");
                of_json(JsonError { message, ..error })
            })
        });
        let added = added.collect::<Result<Vec<_>, _>>()?;
        if let Some(checker) = &checker {
            builder.keep_clear(checker);
        }
        let inner = NamedProblem::new(builder.build()?, added);
        let names = inner.task_names().map(pointer::kept_text).collect();
        pointer::give(problem, KinoptProblem { inner, names }, "problem")
    })
}

/// Kind and arguments of a task.
fn read(task: Json) -> Result<(&'static str, Map<String, Json>), JsonError> {
    let invalid = |message: &str| Json::error(ErrorKind::InvalidValue, message.to_owned());
    let Json::Object(mut arguments) = task else {
        return Err(invalid("is not an object that describes a task"));
    };
    let Some(Json::String(given)) = arguments.remove("kind") else {
        return Err(invalid("has no `kind`"));
    };
    let Some((kind, options)) = KINDS.iter().find(|(kind, _)| *kind == given) else {
        let kinds = KINDS.iter().map(|(kind, _)| *kind);
        return Err(UnknownName::new("kind of task", &given, kinds)).or_raise::<Json>();
    };
    let known = [&COMMON_OPTIONS[..], options].concat();
    check_names(&arguments, "option of a task", &known)?;
    Ok((kind, arguments))
}

/// Adds a task.
fn add(
    task: Json,
    robot: &Robot,
    builder: &mut ProblemBuilder<'_>,
) -> Result<BoxedTask<Json>, JsonError> {
    let model = robot.model();
    let masses = || robot.masses().or_raise::<Json>();
    let on = TaskModel {
        model,
        masses: &masses,
    };
    let (kind, arguments) = read(task)?;
    let options = TaskOptions::of(&arguments)?;
    let add = AddTask { builder, options };
    match kind {
        "bounded" => {
            let (kind, inner) = read(arguments.get("task").cloned().unwrap_or_default())?;
            bounded(&arguments, (kind, &inner), &on, add)
        }
        _ => residual(&arguments, &on, kind, add),
    }
}

/// Frees a problem.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_problem_free(problem: *mut KinoptProblem) {
    unsafe { pointer::free(problem) }
}

/// Number of tasks; 0 for null.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_problem_task_count(problem: *const KinoptProblem) -> usize {
    let problem = unsafe { pointer::object(problem, "problem") };
    problem.map_or(0, |problem| problem.names.len())
}

/// Name of a task, for targets, valid as long as the problem; null for an index out of range.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn kinopt_problem_task_name(
    problem: *const KinoptProblem,
    index: usize,
) -> *const c_char {
    let problem = unsafe { pointer::object(problem, "problem") };
    pointer::text_at(problem.map_or(&[], |problem| &problem.names), index)
}
