//! Report of a solution, as text and JSON.

use kinopt::ik::{BoundKind, Side};
use serde::Serialize;

use super::derivative::TargetDerivatives;
use super::query::{Answer, PoseOrigin, Settled};
use super::self_motion::{self, SelfMotionCurve};
use super::task_name::TaskName;
use crate::collision_document::CollisionDocument;
use crate::loaded_model::LoadedModel;
use crate::number_format::{magnitude, six_digits, time};
use crate::table::Table;

/// Answer with its query.
#[derive(Clone, Copy)]
pub(super) struct Report<'a> {
    pub(super) loaded: &'a LoadedModel,
    pub(super) answer: &'a Answer,
    pub(super) tasks: &'a [TaskName],
    /// Coordinates that no task depends on; text does not show them.
    pub(super) idle: &'a [usize],
    /// True if obstacles are avoided.
    pub(super) keeps_clear: bool,
}

#[derive(Serialize)]
pub(super) struct Document<'a> {
    q: &'a [f64],
    /// Joint names of q, for a robot; given once for several answers.
    #[serde(skip_serializing_if = "Option::is_none")]
    joints: Option<Vec<&'a str>>,
    /// Further solutions.
    #[serde(skip_serializing_if = "<[_]>::is_empty")]
    alternatives: &'a [Vec<f64>],
    /// True if the solutions are a complete set.
    #[serde(skip_serializing_if = "Option::is_none")]
    complete: Option<bool>,
    /// Curves of solutions of seven revolute joints, for one target.
    #[serde(skip_serializing_if = "Option::is_none")]
    self_motions: Option<&'a [SelfMotionCurve]>,
    reached: bool,
    /// True if all required tasks are reached, whether in contact or not.
    goals_reached: bool,
    termination: &'static str,
    cost: f64,
    tasks: Vec<TaskDocument<'a>>,
    active_limits: Vec<LimitDocument<'a>>,
    /// Open loops, for a model with loops.
    #[serde(skip_serializing_if = "Option::is_none")]
    open_loops: Option<Vec<OpenLoopDocument<'a>>>,
    /// Pairs in contact, if obstacles are avoided.
    #[serde(skip_serializing_if = "Option::is_none")]
    collisions: Option<Vec<CollisionDocument<'a>>>,
    iterations: usize,
    attempts: usize,
    /// Number of attempts that ended at the same unreached pose; 0 if reached or not counted.
    agreeing_attempts: usize,
    /// True if the target is proven unreachable: farther away than the chain is long.
    out_of_reach: bool,
    /// `way`: `own` for convergence from the start, `another` for the result of a search; and the lower cost of another
    /// unreached pose.
    #[serde(flatten)]
    settled: Option<Settled>,
    evaluations: Evaluations,
    /// Derivative of q by the targets, with `derivative`.
    #[serde(skip_serializing_if = "Option::is_none")]
    derivative: Option<&'a TargetDerivatives>,
    /// Solve time in microseconds; `None` for targets that are solved together.
    #[serde(skip_serializing_if = "Option::is_none")]
    micros: Option<f64>,
    explanation: String,
    /// Notes about omitted or computed data; given once for several answers.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
}

#[derive(Serialize)]
struct TaskDocument<'a> {
    name: &'a str,
    frame: &'a str,
    /// Position error in metres (skeletons: the file's unit).
    position_error: Option<f64>,
    /// Orientation error in radians.
    orientation_error: Option<f64>,
    reached: bool,
    held: bool,
    /// Priority level, from 0.
    level: usize,
}

#[derive(Serialize)]
struct LimitDocument<'a> {
    joint: &'a str,
    side: &'static str,
    /// `limit` of the joint, or end of its allowed `move`.
    kind: &'static str,
    /// Value of the bound, in radians or metres.
    value: f64,
}

#[derive(Serialize)]
struct OpenLoopDocument<'a> {
    name: &'a str,
    /// Closure error in metres.
    gap: f64,
    /// Closure error in radians.
    angle: f64,
}

#[derive(Serialize)]
struct Evaluations {
    residuals: usize,
    jacobians: usize,
    gradients: usize,
}

impl<'a> Report<'a> {
    /// Document as of [`document`](Self::document), with the joint names of a robot and the notes.
    pub(super) fn whole_document(&self, notes: Vec<String>) -> Document<'a> {
        Document {
            notes,
            joints: self.loaded.documented_joints(),
            ..self.document()
        }
    }

    pub(super) fn document(&self) -> Document<'a> {
        let solution = &self.answer.solution;
        let tasks = solution
            .tasks()
            .zip(self.tasks)
            .map(|(task, task_name)| TaskDocument {
                name: task.name,
                frame: &task_name.frame,
                position_error: task.position_error(),
                orientation_error: task.orientation_error(),
                reached: task.reached,
                held: task_name.held,
                level: task.level,
            });
        let limits = solution.active_limits().map(|limit| LimitDocument {
            joint: limit.joint,
            side: side(limit.side),
            kind: match limit.kind {
                BoundKind::Move => "move",
                _ => "limit",
            },
            value: limit.value,
        });
        let open_loops = solution.open_loops().map(|open| OpenLoopDocument {
            name: open.name,
            gap: open.gap,
            angle: open.angle,
        });
        let collisions = solution.collisions().iter().map(CollisionDocument::of);
        let has_loops = !self.loaded.model.loops().is_empty();
        Document {
            q: &self.answer.q,
            joints: None,
            notes: Vec::new(),
            alternatives: &self.answer.alternatives,
            complete: self.answer.complete,
            self_motions: self.answer.self_motions.as_deref(),
            reached: solution.reached,
            goals_reached: solution.goals_reached(),
            termination: solution.termination.name(),
            cost: solution.cost,
            tasks: tasks.collect(),
            active_limits: limits.collect(),
            open_loops: has_loops.then(|| open_loops.collect()),
            collisions: self.keeps_clear.then(|| collisions.collect()),
            iterations: solution.iterations,
            attempts: solution.attempts,
            agreeing_attempts: solution.agreeing,
            out_of_reach: solution.is_out_of_reach(),
            settled: self.answer.settled,
            derivative: self.answer.derivative.as_ref(),
            evaluations: Evaluations {
                residuals: solution.counts.residuals,
                jacobians: solution.counts.jacobians,
                gradients: solution.counts.gradients,
            },
            micros: self.answer.micros,
            explanation: solution.explain(),
        }
    }

    /// Explanation, errors of the tasks, and values of the free joints.
    pub(super) fn text(&self, degrees: bool) -> String {
        let solution = &self.answer.solution;
        let mut text = solution.explain();
        if !solution.goals_reached() && self.tasks.iter().any(|task| task.held) {
            text.push_str("\n  Held frames keep their poses; --hold selects other frames.");
        }
        let settled = self.answer.settled;
        text.push_str(match settled {
            Some(settled) if settled.way == PoseOrigin::Another => {
                "\n  The branch of the start did not reach the target; a search from other starts found this."
            }
            Some(settled) if settled.lower_cost_elsewhere.is_some() => {
                "\n  A pose on another branch is closer; `global_search_on_miss` returns it."
            }
            _ => "",
        });
        if let Some(micros) = self.answer.micros {
            text.push_str(&format!("\n  Solved in {}.", time(micros)));
        }
        text.push_str("\n\n");
        text.push_str(&self.task_table());
        text.push('\n');
        text.push_str(&self.joint_table(degrees));
        text.push_str(&self.alternatives(degrees));
        let curves = self.answer.self_motions.as_deref();
        text.push_str(&curves.map_or_else(String::new, self_motion::text));
        let derivative = self.answer.derivative.as_ref();
        text.push_str(&derivative.map_or_else(String::new, TargetDerivatives::text));
        text
    }

    /// Further solutions, one line each with the values of the free joints.
    fn alternatives(&self, degrees: bool) -> String {
        let alternatives = &self.answer.alternatives;
        if alternatives.is_empty() {
            return String::new();
        }
        let count = alternatives.len() + 1;
        let mut text =
            format!("\n{count} solutions in all; the others, in the same joint order:\n");
        let shown = self.shown();
        for alternative in alternatives {
            let values = self
                .loaded
                .shown(alternative, degrees)
                .into_iter()
                .zip(&shown);
            let values = values
                .filter(|(_, shown)| **shown)
                .map(|(value, _)| six_digits(value));
            text.push_str(&format!("  {}\n", values.collect::<Vec<_>>().join("  ")));
        }
        text
    }

    /// Flags of the coordinates in the text: free coordinates and those that the command locks.
    fn shown(&self) -> Vec<bool> {
        let mut shown = self.loaded.leading_coordinates();
        for &idle in self.idle {
            if let Some(shown) = shown.get_mut(idle) {
                *shown = false;
            }
        }
        shown
    }

    fn task_table(&self) -> String {
        let solution = &self.answer.solution;
        let turns = solution.tasks().any(|t| t.orientation_error().is_some());
        let orientation = match turns {
            true => "| >orientation error (rad)",
            false => "",
        };
        let unit = self.loaded.length_unit();
        let columns = format!("task | >position error ({unit}) {orientation} | reached");
        let mut table = Table::new(&columns);
        let error = |error: Option<f64>| error.map_or_else(|| "-".to_owned(), magnitude);
        for task in solution.tasks() {
            let mut row = vec![task.name.to_owned(), error(task.position_error())];
            row.extend(turns.then(|| error(task.orientation_error())));
            row.push(if task.reached { "yes" } else { "no" }.to_owned());
            table.row(row);
        }
        table.text()
    }

    fn joint_table(&self, degrees: bool) -> String {
        let unit = if degrees { "degrees" } else { "radians" };
        // Lengths need no conversion, so only a model with prismatic joints needs the second unit.
        let slides = self.loaded.slides();
        let or_metres = if slides { " or metres" } else { "" };
        let balls: Vec<bool> = self.loaded.is_of_ball().collect();
        let all_balls = !balls.is_empty() && balls.iter().all(|&ball| ball);
        let unit = if all_balls { "quaternion" } else { unit };
        let mut table = Table::new(&format!("joint | >{unit}{or_metres} | "));
        let (loaded, q) = (self.loaded, &self.answer.q);
        let values = q.iter().zip(loaded.shown(q, degrees));
        let joints = loaded
            .coordinate_names()
            .into_iter()
            .zip(loaded.model.limits());
        let shown = self.shown().into_iter().zip(loaded.held_coordinates());
        let shown = shown.zip(balls);
        let rows = joints.zip(values).zip(shown);
        for (((joint, limits), (&value, number)), ((shown, held), ball)) in rows {
            if !shown {
                continue;
            }
            let note = if held {
                "locked"
            } else if ball {
                // The ranges of quaternion components are not limits.
                ""
            } else if value <= limits.lower {
                "at its lower limit"
            } else if value >= limits.upper {
                "at its upper limit"
            } else {
                ""
            };
            table.row([&joint, &*six_digits(number), note].map(str::to_owned));
        }
        table.text()
    }
}

fn side(side: Side) -> &'static str {
    match side {
        Side::Lower => "lower",
        Side::Upper => "upper",
    }
}
