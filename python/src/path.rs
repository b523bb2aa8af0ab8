//! Cartesian paths of arms, with the fewest reconfigurations.

use std::path::PathBuf;
use std::sync::Arc;

use kinopt::motion::path::{self, QuaternionOrder};
use kinopt_bindings::names::miss_reason;
use kinopt_bindings::option::path::{PathOptions, TRAVERSALS};
use kinopt_bindings::per_joint::per_joint;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arm::Arm;
use crate::arrays;
use crate::cartesian_path::{CartesianPath, path_of};
use crate::error::{OrRaise, invalid};
use crate::joint_path::JointPath;
use crate::object::Object;
use crate::pickling;
use crate::placement::placements;
use crate::solution::Collision;

/// A point of a path that the tool does not reach.
#[pyclass(frozen, get_all, module = "kinopt")]
#[derive(Clone, Serialize, Deserialize)]
pub(crate) struct MissedPoint {
    /// Row of `q`.
    index: usize,
    /// Position error beyond the goal bounds, metres.
    position_error: f64,
    /// Orientation error beyond the goal bounds, radians.
    orientation_error: f64,
    /// Reason: out of reach, in collision, or not found.
    reason: String,
}

#[pymethods]
impl MissedPoint {
    fn __repr__(&self) -> String {
        format!("MissedPoint(row {}, {})", self.index, self.reason)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_json::<Self>(py, self)
    }

    #[staticmethod]
    fn _rebuild(json: &str) -> PyResult<Self> {
        pickling::of_json(json)
    }
}

/// Errors of the joint path of a Cartesian path.
#[pyclass(frozen, get_all, module = "kinopt")]
#[derive(Serialize, Deserialize)]
pub(crate) struct PathReport {
    /// Index of the point of the first row: 0 except for traversal "any-start".
    entry: usize,
    /// Weighted joint length of all steps.
    length: f64,
    /// Upper bound of the tool's distance from the path between rows, metres.
    largest_deviation: f64,
    /// Row at the end of the step with `largest_deviation`.
    largest_deviation_at: usize,
    /// Upper bound of the tool's rotation from the path between rows, radians.
    largest_turn: f64,
    /// Row at the end of the step with `largest_turn`.
    largest_turn_at: usize,
    /// Points that are not reached, in order.
    missed: Vec<MissedPoint>,
    /// Steps that are not proven collision-free, for an arm with a world: (row at the end of the step, `Collision`).
    blocked: Vec<(usize, Collision)>,
    /// Interpretation of a file's columns; None for an array.
    read_as: Option<String>,
}

#[pymethods]
impl PathReport {
    fn __repr__(&self) -> String {
        format!(
            "PathReport({} missed, {} blocked, length {:.3})",
            self.missed.len(),
            self.blocked.len(),
            self.length
        )
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_json::<Self>(py, self)
    }

    #[staticmethod]
    fn _rebuild(json: &str) -> PyResult<Self> {
        pickling::of_json(json)
    }
}

/// Solves a Cartesian path of an arm's tool with the fewest reconfigurations, then the shortest: a `JointPath` with
/// a `PathReport`.
///
/// `path` has one of three forms. A `CartesianPath`. Placements, as in `Arm.solve_batch`. A table: the path of its file,
/// whose header names the columns. `order`, "w-first" or "w-last", is that of unnamed quaternion columns and of points
/// of shape (N, 7). Between two points the tool moves straight and rotates at a constant rate. The arm defines the goal
/// bounds and the obstacles. Positions alone require an arm with `goal="position"`.
///
/// `times`: seconds, shape (N,). With `keep_times`, a step that is too fast for a joint also counts as a
/// reconfiguration. `traversal`: "open", "cyclic" (repeatedly, ends in its first configuration) or "any-start" (once
/// around, from the best point). `start` and `end`: configurations of the first and last row, shape (dof,) or a dict by
/// joint name. `joint_weights`: weight of a radian or metre of each joint in lengths, or one number for all. `max_step`: largest joint displacement from point to point on one
/// branch, radians. `samples`: largest number of configurations for each point. `tools`: for `tool_of_points` (N,), or
/// the column `tool` of a table, which give the arm of each point: 0 is this one, 1 and so on are those of `tools`
/// (`arm.with_tool`).
///
/// Raises `InvalidValueError` with the point or option, and `FileError` or `InvalidFileError` for a file.
#[pyfunction]
#[pyo3(signature = (arm, path, *, start = None, end = None, traversal = None, joint_weights = None,
    max_step = 0.2, times = None, keep_times = false, samples = 256, tools = None, tool_of_points = None, order = None))]
#[expect(clippy::too_many_arguments, reason = "they are keywords")]
pub(crate) fn solve_path(
    py: Python<'_>,
    arm: &Bound<'_, Arm>,
    path: &Bound<'_, PyAny>,
    start: Option<&Bound<'_, PyAny>>,
    end: Option<&Bound<'_, PyAny>>,
    traversal: Option<&Bound<'_, PyAny>>,
    joint_weights: Option<&Bound<'_, PyAny>>,
    max_step: f64,
    times: Option<&Bound<'_, PyAny>>,
    keep_times: bool,
    samples: usize,
    tools: Option<Vec<Bound<'_, Arm>>>,
    tool_of_points: Option<Vec<usize>>,
    order: Option<&Bound<'_, PyAny>>,
) -> PyResult<JointPath> {
    let (path, read_as) = read(path, order)?;
    let numbers = |value: Option<&Bound<'_, PyAny>>, what: &str| {
        value.map(|value| arrays::copied(value, what)).transpose()
    };
    let joints: Vec<String> = arm.get().inner.joints().map(str::to_owned).collect();
    let configuration = |value: Option<&Bound<'_, PyAny>>, what: &str| {
        let value = value
            .map(|value| arm.get().by_position(value, what))
            .transpose()?;
        numbers(value.as_ref(), what)
    };
    let options = PathOptions {
        times: numbers(times, "times")?,
        keep_times,
        traversal: one_of(traversal, "traversal", TRAVERSALS)?,
        start: configuration(start, "start")?,
        end: configuration(end, "end")?,
        joint_weights: joint_weights
            .map(|weights| per_joint(&Object::of(weights), "joint_weights", &joints, Some(1.0)))
            .transpose()?,
        max_step,
        samples,
        tool_of_points,
    };
    let path = options.path::<Object>(path)?;
    let inner_arm = Arc::clone(&arm.get().inner);
    let other_arms = tools.iter().flatten();
    let other_arms: Vec<_> = other_arms.map(|arm| Arc::clone(&arm.get().inner)).collect();
    let solution = py.detach(|| {
        let tools = other_arms.iter().map(|arm| &**arm);
        options.solve(&inner_arm, tools, &path)
    });
    let solution = solution.or_raise()?;
    let reached = solution.reached();
    let (solution, report) = solution.split_report();
    let report = Py::new(py, path_report(report, read_as))?.into_any();
    Ok(JointPath::new(arm, solution, reached, report))
}

fn path_report(report: path::PathReport, read_as: Option<String>) -> PathReport {
    let missed = report.missed.iter().map(|missed| MissedPoint {
        index: missed.index,
        position_error: missed.position_error,
        orientation_error: missed.orientation_error,
        reason: miss_reason(&missed.reason),
    });
    let blocked = report.blocked.into_iter();
    let blocked = blocked.map(|blocked| (blocked.index, Collision::from(blocked.by)));
    let deviation = report.largest_deviation;
    PathReport {
        entry: report.entry,
        length: report.length,
        largest_deviation: deviation.metres,
        largest_deviation_at: deviation.metres_at,
        largest_turn: deviation.radians,
        largest_turn_at: deviation.radians_at,
        missed: missed.collect(),
        blocked: blocked.collect(),
        read_as,
    }
}

/// Reads a path from placements, points or a file, with the interpretation of the file's columns.
fn read(
    path: &Bound<'_, PyAny>,
    order: Option<&Bound<'_, PyAny>>,
) -> PyResult<(path::CartesianPath, Option<String>)> {
    let orders = [
        ("w-first", QuaternionOrder::WFirst),
        ("w-last", QuaternionOrder::WLast),
    ];
    let order = one_of(order, "order", orders)?;
    if let Ok(file) = path.extract::<PathBuf>() {
        let (path, columns) = path::CartesianPath::read(file, order).or_raise()?;
        return Ok((path, Some(columns.to_string())));
    }
    if let Ok(path) = path.cast::<CartesianPath>() {
        return Ok((path.get().inner.clone(), None));
    }
    let numpy = arrays::numpy(path.py())?;
    let shape = numpy.call_method1("shape", (path,));
    let shape = shape.and_then(|shape| shape.extract::<Vec<usize>>());
    let path = match (shape.as_deref(), order) {
        (Ok([_, 7]), QuaternionOrder::WLast) => {
            &numpy.call_method1("take", (path, [0, 1, 2, 6, 3, 4, 5], 1))?
        }
        _ => path,
    };
    let placements = placements(path, "point")?;
    let path = path_of(placements.to_vec("point")?, placements.oriented)?;
    Ok((path, None))
}

/// Returns the value of a word; the first of all without a word.
fn one_of<const N: usize, T: Copy>(
    argument: Option<&Bound<'_, PyAny>>,
    what: &str,
    all: [(&str, T); N],
) -> PyResult<T> {
    let valid = all.map(|(word, _)| word);
    let Some(argument) = argument else {
        return Ok(all[0].1);
    };
    let word = arrays::word(argument, what, &valid)?;
    let entry = all.iter().find(|(known, _)| *known == word);
    entry.map(|(_, value)| *value).ok_or_else(|| {
        invalid(format!(
            "{what} must be one of {}, not {word:?}",
            valid.join(", ")
        ))
    })
}
