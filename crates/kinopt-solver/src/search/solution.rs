//! Result of a solve, measured at the returned configuration.

use std::sync::Arc;

use super::Collision;
use super::out_of_reach::OutOfReach;
use super::search_result::SearchResult;
use crate::problem::ReportNames;
use crate::solver::{Counts, Side, Termination};
use crate::task::{Quantity, Role};
use kinopt_kinematics::buffer::vacate;
use kinopt_kinematics::scalar::elementary;

/// Origin of an active bound.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum BoundKind {
    /// The limit of the joint.
    #[default]
    Limit,
    /// The limit of the joint's displacement from the start.
    Move,
}

/// A limit that holds the solution back: the joint is at it, and the cost would fall beyond it by more than the
/// stationarity tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ActiveLimit<'a> {
    /// Name of the joint. For a ball joint with limits it may end in "swing" or "twist".
    pub joint: &'a str,
    /// Side of the limit.
    pub side: Side,
    /// Limit of the joint, or of its displacement.
    pub kind: BoundKind,
    /// Value of the limit in radians or metres. Limits of a ball joint's swing, total angle and move are angles.
    pub value: f64,
    /// True if the limit is an angle.
    pub is_angle: bool,
    /// Rate at which the cost would fall beyond the limit, per radian or metre.
    pub push: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Blocked {
    pub(super) variable: usize,
    pub(super) side: Side,
    pub(super) kind: BoundKind,
    pub(super) value: f64,
    /// The limit belongs to the joint, not to one of a ball joint's variables.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) is_whole: bool,
    #[cfg_attr(feature = "serde", serde(with = "super::non_finite"))]
    pub(super) push: f64,
}

/// Error of a task's rows of one quantity, without weights.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RowBlockReport {
    pub(super) task: usize,
    /// Quantity of the error, which gives its unit.
    pub quantity: Quantity,
    /// Euclidean norm of the rows without weights, in the unit of `quantity`.
    #[cfg_attr(feature = "serde", serde(with = "super::non_finite"))]
    pub error: f64,
    /// True if the error is within the task's tolerance. Rows of weight 0 always count as reached.
    pub reached: bool,
    pub(super) role: Role,
}

/// Result of one task.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct TaskReport<'a> {
    /// Name of the task.
    pub name: &'a str,
    /// First frame of the task, if it has any.
    pub frame: Option<&'a str>,
    /// Required or soft task.
    pub role: Role,
    /// True for the closure of a loop of the model, which is added automatically.
    pub is_loop: bool,
    /// [Priority level](crate::task::Task::at_level) of the task; lower levels take precedence.
    pub level: usize,
    /// True if all rows with a weight are within tolerance.
    pub reached: bool,
    /// Errors by quantity.
    pub rows: &'a [RowBlockReport],
}

impl TaskReport<'_> {
    /// Error in rows of `quantity`, in its unit; `None` without such rows.
    #[must_use]
    pub fn error(&self, quantity: Quantity) -> Option<f64> {
        let mut rows = self.rows.iter().filter(|r| r.quantity == quantity);
        let first = rows.next()?.error;
        Some(rows.fold(first, |sum, r| elementary::hypot(sum, r.error)))
    }

    /// Error in metres.
    #[must_use]
    pub fn position_error(&self) -> Option<f64> {
        self.error(Quantity::Metres)
    }

    /// Error in radians.
    #[must_use]
    pub fn orientation_error(&self) -> Option<f64> {
        self.error(Quantity::Radians)
    }
}

/// Result of a solve, reached or not: the best configuration found, and measurements of it.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Solution {
    /// The configuration, with the length of a configuration of the model, exactly within all limits.
    pub q: Vec<f64>,
    /// True if every required task is within its tolerances at `q` and there are no [collisions](Self::collisions).
    pub reached: bool,
    /// Test that ended the returned attempt, or event that ended the whole search early: the time limit or the
    /// observer. For a reached solution the event ended the comparison of solutions or the minimisation of soft tasks.
    pub termination: Termination,
    /// Cost ½ Σ ‖W r‖² at `q`, of required and soft tasks.
    #[cfg_attr(feature = "serde", serde(with = "super::non_finite"))]
    pub cost: f64,
    /// Projected gradient ‖proj(x − g) − x‖∞ at `q`. It is that of the required tasks if soft tasks act within them.
    /// `None` if the required tasks were reached first.
    #[cfg_attr(feature = "serde", serde(with = "super::non_finite::optional"))]
    pub projected_gradient: Option<f64>,
    /// Total number of steps of all attempts.
    pub iterations: usize,
    /// Number of attempts, including that from the caller's start. If priority levels are searched one by one, it is
    /// that of the search with the most attempts.
    pub attempts: usize,
    /// Number of attempts whose cost agrees with this solution within a thousandth, including its own. 0 for a solution
    /// that is reached or was cut short, or if attempts are not compared. Many agreeing attempts make it likely, but do
    /// not prove, that the target is out of reach.
    pub agreeing: usize,
    /// Total number of evaluations of all attempts.
    pub counts: Counts,
    pub(super) rows: Vec<RowBlockReport>,
    pub(super) blocked: Vec<Blocked>,
    /// Soft tasks that are weighted against the required tasks and keep them from being reached, strongest first.
    pub(crate) pulling: Vec<usize>,
    pub(super) beyond: Option<OutOfReach>,
    /// Number of boxes of joint values by which a proof excluded all configurations.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) excluded_boxes: Option<usize>,
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) collisions: Vec<Collision>,
    pub(super) names: Option<Arc<ReportNames>>,
}

impl Default for Solution {
    fn default() -> Self {
        Self {
            q: Vec::new(),
            reached: false,
            termination: Termination::NonFinite,
            cost: f64::INFINITY,
            projected_gradient: None,
            iterations: 0,
            attempts: 0,
            agreeing: 0,
            counts: Counts::default(),
            rows: Vec::new(),
            blocked: Vec::new(),
            pulling: Vec::new(),
            beyond: None,
            excluded_boxes: None,
            collisions: Vec::new(),
            names: None,
        }
    }
}

impl Solution {
    /// Reserves memory for all tasks and variables that an unreached solution may list, so that later solves do not
    /// allocate.
    pub(crate) fn reserve(&mut self, tasks: usize, variables: usize) {
        vacate(&mut self.pulling, tasks);
        vacate(&mut self.blocked, variables);
    }

    /// Takes the result of a search, except its configuration.
    #[doc(hidden)]
    pub fn record(&mut self, result: &SearchResult) {
        self.termination = result.termination;
        self.projected_gradient = result.projected_gradient;
        self.iterations = result.iterations;
        self.attempts = result.attempts;
        self.agreeing = result.agreeing;
        self.counts = result.counts;
        self.excluded_boxes = None;
        self.collisions.clear();
    }

    /// Results of all tasks in the order in which they were added, then those of the model's loops.
    pub fn tasks(&self) -> impl Iterator<Item = TaskReport<'_>> {
        let groups = self.rows.chunk_by(|a, b| a.task == b.task);
        groups.filter_map(|rows| {
            let (names, first) = (self.names.as_deref()?, rows.first()?);
            Some(TaskReport {
                name: names.tasks.get(first.task)?,
                frame: names.task_frames.get(first.task)?.as_deref(),
                role: first.role,
                is_loop: first.task + names.loops.len() >= names.tasks.len(),
                level: names.task_levels.get(first.task).copied().unwrap_or(0),
                reached: rows.iter().all(|r| r.reached),
                rows,
            })
        })
    }

    /// Largest error of any required task in rows of `quantity`, in its unit; `None` without such rows.
    #[must_use]
    pub fn error(&self, quantity: Quantity) -> Option<f64> {
        let goals = self.tasks().filter(|task| task.role == Role::Goal);
        let errors = goals.filter_map(|task| task.error(quantity));
        // NaN counts as larger than any error.
        errors.reduce(|max_error, error| {
            if error > max_error || error.is_nan() {
                error
            } else {
                max_error
            }
        })
    }

    /// Largest error of any required task in metres.
    #[must_use]
    pub fn position_error(&self) -> Option<f64> {
        self.error(Quantity::Metres)
    }

    /// Largest error of any required task in radians.
    #[must_use]
    pub fn orientation_error(&self) -> Option<f64> {
        self.error(Quantity::Radians)
    }

    /// Reports whether a required task is provably out of reach: its target is farther from the start of its chain
    /// than the chain is long, or an arm's `reachability` excluded all configurations. False if this is unknown.
    #[must_use]
    pub fn is_out_of_reach(&self) -> bool {
        self.beyond.is_some() || self.excluded_boxes.is_some()
    }

    /// Adds a proof over boxes of joint values that the target is out of reach.
    #[doc(hidden)]
    #[must_use]
    pub fn proven_unreachable(mut self, boxes: usize) -> Self {
        self.excluded_boxes = Some(boxes);
        self
    }

    /// Soft tasks that keep required tasks from being reached, strongest first. Empty unless soft tasks are
    /// [weighted](crate::problem::Preferences::Traded) against required tasks.
    pub fn pulling_preferences(&self) -> impl Iterator<Item = &str> {
        self.pulling.iter().filter_map(|&task| {
            let names = self.names.as_deref()?;
            names.tasks.get(task).map(String::as_str)
        })
    }

    /// Limits that hold the solution back; empty for a reached solution.
    pub fn active_limits(&self) -> impl Iterator<Item = ActiveLimit<'_>> {
        self.blocked.iter().filter_map(|blocked| {
            let names = self.names.as_deref()?;
            let joint_names = match blocked.is_whole {
                true => &names.joints,
                false => &names.variables,
            };
            Some(ActiveLimit {
                joint: joint_names.get(blocked.variable)?,
                side: blocked.side,
                kind: blocked.kind,
                value: blocked.value,
                is_angle: *names.variable_is_angle.get(blocked.variable)?,
                push: blocked.push,
            })
        })
    }
}
