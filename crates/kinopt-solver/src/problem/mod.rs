//! Problems: tasks and bounds with residual r(x), derivatives and errors.

mod builder;
mod by_parameters;
mod collision;
mod collision_avoidance;
mod compiled_task;
mod derivatives;
mod dual_jacobian;
mod error;
mod evaluation;
mod finite_differences;
mod frame_reach;
mod inequality_slacks;
mod loop_gap;
mod loops;
mod moved_variables;
mod names;
mod normal_equations;
mod parameter_vector;
mod preferences;
mod problem_instance;
mod problem_parameters;
mod ranks;
mod tangent;
mod targets;

use std::marker::PhantomData;
use std::ops::Range;

pub use builder::ProblemBuilder;
pub(crate) use by_parameters::ParameterScratch;
pub use collision::{BodyKind, Collision};
#[doc(hidden)]
pub use collision_avoidance::{AnyClearanceCheck, CollisionConstraint};
pub use collision_avoidance::{ClearanceCheck, CollisionAvoidance};
pub use derivatives::Derivatives;
pub use error::ProblemError;
pub use evaluation::{Evaluation, Scratch};
pub use loop_gap::LoopGap;
pub(crate) use moved_variables::{FullObserver, MovedVariables, ReducedProblem, ReducedWorkspace};
#[doc(hidden)]
pub use names::ReportNames;
#[doc(hidden)]
pub use normal_equations::NormalEquations;
pub use parameter_vector::ParameterVector;
pub use preferences::Preferences;
pub use problem_instance::ProblemInstance;
#[doc(hidden)]
pub use ranks::{Ranks, TaskSubset};
pub(crate) use tangent::{Tangent, TangentPoint};
pub use targets::Targets;

use std::sync::Arc;

use crate::solver::{RotationSets, Swing, largest};
use crate::task::{Quantity, Role};
pub(crate) use compiled_task::CompiledTask;
#[doc(hidden)]
pub use frame_reach::Anchor;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::kinematics::Tree;
use kinopt_kinematics::model::{Model, ParameterMap};

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

    /// The index in the problem's list of tasks, and in a solution's reports.
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
/// The builder checks names, lengths and ranges once. A problem never changes, and is `Send` and `Sync`. Many threads
/// may solve one problem, each with its own [`Targets`].
#[derive(Clone)]
pub struct Problem {
    names: Arc<ReportNames>,
    map: ParameterMap,
    tree: Tree,
    tasks: Vec<CompiledTask>,
    /// The residuals that it was built with, by task.
    targets: Targets,
    rows: usize,
    ranks: Ranks,
    preferences: Preferences,
    lower: Vec<f64>,
    upper: Vec<f64>,
    /// The map from rates of the variables to a velocity of the model.
    tangent: Tangent,
    /// The variables that rotate ball joints.
    rotations: RotationSets,
    /// For each variable, true if it moves a free joint; empty if there is no free joint.
    is_base_variable: Vec<bool>,
    /// Half width of the sampling range of each unbounded variable: π or the reach.
    spread: Vec<f64>,
    /// For each variable, true if a task depends on it.
    moves_task: Vec<bool>,
    /// The variables that a task depends on, if a search over them alone pays off.
    moved_variables: Option<MovedVariables>,
    /// A length of the model's own scale, in metres.
    reach: f64,
    /// The length equivalent to a radian by variable, 1 for angles; empty unless the model has its own unit of length.
    step_scale: Vec<f64>,
    derivatives: Derivatives,
    /// The collision constraint, if any.
    collision_constraint: Option<Arc<CollisionConstraint>>,
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
    /// A builder of a problem on `model`, with every joint free.
    #[must_use]
    pub fn builder(model: &Model) -> ProblemBuilder<'_> {
        ProblemBuilder::new(model)
    }

    /// Number of solver variables.
    #[must_use]
    pub fn variables(&self) -> usize {
        self.map.variables()
    }

    /// Number of residual rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Number of coordinates of a configuration.
    #[must_use]
    pub fn configuration_len(&self) -> usize {
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

    /// The model's reach: its length scale in metres.
    #[must_use]
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Number of tasks, including those that close the model's loops.
    #[must_use]
    pub fn tasks(&self) -> usize {
        self.tasks.len()
    }

    /// The derivative method.
    #[must_use]
    pub fn derivatives(&self) -> Derivatives {
        self.derivatives
    }

    /// A copy of the residuals that the problem was built with, to change their targets.
    #[must_use]
    pub fn targets(&self) -> Targets {
        self.targets.clone()
    }

    /// The treatment of soft tasks.
    #[must_use]
    pub fn preferences(&self) -> Preferences {
        self.preferences
    }

    /// The compiled kinematics with the slots of the tasks.
    #[must_use]
    #[doc(hidden)]
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The tasks in order.
    #[must_use]
    #[doc(hidden)]
    pub fn compiled_tasks(&self) -> &[CompiledTask] {
        &self.tasks
    }

    /// The map from rates of the variables to a velocity of the model.
    #[must_use]
    pub(crate) fn tangent(&self) -> &Tangent {
        &self.tangent
    }

    #[must_use]
    #[doc(hidden)]
    pub fn names(&self) -> &Arc<ReportNames> {
        &self.names
    }

    /// The length equivalent to a radian by variable, 1 for angles; empty for models in metres.
    #[must_use]
    #[doc(hidden)]
    pub fn step_scale(&self) -> &[f64] {
        &self.step_scale
    }

    /// The order in which the tasks are met.
    #[must_use]
    #[doc(hidden)]
    pub fn ranks(&self) -> &Ranks {
        &self.ranks
    }

    /// The collision constraint, if any.
    #[must_use]
    #[doc(hidden)]
    pub fn collision_constraint(&self) -> Option<&Arc<CollisionConstraint>> {
        self.collision_constraint.as_ref()
    }

    /// A workspace for this problem.
    #[must_use]
    pub fn scratch(&self) -> Scratch {
        Scratch::new(self)
    }

    /// True if every required task is within its tolerances for the weighted residual `r`.
    ///
    /// `r` has [`rows`](Self::rows) entries. Rows of weight 0 are ignored.
    ///
    /// # Errors
    /// Returns an error for a wrong length.
    pub fn is_reached(&self, r: &[f64]) -> Result<bool, SizeMismatch> {
        SizeMismatch::check("rows of the residual", r.len(), self.rows())?;
        Ok(self.is_reached_by(TaskSubset::All, r))
    }

    /// The name of a task; `None` for an index out of range.
    #[must_use]
    pub fn task_name(&self, task: usize) -> Option<&str> {
        self.tasks.get(task).map(CompiledTask::name)
    }

    /// The problem with another derivative method.
    #[must_use]
    pub fn with_derivatives(mut self, route: Derivatives) -> Self {
        self.derivatives = route;
        let constraint = self.collision_constraint.as_deref().cloned();
        self.collision_constraint =
            constraint.map(|constraint| Arc::new(constraint.with_derivatives(route)));
        self
    }

    /// A problem instance with `targets` instead of those that the problem was built with.
    ///
    /// # Errors
    /// Returns an error for targets of a problem with other tasks.
    pub fn with_targets<'a>(
        &'a self,
        targets: &'a Targets,
    ) -> Result<ProblemInstance<'a>, ProblemError> {
        match targets.fit(self) {
            true => Ok(ProblemInstance::from(self).with_targets(targets)),
            false => Err(ProblemError::ForeignTargets {
                given: targets.residuals.len(),
                model: self.names.model.clone(),
                expected: self.tasks.len(),
            }),
        }
    }

    /// True if some task is soft, so that a reached solution is not always the minimum.
    #[must_use]
    pub fn has_preferences(&self) -> bool {
        self.tasks.iter().any(|task| task.role == Role::Preference)
    }

    /// True if some task of a subset is soft.
    pub(crate) fn has_soft_tasks(&self, subset: TaskSubset) -> bool {
        let mut tasks = self.tasks_of(subset);
        tasks.any(|(_, task, _)| task.role == Role::Preference)
    }

    /// The required tasks that can be unreached, and soft tasks weighted against them.
    pub(crate) fn goals(&self) -> TaskSubset {
        TaskSubset::above(self.ranks.levels())
    }

    /// The tasks of a solver's first search.
    ///
    /// The required tasks of all levels if there are several ranks to separate, otherwise all tasks.
    pub(crate) fn searched_subset(&self) -> TaskSubset {
        let (levels, ranks) = (self.ranks.levels(), self.ranks.count());
        match levels > 1 || (levels > 0 && ranks > levels && self.has_preferences()) {
            true => self.goals(),
            false => TaskSubset::All,
        }
    }

    /// Number of rows of a subset.
    pub(crate) fn rows_of(&self, subset: TaskSubset) -> usize {
        match subset {
            TaskSubset::All => self.rows,
            TaskSubset::Ranks { from, to } => self.ranks.rows(from, to),
        }
    }

    /// The tasks of a subset with their indices and the range of their rows in it.
    pub(crate) fn tasks_of(
        &self,
        subset: TaskSubset,
    ) -> impl Iterator<Item = (usize, &CompiledTask, Range<usize>)> {
        let tasks = self.tasks.iter().enumerate();
        tasks
            .filter_map(move |(index, task)| Some((index, task, self.ranks.rows_in(task, subset)?)))
    }

    /// Rows with weight 0 or infinite tolerance in binding tasks of a subset.
    pub(crate) fn free_rows(&self, subset: TaskSubset) -> impl Iterator<Item = Range<usize>> {
        self.tasks_of(subset).flat_map(|(_, task, rows)| {
            let free_blocks = task
                .blocks()
                .filter(|block| task.binds && !task.keeps(block));
            free_blocks.map(move |block| block.rows_after(task.rows.start, rows.start))
        })
    }

    /// True if a change of a subset's weighted residual keeps the errors of its required tasks.
    pub(crate) fn is_kept(&self, subset: TaskSubset, change: &[f64]) -> bool {
        self.tasks_of(subset).all(|(_, task, rows)| {
            let mut kept_blocks = task.blocks().filter(|block| task.keeps(block));
            kept_blocks.all(|block| {
                let rows = block.rows_after(task.rows.start, rows.start);
                norm(&change[rows]) <= block.max_change()
            })
        })
    }

    /// Half width of the sampling range of an unbounded variable: π or the reach.
    pub(crate) fn spread(&self, variable: usize) -> f64 {
        self.spread[variable]
    }

    /// The reach of a task's first frame, if it is bounded.
    pub(crate) fn anchor(&self, task: usize) -> Option<&Anchor> {
        self.names.anchors.get(task)?.as_ref()
    }

    /// Marks the variables that move an unreached required task and no reached one.
    ///
    /// `r` is the weighted residual of the subset. Without such variables, marks all that move a task.
    pub(crate) fn mark_local(&self, subset: TaskSubset, r: &[f64], marked: &mut [bool]) {
        marked.fill(false);
        for pass_reached in [false, true] {
            for (index, task, _) in self.tasks_of(subset) {
                let mut blocks = self.errors(subset, r).filter(|block| block.task == index);
                let is_unreached = blocks.any(|block| !block.reached);
                // Loop closures do not fix variables: the joints of a closed loop may move and close it again.
                let applies = task.role == Role::Goal && !(pass_reached && task.is_loop);
                if applies && is_unreached != pass_reached {
                    for variable in self.variables_moving(task) {
                        marked[variable] = is_unreached;
                    }
                }
            }
        }
        if !marked.contains(&true) {
            marked.copy_from_slice(&self.moves_task);
        }
    }

    /// True if a variable moves a free joint, and with it the whole body.
    pub(crate) fn is_base_variable(&self, variable: usize) -> bool {
        self.is_base_variable
            .get(variable)
            .is_some_and(|is_base| *is_base)
    }

    /// True if a free joint moves the whole body.
    pub(crate) fn has_free_joint(&self) -> bool {
        self.is_base_variable.contains(&true)
    }

    /// The bounded swing of which a variable is one of the two components.
    pub(crate) fn swing_at(&self, variable: usize) -> Option<&Swing> {
        self.rotations.swing_of(variable)
    }

    /// True if some task of the search depends on a variable.
    pub(crate) fn moves_a_task(&self, variable: usize) -> bool {
        self.moves_task[variable]
    }

    fn mark_task_variables(&mut self) {
        let mut moving = vec![false; self.variables()];
        for variable in self
            .tasks_of(self.searched_subset())
            .flat_map(|(_, task, _)| self.variables_moving(task))
        {
            moving[variable] = true;
        }
        self.moved_variables = MovedVariables::of(&moving, &self.rotations, &self.step_scale);
        self.moves_task = moving;
    }

    /// A sweep visits every joint and frame once; frame by frame, each frame visits all joints that move it.
    fn choose_sweeps(&mut self) {
        let Self { tree, tasks, .. } = self;
        for task in tasks {
            let slots = task.frames.iter();
            let variables: usize = slots.map(|&slot| tree.variables_moving(slot).count()).sum();
            task.uses_sweeps = variables > MIN_SWEEP_RATIO * (tree.joints() + task.frames.len());
        }
    }

    /// Joins variables on which a task of a subset depends together (union-find).
    ///
    /// Afterwards `groups` holds for each variable the lowest variable of its set. On entry, each entry is its own
    /// index. Returns the number of separate sets on which tasks depend.
    pub(crate) fn group_by_tasks(&self, subset: TaskSubset, groups: &mut [usize]) -> usize {
        fn root(groups: &[usize], mut variable: usize) -> usize {
            while groups[variable] != variable {
                variable = groups[variable];
            }
            variable
        }
        for (_, task, _) in self.tasks_of(subset) {
            let mut first = None;
            for variable in self.variables_moving(task) {
                let group = root(groups, variable);
                let lowest = group.min(*first.get_or_insert(group));
                let highest = group.max(first.unwrap_or(group));
                groups[highest] = lowest;
                first = Some(lowest);
            }
        }
        for variable in 0..groups.len() {
            groups[variable] = root(groups, variable);
        }
        let moves_a_task =
            |variable: &usize| groups[*variable] == *variable && self.moves_task[*variable];
        (0..groups.len()).filter(moves_a_task).count()
    }

    /// True if the required tasks of a subset on one set of [grouped](Self::group_by_tasks) variables are reached.
    ///
    /// `residual` is the weighted residual of the subset. False for a set without required tasks.
    pub(crate) fn is_limb_reached(
        &self,
        subset: TaskSubset,
        residual: &[f64],
        groups: &[usize],
        limb: usize,
    ) -> bool {
        let mut has_tasks = false;
        for block in self
            .errors(subset, residual)
            .filter(|block| block.role == Role::Goal)
        {
            let mut moving = self.variables_moving(&self.tasks[block.task]);
            if moving
                .next()
                .is_some_and(|variable| groups[variable] == limb)
            {
                has_tasks = true;
                if !block.reached {
                    return false;
                }
            }
        }
        has_tasks
    }

    /// The variables that a task depends on.
    fn variables_moving<'a>(&'a self, task: &'a CompiledTask) -> impl Iterator<Item = usize> + 'a {
        let by_frames = task
            .frames
            .iter()
            .flat_map(|&slot| self.tree.variables_moving(slot));
        let by_joints = task
            .coordinates
            .iter()
            .flat_map(|&coordinate| self.map.variables_of(coordinate));
        by_frames.chain(by_joints)
    }

    /// The error of every row block of a subset, for its weighted residual `r`.
    ///
    /// Errors are in the unit of their quantity. Rows of weight 0 report an error of 0.
    #[doc(hidden)]
    pub fn errors<'a>(
        &'a self,
        subset: TaskSubset,
        r: &'a [f64],
    ) -> impl Iterator<Item = BlockError> + 'a {
        let tasks = self.tasks.iter().enumerate();
        tasks.flat_map(move |(task, compiled)| {
            let rows = self.ranks.rows_in(compiled, subset);
            rows.into_iter().flat_map(move |rows| {
                compiled.blocks().map(move |block| {
                    let rows = block.rows_after(compiled.rows.start, rows.start);
                    let error = match block.weight > 0.0 {
                        true => block.measure.error_of(norm(&r[rows]) / block.weight),
                        false => 0.0,
                    };
                    BlockError {
                        task,
                        quantity: block.measure.quantity,
                        error,
                        reached: error <= block.tolerance,
                        role: compiled.role,
                    }
                })
            })
        })
    }

    /// True if some rows have weight 0.
    pub(crate) fn has_unweighted_blocks(&self) -> bool {
        let mut blocks = self.tasks.iter().flat_map(CompiledTask::blocks);
        blocks.any(|block| block.weight == 0.0)
    }

    /// The true errors of rows of weight 0, from the unweighted residual of the whole problem.
    ///
    /// In the order of [`errors`](Self::errors); `None` for all other rows.
    pub(crate) fn unweighted_errors<'a>(
        &'a self,
        unweighted: &'a [f64],
    ) -> impl Iterator<Item = Option<f64>> + 'a {
        let blocks = self.tasks.iter().flat_map(CompiledTask::blocks);
        blocks.map(|block| {
            let norm = || norm(&unweighted[block.rows.clone()]);
            (block.weight == 0.0).then(|| block.measure.error_of(norm()))
        })
    }

    /// True if every required task of a subset is reached or within [`MAX_NEARBY_ERROR`] of its target at the start.
    ///
    /// Metres are compared relative to the distance that has the weight of a radian. `r` is the weighted residual.
    pub(crate) fn is_nearby(&self, subset: TaskSubset, r: &[f64]) -> bool {
        self.errors(subset, r).all(|block| {
            let max_error = match block.quantity {
                Quantity::Radians => MAX_NEARBY_ERROR,
                Quantity::Metres => MAX_NEARBY_ERROR * builder::RADIAN_PER_REACH * self.reach,
                _ => 0.0,
            };
            block.reached || block.role == Role::Preference || block.error <= max_error
        })
    }

    /// Does the same as [`is_reached`](Self::is_reached), for the residual of a subset.
    #[doc(hidden)]
    pub fn is_reached_by(&self, subset: TaskSubset, r: &[f64]) -> bool {
        r.len() == self.rows_of(subset)
            && self
                .errors(subset, r)
                .all(|block| block.reached || block.role == Role::Preference)
    }
}

/// Largest error of a near target at the start, radians (metres by their weight).
///
/// For near targets the first attempt runs to its end before any other starts. For more distant targets a stalled
/// attempt is abandoned, because further attempts take less time than continuing it.
#[doc(hidden)]
pub const MAX_NEARBY_ERROR: f64 = 1.0;

/// Ratio of joints visited frame by frame to those of a sweep, above which a task is swept.
const MIN_SWEEP_RATIO: usize = 2;

/// Euclidean norm, without overflow or underflow of the squares.
fn norm(rows: &[f64]) -> f64 {
    let squared: f64 = rows.iter().map(|v| v * v).sum();
    if squared.is_normal() {
        return squared.sqrt();
    }
    let largest = largest(rows);
    if squared.is_nan() || largest == 0.0 || largest.is_infinite() {
        return squared;
    }
    let scaled: f64 = rows.iter().map(|v| (v / largest) * (v / largest)).sum();
    largest * scaled.sqrt()
}

/// The error of one row block.
#[derive(Clone, Copy, Debug)]
#[doc(hidden)]
pub struct BlockError {
    #[doc(hidden)]
    pub task: usize,
    #[doc(hidden)]
    pub quantity: Quantity,
    #[doc(hidden)]
    pub error: f64,
    #[doc(hidden)]
    pub reached: bool,
    #[doc(hidden)]
    pub role: Role,
}
