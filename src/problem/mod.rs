//! Tasks and bounds put together: r(x), its derivatives, and what the errors mean.

mod builder;
mod compiled_task;
mod derivatives;
mod error;
mod evaluation;
mod names;

use std::marker::PhantomData;

pub use builder::ProblemBuilder;
pub use derivatives::Derivatives;
pub use error::ProblemError;
pub use evaluation::{Evaluation, Scratch};
pub(crate) use names::Names;

use std::sync::Arc;

use crate::kinematics::{Tree, TreeMemory};
use crate::model::{Limits, Model, ParameterMap, Source};
use crate::task::{Quantity, Residual, Role};
pub(crate) use compiled_task::CompiledTask;

/// A task of one problem, with the type of its residual.
#[derive(Debug)]
pub struct TaskId<R> {
    index: usize,
    residual: PhantomData<fn() -> R>,
}

impl<R> TaskId<R> {
    fn new(index: usize) -> Self {
        Self {
            index,
            residual: PhantomData,
        }
    }

    /// The position in the problem's list, and in a solution's reports.
    #[must_use]
    pub fn index(self) -> usize {
        self.index
    }
}

impl<R> Clone for TaskId<R> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<R> Copy for TaskId<R> {}

/// A bounded nonlinear least-squares problem: minimise ½‖r(x)‖² subject to lower ≤ x ≤ upper.
///
/// Built once: names, sizes and ranges are checked then. Targets may move afterwards through
/// [`residual_mut`](Self::residual_mut), at no cost.
pub struct Problem {
    names: Arc<Names>,
    map: ParameterMap,
    tree: Tree,
    tasks: Vec<CompiledTask>,
    rows: usize,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// How far around the start an unbounded variable is drawn at random: π or the reach.
    spread: Vec<f64>,
    /// Whether any task depends on each variable.
    felt: Vec<bool>,
    /// A length of the model's own scale, in metres.
    reach: f64,
    derivatives: Derivatives,
}

impl std::fmt::Debug for Problem {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Problem")
            .field("model", &self.names.model)
            .field("variables", &self.variables())
            .field("rows", &self.rows)
            .field(
                "tasks",
                &self
                    .tasks
                    .iter()
                    .map(CompiledTask::name)
                    .collect::<Vec<_>>(),
            )
            .finish_non_exhaustive()
    }
}

impl Problem {
    /// Starts a problem on `model`, with every joint free.
    #[must_use]
    pub fn builder(model: &Model) -> ProblemBuilder<'_> {
        ProblemBuilder::new(model)
    }

    /// How many solver variables there are.
    #[must_use]
    pub fn variables(&self) -> usize {
        self.map.variables()
    }

    /// How many residual rows there are.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// How many numbers a configuration of the model has.
    #[must_use]
    pub fn degrees_of_freedom(&self) -> usize {
        self.map.sources().len()
    }

    /// The map from variables to configurations.
    #[must_use]
    pub fn parameters(&self) -> &ParameterMap {
        &self.map
    }

    /// Lower bounds of the variables.
    #[must_use]
    pub fn lower(&self) -> &[f64] {
        &self.lower
    }

    /// Upper bounds of the variables.
    #[must_use]
    pub fn upper(&self) -> &[f64] {
        &self.upper
    }

    /// The model's own length scale in metres.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// How many tasks there are.
    #[must_use]
    pub fn tasks(&self) -> usize {
        self.tasks.len()
    }

    /// A task's name.
    #[must_use]
    pub fn task_name(&self, task: usize) -> Option<&str> {
        self.tasks.get(task).map(CompiledTask::name)
    }

    /// Which derivative route is taken.
    #[must_use]
    pub fn derivatives(&self) -> Derivatives {
        self.derivatives
    }

    /// Chooses the derivative route.
    pub fn set_derivatives(&mut self, route: Derivatives) {
        self.derivatives = route;
    }

    /// A task's residual, to look at. `None` for an id of another problem that is out of range here
    /// or names a residual of another type.
    #[must_use]
    pub fn residual<R: Residual>(&self, task: TaskId<R>) -> Option<&R> {
        let residual = &*self.tasks.get(task.index)?.residual;
        residual.as_any().downcast_ref()
    }

    /// A task's residual, to move its target. `None` for an id of another problem that is out of
    /// range here or names a residual of another type. Numbers set here are not checked: a target that is not finite ends the solve as non-finite.
    #[must_use]
    pub fn residual_mut<R: Residual>(&mut self, task: TaskId<R>) -> Option<&mut R> {
        let residual = &mut *self.tasks.get_mut(task.index)?.residual;
        residual.as_any_mut().downcast_mut()
    }

    /// Whether any task is a preference, so that reaching the goals is not yet the minimum.
    #[must_use]
    pub fn has_preferences(&self) -> bool {
        self.tasks.iter().any(|task| task.role == Role::Preference)
    }

    /// Scratch memory for this problem.
    #[must_use]
    pub fn scratch(&self) -> Scratch {
        Scratch::new(self)
    }

    /// Takes other bounds for the variables, within the limits.
    pub(crate) fn set_bounds(&mut self, lower: &[f64], upper: &[f64]) {
        self.lower.copy_from_slice(lower);
        self.upper.copy_from_slice(upper);
    }

    /// Takes the places of joints and frames anew from its model, whose joints now stand elsewhere.
    pub(crate) fn take_places(&mut self, model: &Model, memory: &mut TreeMemory) {
        self.tree.compile(model, &self.map, memory);
    }

    /// The compiled kinematics that the tasks' slots refer to.
    pub(crate) fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The tasks in order.
    pub(crate) fn compiled_tasks(&self) -> &[CompiledTask] {
        &self.tasks
    }

    pub(crate) fn names(&self) -> &Arc<Names> {
        &self.names
    }

    /// Where random values of a variable are drawn from: its bounds, or where one is missing or
    /// endlessly far away π or the reach from `at`.
    pub(crate) fn sampling_range(&self, variable: usize, at: f64) -> (f64, f64) {
        let bounds = Limits::new(self.lower[variable], self.upper[variable]);
        bounds.sampling_range(at, self.spread[variable])
    }

    /// Marks the variables that move a missed goal and no reached one, given the weighted residual
    /// there; all that any task feels where there is none such.
    pub(crate) fn mark_free_to_wander(&self, r: &[f64], marked: &mut [bool]) {
        marked.fill(false);
        for pass_reached in [false, true] {
            for (index, task) in self.tasks.iter().enumerate() {
                let mut blocks = self.errors(r).filter(|block| block.task == index);
                let missed = blocks.any(|block| !block.reached);
                if task.role == Role::Goal && missed != pass_reached {
                    for variable in self.variables_moving(task) {
                        marked[variable] = missed;
                    }
                }
            }
        }
        if !marked.contains(&true) {
            marked.copy_from_slice(&self.felt);
        }
    }

    /// Whether any task depends on a variable.
    pub(crate) fn is_felt(&self, variable: usize) -> bool {
        self.felt[variable]
    }

    fn mark_felt(&mut self) {
        let mut felt = vec![false; self.variables()];
        for variable in self
            .tasks
            .iter()
            .flat_map(|task| self.variables_moving(task))
        {
            felt[variable] = true;
        }
        self.felt = felt;
    }

    /// The variables that a task feels.
    fn variables_moving<'a>(&'a self, task: &'a CompiledTask) -> impl Iterator<Item = usize> + 'a {
        let by_frames = task
            .frames
            .iter()
            .flat_map(|&slot| self.tree.variables_moving(slot));
        let by_joints = task.coordinates.iter().filter_map(|&coordinate| {
            match self.map.sources()[coordinate] {
                Source::Variable { variable, .. } => Some(variable),
                Source::Constant(_) => None,
            }
        });
        by_frames.chain(by_joints)
    }

    /// For every block of rows: its task, its quantity, the error in that quantity's unit for the
    /// weighted residual `r`, and whether it is within tolerance.
    pub(crate) fn errors<'a>(&'a self, r: &'a [f64]) -> impl Iterator<Item = BlockError> + 'a {
        self.tasks
            .iter()
            .enumerate()
            .flat_map(move |(task, compiled)| {
                compiled.blocks().map(move |block| {
                    let rows = &r[block.rows.clone()];
                    let weighted: f64 = rows.iter().map(|v| v * v).sum();
                    // A weight of zero switches rows off: nobody asked for them.
                    let error = if block.weight > 0.0 {
                        weighted.sqrt() / block.weight
                    } else {
                        0.0
                    };
                    BlockError {
                        task,
                        quantity: block.quantity,
                        error,
                        reached: error <= block.tolerance,
                        role: compiled.role,
                    }
                })
            })
    }

    /// Whether every goal is within its tolerances for the weighted residual `r` (shape:
    /// [`rows`](Self::rows); of another length it reaches nothing).
    #[must_use]
    pub fn is_reached(&self, r: &[f64]) -> bool {
        r.len() == self.rows
            && self
                .errors(r)
                .all(|block| block.reached || block.role == Role::Preference)
    }
}

/// The error of one block of rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockError {
    pub(crate) task: usize,
    pub(crate) quantity: Quantity,
    pub(crate) error: f64,
    pub(crate) reached: bool,
    pub(crate) role: Role,
}
