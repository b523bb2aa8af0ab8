//! Tasks and bounds put together: r(x), its derivatives, and what the errors mean.

mod builder;
mod by_parameters;
mod collision;
mod compiled_task;
mod derivatives;
mod dual_jacobian;
mod error;
mod evaluation;
mod finite_differences;
mod frame_reach;
mod inequality_depths;
mod keep_clear;
mod loops;
mod moved_variables;
mod names;
mod normal_equations;
mod parameter_vector;
mod preferences;
mod problem_parameters;
mod question;
mod ranks;
mod tangent;
mod targets;

use std::marker::PhantomData;
use std::ops::Range;

pub use builder::ProblemBuilder;
pub(crate) use by_parameters::ParameterScratch;
pub use collision::{BodyKind, Collision};
pub use derivatives::Derivatives;
pub use error::ProblemError;
pub use evaluation::{Evaluation, Scratch};
pub(crate) use keep_clear::{AnyClearanceCheck, Fence};
pub use keep_clear::{ClearanceCheck, KeepClear};
pub(crate) use moved_variables::{Moved, MovedMemory, MovedVariables, ObserverOfAll};
pub(crate) use names::ReportNames;
pub(crate) use normal_equations::NormalEquations;
pub use parameter_vector::ParameterVector;
pub use preferences::Preferences;
pub use question::Question;
pub(crate) use ranks::{Ranks, Share};
pub(crate) use tangent::{Standing, Tangent};
pub use targets::Targets;

use std::sync::Arc;

use crate::SizeMismatch;
use crate::kinematics::Tree;
use crate::model::{Model, ParameterMap};
use crate::solver::{RotationSets, Swing, largest};
use crate::task::{Quantity, Role};
pub(crate) use compiled_task::CompiledTask;
pub(crate) use frame_reach::Anchor;

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
/// Built once: names, sizes and ranges are checked then. It never changes, and is `Send` and `Sync`: many
/// threads solve one problem, each with [`Targets`] of its own.
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
    /// How the variables move the model.
    tangent: Tangent,
    /// Which variables turn ball joints.
    rotations: RotationSets,
    /// Which variables move a free joint; empty where there is none.
    floating: Vec<bool>,
    /// How far around the start an unbounded variable is drawn at random: π or the reach.
    spread: Vec<f64>,
    /// Whether any task depends on each variable.
    moving: Vec<bool>,
    /// The variables among them, where leaving the others out is worth it.
    moved: Option<MovedVariables>,
    /// A length of the model's own scale, in metres.
    reach: f64,
    /// What steps of slides are measured in, if the model's unit is its own.
    step_scale: Vec<f64>,
    derivatives: Derivatives,
    /// What it keeps clear of.
    fence: Option<Arc<Fence>>,
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

    getters! {
        /// How many solver variables there are.
        pub fn variables(&self) -> usize = self.map.variables();
        /// How many residual rows there are.
        pub fn rows(&self) -> usize = self.rows;
        /// How many numbers a configuration of the model has.
        pub fn configuration_len(&self) -> usize = self.map.sources().len();
        /// The map from variables to configurations.
        pub fn parameters(&self) -> &ParameterMap = &self.map;
        /// Lower bounds of the variables.
        pub fn lower(&self) -> &[f64] = &self.lower;
        /// Upper bounds of the variables.
        pub fn upper(&self) -> &[f64] = &self.upper;
        /// The model's own length scale in metres.
        pub fn reach(&self) -> f64 = self.reach;
        /// How many tasks there are, those that close the model's loops included.
        pub fn tasks(&self) -> usize = self.tasks.len();
        /// Which derivative route is taken.
        pub fn derivatives(&self) -> Derivatives = self.derivatives;
        /// A copy of the residuals that the problem was built with, to move their targets.
        pub fn targets(&self) -> Targets = self.targets.clone();
        /// What preferences may cost the goals.
        pub fn preferences(&self) -> Preferences = self.preferences;
        /// The compiled kinematics that the tasks' slots refer to.
        pub(crate) fn tree(&self) -> &Tree = &self.tree;
        /// The tasks in order.
        pub(crate) fn compiled_tasks(&self) -> &[CompiledTask] = &self.tasks;
        /// How the variables move the model.
        pub(crate) fn tangent(&self) -> &Tangent = &self.tangent;
        pub(crate) fn names(&self) -> &Arc<ReportNames> = &self.names;
        /// The length by which a slide weighs as much as a radian, by variable, 1 for angles; empty for models in metres.
        pub(crate) fn step_scale(&self) -> &[f64] = &self.step_scale;
        /// The order in which the tasks are met.
        pub(crate) fn ranks(&self) -> &Ranks = &self.ranks;
        /// What it keeps clear of, if anything.
        pub(crate) fn fence(&self) -> Option<&Arc<Fence>> = self.fence.as_ref();
        /// Scratch memory for this problem.
        pub fn scratch(&self) -> Scratch = Scratch::new(self);
    }

    /// Whether every goal is within its tolerances for the weighted residual `r` (shape:
    /// [`rows`](Self::rows)). Rows of weight 0 are not asked for.
    ///
    /// # Errors
    /// Another length.
    pub fn is_reached(&self, r: &[f64]) -> Result<bool, SizeMismatch> {
        SizeMismatch::check("rows of the residual", r.len(), self.rows())?;
        Ok(self.is_reached_by(Share::All, r))
    }

    /// A task's name.
    #[must_use]
    pub fn task_name(&self, task: usize) -> Option<&str> {
        self.tasks.get(task).map(CompiledTask::name)
    }

    /// The same problem by another derivative route.
    #[must_use]
    pub fn with_derivatives(mut self, route: Derivatives) -> Self {
        self.derivatives = route;
        let fence = self.fence.as_deref().cloned();
        self.fence = fence.map(|fence| Arc::new(fence.with_derivatives(route)));
        self
    }

    /// The question with targets of one's own instead of those that the problem was built with.
    ///
    /// # Errors
    /// Targets of a problem with other tasks.
    pub fn with_targets<'a>(&'a self, targets: &'a Targets) -> Result<Question<'a>, ProblemError> {
        match targets.fit(self) {
            true => Ok(Question::from(self).with_targets(targets)),
            false => Err(ProblemError::ForeignTargets {
                given: targets.residuals.len(),
                model: self.names.model.clone(),
                expected: self.tasks.len(),
            }),
        }
    }

    /// Whether any task is a preference, so that reaching the goals is not yet the minimum.
    #[must_use]
    pub fn has_preferences(&self) -> bool {
        self.tasks.iter().any(|task| task.role == Role::Preference)
    }

    /// Whether any task of a share is a preference.
    pub(crate) fn pulls_in(&self, share: Share) -> bool {
        let mut tasks = self.tasks_of(share);
        tasks.any(|(_, task, _)| task.role == Role::Preference)
    }

    /// The goals that can be missed, and what is traded with them.
    pub(crate) fn goals(&self) -> Share {
        Share::above(self.ranks.levels())
    }

    /// What a solver searches with at first: the goals of all levels where anything ranks below another,
    /// everything where there is nothing to tell apart.
    pub(crate) fn search_share(&self) -> Share {
        let (levels, ranks) = (self.ranks.levels(), self.ranks.count());
        match levels > 1 || (levels > 0 && ranks > levels && self.has_preferences()) {
            true => self.goals(),
            false => Share::All,
        }
    }

    /// How many rows a share has.
    pub(crate) fn rows_of(&self, share: Share) -> usize {
        match share {
            Share::All => self.rows,
            Share::Ranks { from, to } => self.ranks.rows(from, to),
        }
    }

    /// The tasks of a share with their numbers, and where their rows stand in it.
    pub(crate) fn tasks_of(
        &self,
        share: Share,
    ) -> impl Iterator<Item = (usize, &CompiledTask, Range<usize>)> {
        let tasks = self.tasks.iter().enumerate();
        tasks.filter_map(move |(index, task)| Some((index, task, self.ranks.rows_in(task, share)?)))
    }

    /// Rows of tasks of a share that bind for which any error will do.
    pub(crate) fn free_rows(&self, share: Share) -> impl Iterator<Item = Range<usize>> {
        self.tasks_of(share).flat_map(|(_, task, rows)| {
            let free = task
                .blocks()
                .filter(|block| task.binds && !task.keeps(block));
            free.map(move |block| block.rows_after(task.rows.start, rows.start))
        })
    }

    /// Whether the goals of a share, whose weighted residual has changed by `change`, are where they were.
    pub(crate) fn is_kept(&self, share: Share, change: &[f64]) -> bool {
        self.tasks_of(share).all(|(_, task, rows)| {
            let mut kept = task.blocks().filter(|block| task.keeps(block));
            kept.all(|block| {
                let rows = block.rows_after(task.rows.start, rows.start);
                norm(&change[rows]) <= block.kept_within()
            })
        })
    }

    /// Half the range that values of a variable without bounds are drawn from: π or the reach.
    pub(crate) fn spread(&self, variable: usize) -> f64 {
        self.spread[variable]
    }

    /// Where the chain of a task's first frame begins, if that is known.
    pub(crate) fn anchor(&self, task: usize) -> Option<&Anchor> {
        self.names.anchors.get(task)?.as_ref()
    }

    /// Marks the variables that move a missed goal and no reached one, given the weighted residual of
    /// a share there; all that any task feels where there is none such.
    pub(crate) fn mark_local(&self, share: Share, r: &[f64], marked: &mut [bool]) {
        marked.fill(false);
        for pass_reached in [false, true] {
            for (index, task, _) in self.tasks_of(share) {
                let mut blocks = self.errors(share, r).filter(|block| block.task == index);
                let missed = blocks.any(|block| !block.reached);
                // A closed loop holds nothing still: its joints may move anywhere and close it again.
                let counts = task.role == Role::Goal && !(pass_reached && task.is_loop);
                if counts && missed != pass_reached {
                    for variable in self.variables_moving(task) {
                        marked[variable] = missed;
                    }
                }
            }
        }
        if !marked.contains(&true) {
            marked.copy_from_slice(&self.moving);
        }
    }

    /// Whether a variable moves a free joint, and with it the whole of a body.
    pub(crate) fn floats(&self, variable: usize) -> bool {
        self.floating.get(variable).is_some_and(|floats| *floats)
    }

    /// Whether the whole of a body moves freely.
    pub(crate) fn has_free_joint(&self) -> bool {
        self.floating.contains(&true)
    }

    /// The bounded swing that a variable is one of the two numbers of.
    pub(crate) fn swing_at(&self, variable: usize) -> Option<&Swing> {
        self.rotations.swing_of(variable)
    }

    /// Whether any task of the search depends on a variable.
    pub(crate) fn moves_a_task(&self, variable: usize) -> bool {
        self.moving[variable]
    }

    fn mark_moving(&mut self) {
        let mut moving = vec![false; self.variables()];
        for variable in self
            .tasks_of(self.search_share())
            .flat_map(|(_, task, _)| self.variables_moving(task))
        {
            moving[variable] = true;
        }
        self.moved = MovedVariables::of(&moving, &self.rotations, &self.step_scale);
        self.moving = moving;
    }

    /// Sweeps pass every joint and frame once, where each frame by itself passes all joints that move it.
    fn choose_sweeps(&mut self) {
        let Self { tree, tasks, .. } = self;
        for task in tasks {
            let slots = task.frames.iter();
            let passed: usize = slots.map(|&slot| tree.variables_moving(slot).count()).sum();
            task.swept = passed > SWEPT * (tree.joints() + task.frames.len());
        }
    }

    /// Joins variables that a task of a share depends on together: afterwards `joined` has for each variable the lowest one that it is
    /// joined with. Shape: variables, each its own index before. Returns the number of separate sets that tasks depend on.
    pub(crate) fn join_by_tasks(&self, share: Share, joined: &mut [usize]) -> usize {
        fn root(joined: &[usize], mut variable: usize) -> usize {
            while joined[variable] != variable {
                variable = joined[variable];
            }
            variable
        }
        for (_, task, _) in self.tasks_of(share) {
            let mut first = None;
            for variable in self.variables_moving(task) {
                let own = root(joined, variable);
                let lowest = own.min(*first.get_or_insert(own));
                let highest = own.max(first.unwrap_or(own));
                joined[highest] = lowest;
                first = Some(lowest);
            }
        }
        for variable in 0..joined.len() {
            joined[variable] = root(joined, variable);
        }
        let moves_a_task =
            |variable: &usize| joined[*variable] == *variable && self.moving[*variable];
        (0..joined.len()).filter(moves_a_task).count()
    }

    /// Whether the goals of a share that depend on a set of [joined](Self::join_by_tasks) variables are reached, by the weighted
    /// residual of the share. False for a set that no goal depends on.
    pub(crate) fn is_limb_reached(
        &self,
        share: Share,
        residual: &[f64],
        joined: &[usize],
        limb: usize,
    ) -> bool {
        let mut any = false;
        for block in self
            .errors(share, residual)
            .filter(|block| block.role == Role::Goal)
        {
            let mut moving = self.variables_moving(&self.tasks[block.task]);
            if moving
                .next()
                .is_some_and(|variable| joined[variable] == limb)
            {
                any = true;
                if !block.reached {
                    return false;
                }
            }
        }
        any
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

    /// For every block of rows of a share: its task, its quantity, the error in that quantity's unit
    /// for the share's weighted residual `r`, and whether it is within tolerance. Rows of weight 0 say
    /// nothing about their error and are not asked for.
    pub(crate) fn errors<'a>(
        &'a self,
        share: Share,
        r: &'a [f64],
    ) -> impl Iterator<Item = BlockError> + 'a {
        let tasks = self.tasks.iter().enumerate();
        tasks.flat_map(move |(task, compiled)| {
            let rows = self.ranks.rows_in(compiled, share);
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

    /// Whether any rows have weight 0.
    pub(crate) fn leaves_rows_out(&self) -> bool {
        let mut blocks = self.tasks.iter().flat_map(CompiledTask::blocks);
        blocks.any(|block| block.weight == 0.0)
    }

    /// The true errors of rows of weight 0, by the unweighted residual of the whole problem, in the
    /// order of [`errors`](Self::errors); `None` for the others.
    pub(crate) fn unasked_errors<'a>(
        &'a self,
        unweighted: &'a [f64],
    ) -> impl Iterator<Item = Option<f64>> + 'a {
        let blocks = self.tasks.iter().flat_map(CompiledTask::blocks);
        blocks.map(|block| {
            let norm = || norm(&unweighted[block.rows.clone()]);
            (block.weight == 0.0).then(|| block.measure.error_of(norm()))
        })
    }

    /// Whether all goals are near, given the weighted residual of a share at the start: those that are not reached miss by at most
    /// [`NEARBY`], metres as a share of the distance that counts as much as a radian.
    pub(crate) fn is_nearby(&self, share: Share, r: &[f64]) -> bool {
        self.errors(share, r).all(|block| {
            let most = match block.quantity {
                Quantity::Radians => NEARBY,
                Quantity::Metres => NEARBY * builder::RADIAN_PER_REACH * self.reach,
                _ => 0.0,
            };
            block.reached || block.role == Role::Preference || block.error <= most
        })
    }

    /// As [`is_reached`](Self::is_reached), by the residual of a share.
    pub(crate) fn is_reached_by(&self, share: Share, r: &[f64]) -> bool {
        r.len() == self.rows_of(share)
            && self
                .errors(share, r)
                .all(|block| block.reached || block.role == Role::Preference)
    }
}

/// Largest error of a target near the start, radians (metres by their weight). For near targets the first attempt runs to its
/// end before any other is made. Farther targets leave an attempt that stalls to the other attempts, which take less time than
/// continuing it.
pub(crate) const NEARBY: f64 = 1.0;

/// A task is swept where its frames pass so many times more joints than a sweep does.
const SWEPT: usize = 2;

/// Euclidean norm, also where squares are too small or too large for a number.
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

/// The error of one block of rows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockError {
    pub(crate) task: usize,
    pub(crate) quantity: Quantity,
    pub(crate) error: f64,
    pub(crate) reached: bool,
    pub(crate) role: Role,
}
