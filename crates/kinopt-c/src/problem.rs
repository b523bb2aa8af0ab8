//! Problems: tasks on the frames and joints of a robot.

use std::ffi::{CString, c_char};
use std::sync::Arc;

use kinopt::Model;
use kinopt::model::{Limits, Masses, UnknownName};
use kinopt::problem::ProblemBuilder;
use kinopt::robot::Robot;
use kinopt::task::Quantity;
use kinopt_bindings::names::{PREFERENCES, named};
use kinopt_bindings::parameters;
use kinopt_bindings::problem::NamedProblem;
use kinopt_bindings::task::{
    AddBounded, AddTask, BoxedTask, COMMON_OPTIONS, KINDS, TaskModel, TaskOptions, residual,
};
use kinopt_bindings::{OrRaise, Value};
use serde_json::{Map, Value as Json};

use crate::error::{Failure, KinoptStatus, guard, of_json};
use crate::pointer;
use crate::robot::KinoptRobot;
use crate::settings::settings;
use crate::world::{KinoptCollisionModel, KinoptWorld};

/// Options of a problem.
const OPTIONS: [&str; 6] = [
    "tolerance",
    "preferences",
    "bounds",
    "locked",
    "only",
    "held",
];

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
        let settings = self::settings(settings, "option of a problem", &OPTIONS)?;
        let tasks = serde_json::from_str(pointer::text(tasks, "tasks")?)?;
        let Json::Array(tasks) = tasks else {
            return Err(Failure::invalid(
                "`tasks` is not a JSON list of tasks".to_owned(),
            ));
        };
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
        configure(&mut builder, robot, &settings).map_err(of_json)?;
        let added = tasks.into_iter().enumerate().map(|(index, task)| {
            add(task, robot, &mut builder).map_err(|error| {
                let message = format!("tasks[{index}]: {error}");
                of_json(kinopt_bindings::json::JsonError { message, ..error })
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

type JsonResult<T> = Result<T, kinopt_bindings::json::JsonError>;

/// Applies the settings of a problem.
fn configure(
    builder: &mut ProblemBuilder<'_>,
    robot: &Arc<Robot>,
    settings: &Map<String, Json>,
) -> JsonResult<()> {
    let (model, get) = (robot.model(), |name: &str| settings.get(name));
    let locked = get("locked").map_or(Ok(Vec::new()), |value| value.entries("locked"))?;
    let only = get("only").map(|value| value.names("only")).transpose()?;
    let held = get("held").map(|value| value.numbers("held")).transpose()?;
    let what = |name: &str| format!("locked.{name}");
    let map = parameters::lock(robot.parameters(), model, locked, what)?;
    let map = parameters::only::<Json>(map, model, only.as_deref(), ("held", held))?;
    builder.parameters(map.build().or_raise::<Json>()?);
    let bounds = get("bounds").map_or(Ok(Vec::new()), |value| value.ranges("bounds"))?;
    for (name, (lower, upper)) in bounds {
        let joint = model.joint(&name).or_raise::<Json>()?;
        builder.bound(joint, Limits::new(lower, upper));
    }
    if let Some(tolerance) = get("tolerance") {
        let tolerance = tolerance.number("tolerance")?;
        builder.tolerance(Quantity::Metres, tolerance);
        builder.tolerance(Quantity::Radians, tolerance);
    }
    if let Some(preferences) = get("preferences") {
        let name = preferences.name("preferences")?;
        builder.preferences(named("preferences", &name, &PREFERENCES).or_raise::<Json>()?);
    }
    Ok(())
}

/// Kind, common options and arguments of a task.
fn read(task: Json) -> JsonResult<(&'static str, TaskOptions, Map<String, Json>)> {
    let invalid =
        |message: &str| Json::error(kinopt_bindings::ErrorKind::InvalidValue, message.to_owned());
    let Json::Object(mut arguments) = task else {
        return Err(invalid("is not an object that describes a task"));
    };
    let Some(Json::String(given)) = arguments.remove("kind") else {
        return Err(invalid("has no `kind`"));
    };
    let kinds = KINDS.iter().map(|(kind, _)| *kind);
    let Some((kind, options)) = KINDS.iter().find(|(kind, _)| *kind == given) else {
        return Err(UnknownName::new("kind of task", &given, kinds)).or_raise::<Json>();
    };
    let known = COMMON_OPTIONS.iter().chain(*options);
    if let Some(name) = arguments
        .keys()
        .find(|name| known.clone().all(|known| known != name))
    {
        return Err(UnknownName::new("option of a task", name, known.copied())).or_raise::<Json>();
    }
    Ok((kind, TaskOptions::of(&arguments)?, arguments))
}

/// Adds a task.
fn add(task: Json, robot: &Robot, builder: &mut ProblemBuilder<'_>) -> JsonResult<BoxedTask<Json>> {
    let model: &Model = robot.model();
    let masses = || Masses::new(model, []).or_raise::<Json>();
    let on = TaskModel {
        model,
        masses: &masses,
    };
    let (kind, options, arguments) = read(task)?;
    if kind != "bounded" {
        return residual(&arguments, &on, kind, AddTask { builder, options });
    }
    let (inner_kind, inner_options, inner) =
        read(arguments.get("task").cloned().unwrap_or_default())?;
    if inner_kind == "bounded" {
        let message = "nested `bounded`: use one interval instead".to_owned();
        return Err(Json::error(
            kinopt_bindings::ErrorKind::InvalidValue,
            message,
        ));
    }
    let end = |name: &str, default| match arguments.get(name) {
        Some(value) => value.number(name),
        None => Ok(default),
    };
    let bounded = AddBounded {
        lower: end("lower", f64::NEG_INFINITY)?,
        upper: end("upper", f64::INFINITY)?,
        add: AddTask {
            builder,
            options: options.or(inner_options),
        },
    };
    residual(&inner, &on, inner_kind, bounded)
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
    let name = problem.ok().and_then(|problem| problem.names.get(index));
    name.map_or(std::ptr::null(), |name| name.as_ptr())
}
