//! Tasks as plain objects, read into residuals of the library, and their targets.

use kinopt::ik::Drag;
use kinopt::model::{FrameId, UnknownName};
use kinopt::problem::{ProblemBuilder, ProblemError, Targets, TaskId};
use kinopt::task::{
    LimitCentring, LookAt, Orientation, Plane, Point, Pose, Posture, Ray, Residual, Task,
};
use wasm_bindgen::prelude::*;

use crate::given::{self, Given};
use crate::model::Model;
use crate::{placement, raise};

/// What every task may say.
const OF_ALL: [&str; 7] = [
    "kind",
    "name",
    "weight",
    "times",
    "tolerance",
    "role",
    "level",
];
const KINDS: [&str; 8] = [
    "point",
    "pose",
    "orientation",
    "lookAt",
    "plane",
    "ray",
    "posture",
    "limitCentring",
];

/// What has targets to move.
pub(crate) enum Aimed<'a> {
    Targets(&'a mut Targets),
    Drag(&'a mut Drag),
}

impl Aimed<'_> {
    fn residual<R: Residual>(&mut self, task: TaskId<R>) -> Result<&mut R, ProblemError> {
        match self {
            Self::Targets(targets) => targets.get_mut(task),
            Self::Drag(drag) => drag.target_mut(task),
        }
    }
}

/// A task of a problem.
pub(crate) enum Stated {
    Point(TaskId<Point>),
    Pose(TaskId<Pose>),
    Orientation(TaskId<Orientation>),
    LookAt(TaskId<LookAt>),
    Plane(TaskId<Plane>),
    Ray(TaskId<Ray>),
    Posture(TaskId<Posture>),
    Untargeted,
}

impl Stated {
    /// Moves the target of a task, of which messages speak as `what`. Numbers that are not finite and matrices that are
    /// no rotation leave it where it is.
    pub(crate) fn aim(
        &self,
        aimed: &mut Aimed<'_>,
        value: &JsValue,
        what: &str,
    ) -> Result<(), JsError> {
        match self {
            Self::Point(id) => {
                let target = given::vector::<3>(value, what)?;
                moved(aimed, *id, what, |own| own.set_target(target))
            }
            Self::Pose(id) => {
                let target = placement::read(&given::numbers(value, what)?, what)?;
                moved(aimed, *id, what, |own| own.set_target(target))
            }
            Self::Orientation(id) => {
                let target = placement::read(&given::numbers(value, what)?, what)?;
                moved(aimed, *id, what, |own| own.set_target(target.rotation))
            }
            Self::LookAt(id) => {
                let target = given::vector::<3>(value, what)?;
                moved(aimed, *id, what, |own| own.set_target(target))
            }
            Self::Plane(id) => {
                let [point, normal] = two(given::vector::<6>(value, what)?);
                moved(aimed, *id, what, |own| own.set_plane(point, normal))
            }
            Self::Ray(id) => {
                let [eye, through] = two(given::vector::<6>(value, what)?);
                moved(aimed, *id, what, |own| own.set_line(eye, through))
            }
            Self::Posture(id) => {
                let reference = given::numbers(value, what)?;
                let own = aimed.residual(*id).map_err(raise)?;
                let asked = own.joint_values().unwrap_or(reference.len());
                if reference.len() != asked {
                    let count = reference.len();
                    let message = format!("{what} has {count} numbers, expected {asked}");
                    return Err(JsError::new(&message));
                }
                moved(aimed, *id, what, |own| own.set_reference(&reference))
            }
            Self::Untargeted => Err(JsError::new(&format!("{what}: this task has no target"))),
        }
    }
}

fn two([a, b, c, d, e, f]: [f64; 6]) -> [[f64; 3]; 2] {
    [[a, b, c], [d, e, f]]
}

fn moved<R: Residual>(
    aimed: &mut Aimed<'_>,
    id: TaskId<R>,
    what: &str,
    set: impl FnOnce(&mut R),
) -> Result<(), JsError> {
    let own = aimed.residual(id).map_err(raise)?;
    let mut moved = own.clone();
    set(&mut moved);
    let checked = moved.validate();
    checked.map_err(|error| JsError::new(&format!("{what}: {error}")))?;
    *own = moved;
    Ok(())
}

/// Adds a task to a problem.
pub(crate) fn add(
    task: JsValue,
    model: &Model,
    builder: &mut ProblemBuilder<'_>,
) -> Result<Stated, JsError> {
    let kind = js_sys::Reflect::get(&task, &"kind".into());
    let kind = kind.ok().and_then(|kind| kind.as_string());
    let Some(kind) = kind else {
        return Err(JsError::new("a task is an object with a kind: see `tasks`"));
    };
    let own: &[&str] = match kind.as_str() {
        "point" => &["frame", "target", "at", "base"],
        "pose" => &["frame", "target", "tool", "goal", "base"],
        "orientation" => &["frame", "target", "base"],
        "lookAt" => &["frame", "axis", "target"],
        "plane" => &["frame", "point", "normal"],
        "ray" => &["frame", "eye", "through"],
        "posture" => &["reference"],
        "limitCentring" => &[],
        other => return Err(raise(UnknownName::new("kind of task", other, KINDS))),
    };
    let known: Vec<&str> = OF_ALL.iter().chain(own).copied().collect();
    let given = Given::new(task, "part of a task", &known)?;
    let frame = |name: &str| frame(model, &given.name(name)?);
    let base = || match given.text("base")? {
        Some(base) => self::frame(model, &base).map(Some),
        None => Ok::<_, JsError>(None),
    };
    Ok(match kind.as_str() {
        "point" => {
            let mut point = Point::new(frame("frame")?, given.vector::<3>("target")?);
            if given.get("at").is_some() {
                point = point.at(given.vector::<3>("at")?);
            }
            if let Some(base) = base()? {
                point = point.relative_to(base);
            }
            Stated::Point(stated(builder, &given, point)?)
        }
        "pose" => {
            let target = placement::read(&asked(&given, "target")?, "target")?;
            let mut pose = Pose::new(frame("frame")?, target);
            if let Some(tool) = given.placement("tool")? {
                pose = pose.with_tool(tool);
            }
            if let Some(goal) = given.get("goal") {
                pose = pose.with_goal(crate::arm::goal(&goal)?);
            }
            if let Some(base) = base()? {
                pose = pose.relative_to(base);
            }
            Stated::Pose(stated(builder, &given, pose)?)
        }
        "orientation" => {
            let target = placement::read(&asked(&given, "target")?, "target")?;
            let mut own = Orientation::new(frame("frame")?, target.rotation);
            if let Some(base) = base()? {
                own = own.relative_to(base);
            }
            Stated::Orientation(stated(builder, &given, own)?)
        }
        "lookAt" => {
            let axis = given.vector::<3>("axis")?;
            let own = LookAt::new(frame("frame")?, axis, given.vector::<3>("target")?);
            Stated::LookAt(stated(builder, &given, own)?)
        }
        "plane" => {
            let point = given.vector::<3>("point")?;
            let own = Plane::new(frame("frame")?, point, given.vector::<3>("normal")?);
            Stated::Plane(stated(builder, &given, own)?)
        }
        "ray" => {
            let eye = given.vector::<3>("eye")?;
            let own = Ray::new(frame("frame")?, eye, given.vector::<3>("through")?);
            Stated::Ray(stated(builder, &given, own)?)
        }
        "posture" => {
            let reference = asked(&given, "reference")?;
            let asked = model.inner.configuration_len();
            if reference.len() != asked {
                let count = reference.len();
                let message = format!("reference has {count} numbers, expected {asked}");
                return Err(JsError::new(&message));
            }
            let own = Posture::new(&model.inner, &reference);
            Stated::Posture(stated(builder, &given, own)?)
        }
        _ => {
            stated(builder, &given, LimitCentring::new(&model.inner))?;
            Stated::Untargeted
        }
    })
}

fn frame(model: &Model, name: &str) -> Result<FrameId, JsError> {
    model.inner.frame(name).map_err(raise)
}

fn asked(given: &Given, name: &str) -> Result<Vec<f64>, JsError> {
    let missing = || JsError::new(&format!("part of a task `{name}` is missing"));
    given.numbers(name)?.ok_or_else(missing)
}

/// A task of a residual, with what is said besides.
fn stated<R: Residual>(
    builder: &mut ProblemBuilder<'_>,
    given: &Given,
    residual: R,
) -> Result<TaskId<R>, JsError> {
    let rows = residual.rows();
    let mut task = Task::new(residual);
    if let Some(name) = given.text("name")? {
        task = task.named(name);
    }
    let (weight, tolerance) = (given.number("weight")?, given.number("tolerance")?);
    for row in rows {
        if let Some(weight) = weight {
            task = task.weight(row.quantity, weight);
        }
        if let Some(tolerance) = tolerance {
            task = task.tolerance(row.quantity, tolerance);
        }
    }
    match given.text("role")?.as_deref() {
        None => {}
        Some("goal") => task = task.goal(),
        Some("preference") => task = task.preference(),
        Some(other) => {
            let roles = ["goal", "preference"];
            return Err(raise(UnknownName::new("role", other, roles)));
        }
    }
    if let Some(times) = given.number("times")? {
        task = task.times(times);
    }
    Ok(builder.add(task.at_level(given.whole("level")?.unwrap_or(0) as usize)))
}
