//! Problems with tasks and targets by name.

use kinopt::model::{Limits, UnknownName};
use kinopt::problem::{ProblemBuilder, ProblemInstance, Targets};
use kinopt::task::Quantity;
use kinopt::{Model, Problem};

use crate::error::ErrorKind;
use crate::names::{PREFERENCES, named};
use crate::task::{Aimed, BoxedTask, Move};
use crate::value::{Arguments, ErrorOf, OrRaise, Value, joint_of};

/// Largest difference between a configuration and its projection, relative to its values.
const PROJECTION_TOLERANCE: f64 = 1e-9;

/// Options that [`apply`] reads.
pub const OPTIONS: [&str; 3] = ["tolerance", "preferences", "bounds"];

/// Applies the options of a problem: `tolerance` of tasks that set none, mode of soft tasks, and narrower `bounds`.
///
/// # Errors
/// If an option has another type, or names an unknown joint or mode.
pub fn apply<A: Arguments>(
    builder: &mut ProblemBuilder<'_>,
    model: &Model,
    arguments: &A,
) -> Result<(), ErrorOf<A>> {
    if let Some(bounds) = arguments.get("bounds")? {
        for (name, (lower, upper)) in bounds.ranges("bounds")? {
            let joint = joint_of::<A::Value>(model, &name)?;
            builder.bound(joint, Limits::new(lower, upper));
        }
    }
    if let Some(tolerance) = arguments.get("tolerance")? {
        let tolerance = tolerance.number("tolerance")?;
        builder.tolerance(Quantity::Metres, tolerance);
        builder.tolerance(Quantity::Radians, tolerance);
    }
    if let Some(name) = arguments.get("preferences")? {
        let name = name.name("preferences")?;
        builder.preferences(named("preferences", &name, &PREFERENCES).or_raise::<A::Value>()?);
    }
    Ok(())
}

/// A compiled problem with its tasks.
pub struct NamedProblem<V: Value> {
    /// The problem of the library.
    pub inner: Problem,
    tasks: Vec<BoxedTask<V>>,
}

impl<V: Value> NamedProblem<V> {
    /// A problem with its tasks, in the order in which they were added.
    #[must_use]
    pub fn new(inner: Problem, tasks: Vec<BoxedTask<V>>) -> Self {
        Self { inner, tasks }
    }

    /// Names of the tasks, in their order.
    pub fn task_names(&self) -> impl Iterator<Item = &str> {
        (0..self.inner.tasks()).filter_map(|task| self.inner.task_name(task))
    }

    /// Checks the index of a task.
    ///
    /// # Errors
    /// If the problem has fewer tasks.
    pub fn task_at(&self, index: usize) -> Result<usize, V::Error> {
        match index < self.tasks.len() {
            true => Ok(index),
            false => Err(V::error(
                ErrorKind::InvalidValue,
                format!(
                    "targets names task {index}, the problem has {} tasks",
                    self.tasks.len()
                ),
            )),
        }
    }

    /// Index of the task of a name.
    ///
    /// # Errors
    /// If no task has this name, or several have it.
    pub fn task_named(&self, name: &str) -> Result<usize, V::Error> {
        let names: Vec<&str> = self.task_names().collect();
        let mut matches = names
            .iter()
            .enumerate()
            .filter(|(_, task_name)| **task_name == name);
        match (matches.next(), matches.next()) {
            (Some((index, _)), None) => Ok(index),
            (Some(_), Some(_)) => Err(V::error(
                ErrorKind::InvalidValue,
                format!("several tasks are named `{name}`: give targets by index"),
            )),
            (None, _) => Err(UnknownName::new("task", name, names)).or_raise::<V>(),
        }
    }

    /// Converts a target of a task.
    ///
    /// # Errors
    /// If the value is no target of the task.
    pub fn read(&self, task: usize, value: &V) -> Result<Move<V>, V::Error> {
        let name = self.inner.task_name(task).unwrap_or_default();
        self.tasks[task].read(value, &format!("the target of {name}"))
    }

    /// Targets of the problem with some of them moved.
    ///
    /// # Errors
    /// If a target is invalid.
    pub fn targets_with<'a>(
        &self,
        moves: impl IntoIterator<Item = &'a Move<V>>,
    ) -> Result<Targets, V::Error>
    where
        V: 'a,
    {
        let mut targets = self.inner.targets();
        for aim in moves {
            aim(&mut Aimed::Targets(&mut targets))?;
        }
        Ok(targets)
    }

    /// Problem instance with these targets.
    ///
    /// # Errors
    /// If the targets are those of another problem.
    pub fn instance<'a>(&'a self, targets: &'a Targets) -> Result<ProblemInstance<'a>, V::Error> {
        self.inner.with_targets(targets).or_raise::<V>()
    }

    /// Variables of a configuration of `model`, the model of the problem.
    ///
    /// # Errors
    /// If the problem does not allow the configuration.
    pub fn variables_of(&self, model: &Model, q: &[f64]) -> Result<Vec<f64>, V::Error> {
        let map = self.inner.parameters();
        let (mut x, mut projected) = (vec![0.0; map.variables()], vec![0.0; q.len()]);
        let mut unit = q.to_vec();
        model.normalise(&mut unit).or_raise::<V>()?;
        map.reduce(&unit, &mut x).or_raise::<V>()?;
        map.expand(&x, &mut projected).or_raise::<V>()?;
        for (index, &id) in model.moving_joints().iter().enumerate() {
            // A quaternion and its negative are equal rotations.
            let sign = match model.coordinate(id) {
                Some(first) if model.joints()[id.index()].kind.is_ball() => {
                    let parts = unit[first..].iter().zip(&projected[first..]).take(4);
                    parts.map(|(a, b)| a * b).sum::<f64>().signum()
                }
                _ => 1.0,
            };
            let (actual, required) = (unit[index], sign * projected[index]);
            if (actual - required).abs() > PROJECTION_TOLERANCE * (1.0 + actual.abs()) {
                let name = &model.joints()[id.index()].name;
                return Err(V::error(
                    ErrorKind::InvalidValue,
                    format!(
                        "x is not a configuration of the problem: `{name}` is at {actual}, but locked joints, \
                         mimic joints and bounds require {required}"
                    ),
                ));
            }
        }
        Ok(x)
    }
}
