//! Tasks of Python, converted to residuals of the library.

use kinopt::Model;
use kinopt::ik::Drag;
use kinopt::model::JointId;
use kinopt::problem::{ProblemBuilder, ProblemError, Targets, TaskId};
use kinopt::task::{
    Bounded, Distance, LimitCentring, LookAt, Numeric, Orientation, Pixel, Plane, Point, Pose,
    Posture, Quantity, Ray, Residual, Role, Smoothness, Task,
};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping, PyString};

use super::body_tasks;
use super::camera::Camera;
use super::python_residual::PythonResidual;
use super::target::Target;
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::goal::PoseBounds;
use crate::placement;
use crate::solution::quantity;

/// Object whose targets move.
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

/// A converted target, with the function that assigns it.
pub(crate) type Move = Box<dyn Fn(&mut Aimed<'_>) -> PyResult<()> + Send + Sync>;

/// A task of a problem, with any residual.
pub(crate) trait AnyTask: Send + Sync {
    /// Converts a target of the task; `what` names it in messages.
    fn read(&self, value: &Bound<'_, PyAny>, what: &str) -> PyResult<Move>;
}

impl<R: Target> AnyTask for TaskId<R> {
    fn read(&self, value: &Bound<'_, PyAny>, what: &str) -> PyResult<Move> {
        let (id, what) = (*self, what.to_owned());
        let target = R::read(value, &what)?;
        Ok(Box::new(move |aimed| {
            let residual = aimed.residual(id).or_raise()?;
            let mut moved = residual.clone();
            moved
                .aim(&target)
                .map_err(|problem| invalid(format!("{what} {problem}")))?;
            moved
                .validate()
                .map_err(|problem| invalid(format!("{what}: {problem}")))?;
            *residual = moved;
            Ok(())
        }))
    }
}

/// Object that accepts tasks.
pub(crate) trait TaskBuilder {
    /// Adds a task with the given residual.
    fn add_task<R: Target>(&mut self, task: Task<R>, residual: R) -> PyResult<Box<dyn AnyTask>>;
}

impl TaskBuilder for ProblemBuilder<'_> {
    fn add_task<R: Target>(&mut self, task: Task<R>, _: R) -> PyResult<Box<dyn AnyTask>> {
        Ok(Box::new(self.add(task)))
    }
}

/// Adds a task of `kinopt.tasks` to a problem on `model`, the model of `python_model`.
pub(crate) fn add<B: TaskBuilder>(
    task: &Bound<'_, PyAny>,
    python_model: &Bound<'_, PyAny>,
    model: &Model,
    builder: &mut B,
) -> PyResult<Box<dyn AnyTask>> {
    let options = TaskOptions::of(task)?;
    let kind = check(task)?;
    let add = TaskVisitor { builder, options };
    match kind.as_str() {
        "bounded" => {
            let lower = arrays::number(&task.getattr("lower")?, "lower")?;
            let upper = arrays::number(&task.getattr("upper")?, "upper")?;
            let bounded = BoundedVisitor { lower, upper, add };
            let task = &task.getattr("task")?;
            let arguments = TaskArguments {
                task,
                python_model,
                model,
            };
            residual(&arguments, bounded)
        }
        _ => residual(
            &TaskArguments {
                task,
                python_model,
                model,
            },
            add,
        ),
    }
}

/// Returns the kind of a task; an error for any other object.
pub(super) fn check(task: &Bound<'_, PyAny>) -> PyResult<String> {
    match task.getattr_opt("_kind")? {
        Some(kind) => kind.extract(),
        None => Err(invalid(format!(
            "tasks holds {}, which is no task of kinopt.tasks",
            task.repr()?
        ))),
    }
}

/// Generic function of a residual.
pub(super) trait ResidualVisitor {
    fn visit<R: Target>(self, residual: R) -> PyResult<Box<dyn AnyTask>>;
}

struct TaskVisitor<'a, B> {
    builder: &'a mut B,
    options: TaskOptions,
}

impl<B: TaskBuilder> ResidualVisitor for TaskVisitor<'_, B> {
    fn visit<R: Target>(self, residual: R) -> PyResult<Box<dyn AnyTask>> {
        let initial = residual.clone();
        self.builder.add_task(self.options.task(residual), initial)
    }
}

struct BoundedVisitor<'a, B> {
    lower: f64,
    upper: f64,
    add: TaskVisitor<'a, B>,
}

impl<B: TaskBuilder> ResidualVisitor for BoundedVisitor<'_, B> {
    fn visit<R: Target>(self, residual: R) -> PyResult<Box<dyn AnyTask>> {
        self.add
            .visit(Bounded::between(residual, self.lower, self.upper))
    }
}

/// Converts the residual of a task that wraps no other task.
fn residual<V: ResidualVisitor>(
    arguments: &TaskArguments<'_, '_>,
    visitor: V,
) -> PyResult<Box<dyn AnyTask>> {
    let TaskArguments { task, model, .. } = *arguments;
    let kind: String = task.getattr("_kind")?.extract()?;
    match kind.as_str() {
        "point" => {
            let mut point = Point::new(arguments.frame("frame")?, arguments.numbers("target")?);
            point = point.at(arguments.numbers::<3>("at")?);
            if let Some(base) = arguments.optional_frame("base")? {
                point = point.relative_to(base);
            }
            visitor.visit(point)
        }
        "pose" => {
            let target = placement::placement(&arguments.get("target")?, "target")?;
            let mut pose = Pose::new(arguments.frame("frame")?, target);
            if let Some(tool) = arguments.optional("tool")? {
                pose = pose.with_tool(placement::placement(&tool, "tool")?);
            }
            if let Some(goal) = arguments.optional("goal")? {
                pose = pose.with_goal(goal.cast::<PoseBounds>()?.get().inner);
            }
            if let Some(base) = arguments.optional_frame("base")? {
                pose = pose.relative_to(base);
            }
            visitor.visit(pose)
        }
        "orientation" => {
            let target = placement::rotation(&arguments.get("target")?, "target")?;
            let mut orientation = Orientation::new(arguments.frame("frame")?, target);
            if let Some(base) = arguments.optional_frame("base")? {
                orientation = orientation.relative_to(base);
            }
            visitor.visit(orientation)
        }
        "look-at" => {
            let (axis, target): ([f64; 3], [f64; 3]) =
                (arguments.numbers("axis")?, arguments.numbers("target")?);
            visitor.visit(LookAt::new(arguments.frame("frame")?, axis, target))
        }
        "distance" => {
            let distance = arrays::number(&arguments.get("distance")?, "distance")?;
            visitor.visit(Distance::new(
                arguments.frame("a")?,
                arguments.frame("b")?,
                distance,
            ))
        }
        "plane" => {
            let (point, normal): ([f64; 3], [f64; 3]) =
                (arguments.numbers("point")?, arguments.numbers("normal")?);
            visitor.visit(Plane::new(arguments.frame("frame")?, point, normal))
        }
        "ray" => {
            let (eye, through): ([f64; 3], [f64; 3]) =
                (arguments.numbers("eye")?, arguments.numbers("through")?);
            visitor.visit(Ray::new(arguments.frame("frame")?, eye, through))
        }
        "pixel" => {
            let camera = arguments.get("camera")?.cast::<Camera>()?.get().inner;
            let target = arguments.numbers("target")?;
            visitor.visit(Pixel::new(arguments.frame("frame")?, camera, target))
        }
        "posture" => {
            let posture = arguments.posture()?;
            visitor.visit(match arguments.joint_weights(&posture.joints())? {
                None => posture,
                Some(JointWeights::ByRange) => posture.by_range(model),
                Some(JointWeights::Upright) => posture.upright(model),
                Some(JointWeights::Given(weights)) => posture.with_weights(weights),
            })
        }
        "smoothness" => {
            let previous = arguments.get("previous")?;
            let dof = model.configuration_len();
            let previous = arrays::vector_of(&previous, "previous", dof)?;
            let time_step_s = arrays::number(&arguments.get("time_step_s")?, "time_step_s")?;
            let smoothness = Smoothness::new(model, &previous, time_step_s);
            visitor.visit(match arguments.joint_weights(&smoothness.joints())? {
                None => smoothness,
                // The class accepts no other text.
                Some(JointWeights::ByRange | JointWeights::Upright) => smoothness.by_range(model),
                Some(JointWeights::Given(weights)) => smoothness.with_weights(weights),
            })
        }
        "limit centring" => visitor.visit(LimitCentring::new(model)),
        "custom" => visitor.visit(Numeric(PythonResidual::of(task, model)?)),
        "bounded" => Err(invalid("nested `Bounded`: use one interval instead")),
        kind => body_tasks::residual(arguments, kind, visitor),
    }
}

/// Attributes of a task, with its model.
pub(super) struct TaskArguments<'a, 'py> {
    pub(super) task: &'a Bound<'py, PyAny>,
    /// Robot, rig, skeleton or model of the problem.
    pub(super) python_model: &'a Bound<'py, PyAny>,
    pub(super) model: &'a Model,
}

/// Weights of the joints of a posture.
enum JointWeights {
    ByRange,
    Upright,
    Given(Vec<f64>),
}

impl<'py> TaskArguments<'_, 'py> {
    pub(super) fn get(&self, name: &str) -> PyResult<Bound<'py, PyAny>> {
        self.task.getattr(name)
    }

    pub(super) fn optional(&self, name: &str) -> PyResult<Option<Bound<'py, PyAny>>> {
        let value = self.get(name)?;
        Ok((!value.is_none()).then_some(value))
    }

    pub(super) fn numbers<const N: usize>(&self, name: &str) -> PyResult<[f64; N]> {
        arrays::array(&self.get(name)?, name)
    }

    pub(super) fn frame(&self, name: &str) -> PyResult<kinopt::model::FrameId> {
        let frame = arrays::name(&self.get(name)?, name)?;
        self.model.frame(&frame).or_raise()
    }

    pub(super) fn optional_frame(&self, name: &str) -> PyResult<Option<kinopt::model::FrameId>> {
        match self.optional(name)? {
            Some(_) => self.frame(name).map(Some),
            None => Ok(None),
        }
    }

    /// Reads one weight for each of these joints.
    fn joint_weights(&self, joints: &[JointId]) -> PyResult<Option<JointWeights>> {
        let Some(value) = self.optional("joint_weights")? else {
            return Ok(None);
        };
        if let Ok(word) = value.cast::<PyString>() {
            // The class accepts these two words only.
            return Ok(Some(match word.to_str()? {
                "upright" => JointWeights::Upright,
                _ => JointWeights::ByRange,
            }));
        }
        let Ok(named) = value.cast::<PyMapping>() else {
            let weights = arrays::vector_of(&value, "joint_weights", joints.len())?;
            return Ok(Some(JointWeights::Given(weights.to_vec())));
        };
        let mut weights = vec![1.0; joints.len()];
        for item in named.items()?.iter() {
            let (joint, weight): (String, f64) = item.extract()?;
            let id = self.model.joint(&joint).or_raise()?;
            match joints.iter().position(|known| *known == id) {
                Some(k) => weights[k] = weight,
                None => {
                    return Err(invalid(format!(
                        "joint_weights names {joint}, which is no joint of the task"
                    )));
                }
            }
        }
        Ok(Some(JointWeights::Given(weights)))
    }

    /// Reads a posture of all joints from an array, or of some by name.
    fn posture(&self) -> PyResult<Posture> {
        let reference = self.get("reference")?;
        if let Ok(values) = reference.cast::<PyMapping>() {
            let mut named = Vec::new();
            for item in values.items()?.iter() {
                let (joint, value): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
                let joint = arrays::name(&joint, "a joint of the reference")?;
                let value = arrays::number(&value, &format!("the reference of {joint}"))?;
                named.push((self.model.joint(&joint).or_raise()?, value));
            }
            return Ok(Posture::of_joints(named));
        }
        let dof = self.model.configuration_len();
        let reference = arrays::vector_of(&reference, "reference", dof)?;
        Ok(Posture::new(self.model, &reference))
    }
}

/// Common options of a task.
struct TaskOptions {
    name: Option<String>,
    weight: Numbers,
    scale: f64,
    tolerance: Numbers,
    role: Option<Role>,
    level: usize,
}

/// One number for all quantities, or one for each.
pub(super) enum Numbers {
    All(f64),
    Each(Vec<(Quantity, f64)>),
}

impl Numbers {
    pub(super) fn of(value: &Bound<'_, PyAny>, what: &str) -> PyResult<Self> {
        if value.is_none() {
            return Ok(Self::Each(Vec::new()));
        }
        if let Ok(number) = value.extract() {
            return Ok(Self::All(number));
        }
        let Ok(mapping) = value.cast::<PyMapping>() else {
            return Err(invalid(format!(
                "{what} must be a number, or a dict of numbers by quantity, such as {{\"metres\": 1.0}}"
            )));
        };
        let mut each = Vec::new();
        for item in mapping.items()?.iter() {
            let (name, number): (Bound<'_, PyAny>, Bound<'_, PyAny>) = item.extract()?;
            let name = arrays::name(&name, &format!("a quantity of {what}"))?;
            let number = arrays::number(&number, &format!("{what} per {name}"))?;
            each.push((quantity(&name)?, number));
        }
        Ok(Self::Each(each))
    }

    /// Numbers by quantity; `all` are the quantities of a single number.
    pub(super) fn by(&self, all: impl Iterator<Item = Quantity>) -> Vec<(Quantity, f64)> {
        match self {
            Self::All(number) => all.map(|quantity| (quantity, *number)).collect(),
            Self::Each(each) => each.clone(),
        }
    }
}

impl TaskOptions {
    fn of(task: &Bound<'_, PyAny>) -> PyResult<Self> {
        let get = |name: &str| match task.getattr_opt(name)? {
            Some(value) => Ok(value),
            None => Err(invalid(format!(
                "tasks holds {}, which is no task of kinopt.tasks",
                task.repr()?
            ))),
        };
        let role: Option<String> = get("role")?.extract()?;
        let role = match role.as_deref() {
            None => None,
            Some("goal") => Some(Role::Goal),
            Some("preference") => Some(Role::Preference),
            Some(other) => {
                let roles = ["goal", "preference"];
                let unknown = kinopt::model::UnknownName::new("role", other, roles);
                return Err(unknown).or_raise();
            }
        };
        Ok(Self {
            name: get("name")?.extract()?,
            weight: Numbers::of(&get("weight")?, "weight")?,
            scale: arrays::number(&get("scale")?, "scale")?,
            tolerance: Numbers::of(&get("tolerance")?, "tolerance")?,
            role,
            level: arrays::whole(&get("level")?)?,
        })
    }

    fn task<R: Residual>(self, residual: R) -> Task<R> {
        let rows = residual.rows();
        let quantities = || rows.iter().map(|rows| rows.quantity);
        let mut task = Task::new(residual);
        if let Some(name) = self.name {
            task = task.named(name);
        }
        for (quantity, weight) in self.weight.by(quantities()) {
            task = task.weight(quantity, weight);
        }
        for (quantity, tolerance) in self.tolerance.by(quantities()) {
            task = task.tolerance(quantity, tolerance);
        }
        let task = match self.role {
            Some(Role::Preference) => task.preference(),
            Some(_) => task.goal(),
            None => task,
        };
        task.scale(self.scale).at_level(self.level)
    }
}

/// Reads a tolerance of metres and radians, or one for each quantity.
pub(crate) fn tolerances(value: &Bound<'_, PyAny>) -> PyResult<Vec<(Quantity, f64)>> {
    let both = [Quantity::Metres, Quantity::Radians].into_iter();
    Ok(Numbers::of(value, "tolerance")?.by(both))
}

/// Reads the items of a dict, empty for None.
pub(crate) fn items<'py>(
    value: Option<&Bound<'py, PyAny>>,
    what: &str,
) -> PyResult<Vec<(Bound<'py, PyAny>, Bound<'py, PyAny>)>> {
    let Some(value) = value else {
        return Ok(Vec::new());
    };
    if let Ok(dict) = value.cast::<PyDict>() {
        return Ok(dict.iter().collect());
    }
    let Ok(mapping) = value.cast::<PyMapping>() else {
        return Err(invalid(format!("{what} must be a dict")));
    };
    mapping.items()?.iter().map(|item| item.extract()).collect()
}
