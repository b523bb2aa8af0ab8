//! What came out, measured on the configuration that is returned.

use std::sync::Arc;

use super::Collision;
use super::attempt::Found;
use super::out_of_reach::Beyond;
use crate::buffer::vacate;
use crate::problem::ReportNames;
use crate::scalar::elementary;
use crate::solver::{Counts, Side, Termination};
use crate::task::{Quantity, Role};

/// Whose bound it is that a joint stands on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum BoundKind {
    /// The joint's own limit.
    #[default]
    Limit,
    /// How far the question lets the joint move from the start.
    Move,
}

/// A limit that holds the solution back: the joint stands on it and the cost would fall beyond it
/// by more than what counts as stationary.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct ActiveLimit<'a> {
    /// The joint's name; of a ball with a cone, with "swing" or "twist" where it is one of those.
    pub joint: &'a str,
    /// Which limit.
    pub side: Side,
    /// The joint's limit, or that of its move.
    pub kind: BoundKind,
    /// The limit, in radians or metres; of a ball's swing, its whole angle or its move, that angle.
    pub value: f64,
    /// Whether the limit is an angle.
    pub is_angle: bool,
    /// How fast the cost would fall beyond it, per radian or metre.
    pub push: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Blocked {
    pub(super) variable: usize,
    pub(super) side: Side,
    pub(super) kind: BoundKind,
    pub(super) value: f64,
    /// Of the joint as a whole, not of one of a ball's variables.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(super) is_whole: bool,
    #[cfg_attr(feature = "serde", serde(with = "super::non_finite"))]
    pub(super) push: f64,
}

/// The error of a task's rows of one quantity, before weighting.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct RowsReport {
    pub(super) task: usize,
    /// The unit of the error.
    pub quantity: Quantity,
    /// Euclidean norm of the rows, in the unit of `quantity`, whatever their weight.
    #[cfg_attr(feature = "serde", serde(with = "super::non_finite"))]
    pub error: f64,
    /// Whether the error is within the task's tolerance. Rows of weight 0 are not asked for: they never
    /// count as missed.
    pub reached: bool,
    pub(super) role: Role,
}

/// How one task came out.
#[derive(Clone, Copy, Debug)]
#[non_exhaustive]
pub struct TaskReport<'a> {
    /// The task's name.
    pub name: &'a str,
    /// The first frame it looks at, if any.
    pub frame: Option<&'a str>,
    /// Goal or preference.
    pub role: Role,
    /// Whether it closes a loop of the model: no one added it.
    pub is_loop: bool,
    /// The strict [level](crate::task::Task::at_level) it is on; lower ones come first.
    pub level: usize,
    /// Whether all its rows that have a weight are within tolerance.
    pub reached: bool,
    /// Its errors, quantity by quantity.
    pub rows: &'a [RowsReport],
}

impl TaskReport<'_> {
    /// The error in rows of `quantity`, in its unit; `None` if the task has no such rows.
    #[must_use]
    pub fn error(&self, quantity: Quantity) -> Option<f64> {
        let mut rows = self.rows.iter().filter(|r| r.quantity == quantity);
        let first = rows.next()?.error;
        Some(rows.fold(first, |sum, r| elementary::hypot(sum, r.error)))
    }

    getters! {
        /// The error in metres.
        pub fn position_error(&self) -> Option<f64> = self.error(Quantity::Metres);
        /// The error in radians.
        pub fn orientation_error(&self) -> Option<f64> = self.error(Quantity::Radians);
    }
}

/// The result of a solve, reached or not: the best configuration found and the truth about it.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Solution {
    /// The configuration (shape: the model's degrees of freedom), within all limits to the bit.
    pub q: Vec<f64>,
    /// Whether every goal is within its tolerances at `q`, and nothing [touches](Self::collisions).
    pub reached: bool,
    /// Which test ended the attempt that is returned, or what ended the whole search early: the clock
    /// or the observer. Of a solution that is reached these ended a comparison or the preferences' pull.
    pub termination: Termination,
    /// ½ Σ ‖W r‖² at `q`, of goals and preferences.
    #[cfg_attr(feature = "serde", serde(with = "super::non_finite"))]
    pub cost: f64,
    /// ‖proj(x − g) − x‖∞ at `q`, of the goals' cost where preferences act within them; `None` when the
    /// goals were reached first.
    #[cfg_attr(feature = "serde", serde(with = "super::non_finite::optional"))]
    pub projected_gradient: Option<f64>,
    /// Steps of all attempts together.
    pub iterations: usize,
    /// Attempts made, the caller's start included; where strict levels are searched one by one, in the search that
    /// made most.
    pub attempts: usize,
    /// How many of the attempts stopped as near as this solution, within a thousandth of the cost, itself
    /// included; 0 where it is reached, where it was cut short, or where attempts are not compared.
    /// Many that agree are no proof that a target is out of reach, but most often it is.
    pub agreeing: usize,
    /// Evaluations of all attempts together.
    pub counts: Counts,
    pub(super) rows: Vec<RowsReport>,
    pub(super) blocked: Vec<Blocked>,
    /// The preferences that goals are traded off against, the strongest first.
    pub(crate) pulling: Vec<usize>,
    pub(super) beyond: Option<Beyond>,
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
            collisions: Vec::new(),
            names: None,
        }
    }
}

impl Solution {
    /// Makes room for what a problem with so many tasks and variables may miss: a first solve that reaches its
    /// target names nothing, a later one may name all.
    pub(crate) fn reserve(&mut self, tasks: usize, variables: usize) {
        vacate(&mut self.pulling, tasks);
        vacate(&mut self.blocked, variables);
    }

    /// Takes what the attempts came to, all but where that is.
    pub(crate) fn tell(&mut self, found: &Found) {
        self.termination = found.termination;
        self.projected_gradient = found.projected_gradient;
        self.iterations = found.iterations;
        self.attempts = found.attempts;
        self.agreeing = found.agreeing;
        self.counts = found.counts;
        self.collisions.clear();
    }

    /// Every task's outcome, in the order in which the tasks were added; after them the model's loops.
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

    /// The largest error of any goal in rows of `quantity`, in its unit; `None` if no goal has such rows.
    #[must_use]
    pub fn error(&self, quantity: Quantity) -> Option<f64> {
        let goals = self.tasks().filter(|task| task.role == Role::Goal);
        let errors = goals.filter_map(|task| task.error(quantity));
        // NaN is larger than any error: nothing is known to be near.
        errors.reduce(|most, error| {
            if error > most || error.is_nan() {
                error
            } else {
                most
            }
        })
    }

    getters! {
        /// The largest error of any goal in metres.
        pub fn position_error(&self) -> Option<f64> = self.error(Quantity::Metres);
        /// The largest error of any goal in radians.
        pub fn orientation_error(&self) -> Option<f64> = self.error(Quantity::Radians);
        /// Whether a missed goal is certainly out of reach: its place is farther from where the chain
        /// begins than the chain is long. False where that is not known.
        pub fn is_out_of_reach(&self) -> bool = self.beyond.is_some();
    }

    /// The preferences that keep a missed goal from coming nearer, the strongest first. Only where they
    /// are [traded](crate::problem::Preferences::Traded) off against goals can there be any.
    pub fn pulling_preferences(&self) -> impl Iterator<Item = &str> {
        self.pulling.iter().filter_map(|&task| {
            let names = self.names.as_deref()?;
            names.tasks.get(task).map(String::as_str)
        })
    }

    /// The limits that hold the solution back; empty when it is reached.
    pub fn active_limits(&self) -> impl Iterator<Item = ActiveLimit<'_>> {
        self.blocked.iter().filter_map(|blocked| {
            let names = self.names.as_deref()?;
            let own = match blocked.is_whole {
                true => &names.joints,
                false => &names.variables,
            };
            Some(ActiveLimit {
                joint: own.get(blocked.variable)?,
                side: blocked.side,
                kind: blocked.kind,
                value: blocked.value,
                is_angle: *names.variable_is_angle.get(blocked.variable)?,
                push: blocked.push,
            })
        })
    }
}
