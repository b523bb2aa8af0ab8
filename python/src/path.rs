//! Cartesian paths of arms, with the fewest reconfigurations.

use std::path::PathBuf;
use std::sync::Arc;

use kinopt::motion::path::{self, CartesianPath, QuaternionOrder, TimingLimits};
use kinopt::spatial::{Placement, Quaternion, Vector3};
use kinopt_bindings::names::miss_reason;
use kinopt_bindings::option::path::{PathOptions, TRAVERSALS};
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use serde::{Deserialize, Serialize};

use crate::arm::Arm;
use crate::arrays::{self, shape_text};
use crate::error::{OrRaise, invalid};
use crate::joint_jump::JointJump;
use crate::object::Object;
use crate::pickling;
use crate::placement::placements;
use crate::solution::Collision;
use crate::trajectory::Trajectory;

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

/// Joint path for a Cartesian path.
#[pyclass(frozen, module = "kinopt")]
#[derive(Serialize, Deserialize)]
pub(crate) struct PathSolution {
    q: Vec<f64>,
    /// Names of the joints, the columns of `q`.
    #[pyo3(get)]
    joint_names: Vec<String>,
    /// Index of the point of the first row: 0 except for traversal "any-start".
    #[pyo3(get)]
    entry: usize,
    /// Steps in which the arm leaves its branch, in order.
    #[pyo3(get)]
    jumps: Vec<JointJump>,
    /// Weighted joint length of all steps.
    #[pyo3(get)]
    length: f64,
    /// Upper bound of the tool's distance from the path between rows, metres.
    #[pyo3(get)]
    largest_deviation: f64,
    /// Row at the end of the step with `largest_deviation`.
    #[pyo3(get)]
    largest_deviation_at: usize,
    /// Upper bound of the tool's rotation from the path between rows, radians.
    #[pyo3(get)]
    largest_turn: f64,
    /// Row at the end of the step with `largest_turn`.
    #[pyo3(get)]
    largest_turn_at: usize,
    /// Points that are not reached, in order.
    #[pyo3(get)]
    missed: Vec<MissedPoint>,
    /// Steps that are not proven collision-free, for an arm with a world: (row at the end of the step, `Collision`).
    #[pyo3(get)]
    blocked: Vec<(usize, Collision)>,
    /// Interpretation of a file's columns; None for an array.
    #[pyo3(get)]
    read_as: Option<String>,
    /// Velocity and acceleration limits of the arm, rad/s or m/s, and rad/s² or m/s².
    #[serde(with = "pickling::limits")]
    rates: [Vec<f64>; 2],
}

#[pymethods]
impl PathSolution {
    /// Time of each row, shape (N,), seconds, starting at 0: time-optimal under joint acceleration and velocity limits,
    /// shape (dof,) or one number for all joints. Default: the limits of the arm; accelerations come from
    /// `Robot.with_joint_limits`. The arm is at rest before and after a reconfiguration. Equal to
    /// `trajectory(acceleration_limits, velocity_limits).times`.
    ///
    /// Raises `InvalidValueError` for limits that are not above 0, and if no moving joint has a finite acceleration
    /// limit.
    #[pyo3(signature = (acceleration_limits = None, velocity_limits = None))]
    fn times<'py>(
        &self,
        py: Python<'py>,
        acceleration_limits: Option<&Bound<'py, PyAny>>,
        velocity_limits: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let limits = self.timing_limits(acceleration_limits, velocity_limits)?;
        let solved = py.detach(|| self.timed(&limits)).or_raise()?;
        Ok(PyArray1::from_slice(py, solved.times()))
    }

    /// Time-optimal `Trajectory` along the rows, from rest to rest, under joint limits, shape (dof,) or one number for
    /// all joints.
    ///
    /// `acceleration_limits` and `velocity_limits`: as for `times`. `jerk_limits`: largest rates of change of
    /// accelerations, unbounded by default. `tool_linear_limits` and `tool_angular_limits`: largest speed and
    /// acceleration of the tool, in metres or radians and seconds; they require `arm`. `corner_tolerance`: largest
    /// distance of a joint from the path at a blended corner, radians or metres; with 0 the arm stops at corners.
    /// `grid_points`: number of samples of the speed profile over the whole path.
    ///
    /// Joints follow a cubic spline within 1e-5 (radians or metres) of every row. Raises `InvalidValueError` with the
    /// option and joint.
    #[pyo3(signature = (acceleration_limits = None, velocity_limits = None, *, jerk_limits = None, arm = None,
        tool_linear_limits = None, tool_angular_limits = None, corner_tolerance = 1e-3, grid_points = 1000))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn trajectory<'py>(
        slf: &Bound<'py, Self>,
        acceleration_limits: Option<&Bound<'py, PyAny>>,
        velocity_limits: Option<&Bound<'py, PyAny>>,
        jerk_limits: Option<&Bound<'py, PyAny>>,
        arm: Option<&Bound<'py, Arm>>,
        tool_linear_limits: Option<&Bound<'_, PyAny>>,
        tool_angular_limits: Option<&Bound<'_, PyAny>>,
        corner_tolerance: f64,
        grid_points: usize,
    ) -> PyResult<Trajectory> {
        let (py, solution) = (slf.py(), slf.get());
        let arm_inner = arm.map(|arm| Arc::clone(&arm.get().inner));
        let mut limits = solution.timing_limits(acceleration_limits, velocity_limits)?;
        if let Some(jerks) = jerk_limits {
            limits = limits.with_jerk_limits(&solution.one_each(jerks, "jerk_limits")?);
        }
        if let Some(arm) = arm_inner.as_deref() {
            limits = limits.with_arm(arm);
        }
        let tool_linear_limits =
            tool_limits(tool_linear_limits, "tool_linear_limits", "m/s and m/s²")?;
        let tool_angular_limits = tool_limits(
            tool_angular_limits,
            "tool_angular_limits",
            "rad/s and rad/s²",
        )?;
        if let Some((speed, acceleration)) = tool_linear_limits {
            limits = limits.with_tool_linear_limits(speed, acceleration);
        }
        if let Some((speed, acceleration)) = tool_angular_limits {
            limits = limits.with_tool_angular_limits(speed, acceleration);
        }
        let limits = limits
            .with_corner_tolerance(corner_tolerance)
            .with_grid_points(grid_points);
        let inner = py.detach(|| solution.timed(&limits)).or_raise()?;
        // Unpickling recreates the trajectory from the solution.
        let options = PyDict::new(py);
        for (name, value) in [
            ("acceleration_limits", acceleration_limits),
            ("velocity_limits", velocity_limits),
            ("jerk_limits", jerk_limits),
            ("arm", arm.map(Bound::as_any)),
        ] {
            options.set_item(name, value)?;
        }
        options.set_item("tool_linear_limits", tool_linear_limits)?;
        options.set_item("tool_angular_limits", tool_angular_limits)?;
        options.set_item("corner_tolerance", corner_tolerance)?;
        options.set_item("grid_points", grid_points)?;
        Ok(Trajectory {
            inner,
            joint_names: solution.joint_names.clone(),
            solution: slf.clone().unbind(),
            options: options.unbind(),
        })
    }

    /// One configuration for each point, shape (N, dof), in the order of traversal.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let width = self.joint_names.len();
        arrays::list(py, &self.q).reshape([self.q.len() / width.max(1), width])
    }

    /// True if all points are reached on one branch, and all steps are collision-free.
    #[getter]
    fn is_whole(&self) -> bool {
        self.jumps.is_empty() && self.missed.is_empty() && self.blocked.is_empty()
    }

    fn __repr__(&self) -> String {
        let rows = self.q.len() / self.joint_names.len().max(1);
        format!(
            "PathSolution({} of {rows} reached, {} reconfigurations, length {:.3})",
            rows - self.missed.len(),
            self.jumps.len(),
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

/// Largest speed and acceleration of the tool.
fn tool_limits(
    value: Option<&Bound<'_, PyAny>>,
    what: &str,
    units: &str,
) -> PyResult<Option<(f64, f64)>> {
    let pair = |value: &Bound<'_, PyAny>| {
        let shown = arrays::shown(value);
        let fault = |_| {
            invalid(format!(
                "{what} is {shown}: (speed, acceleration) in {units}"
            ))
        };
        value.extract::<(f64, f64)>().map_err(fault)
    };
    value.map(pair).transpose()
}

impl PathSolution {
    /// Returns one number for each joint, from a list or from one number for all.
    fn one_each(&self, value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f64>> {
        match value.extract::<f64>() {
            Ok(one) => Ok(vec![one; self.joint_names.len()]),
            Err(_) => arrays::copied(value, what),
        }
    }

    /// Joint limits, by default those of the arm.
    fn timing_limits(
        &self,
        acceleration_limits: Option<&Bound<'_, PyAny>>,
        velocity_limits: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<TimingLimits<'static>> {
        let limits = |value: Option<&Bound<'_, PyAny>>, what: &str, defaults: &[f64]| match value {
            None => Ok(defaults.to_vec()),
            Some(value) => self.one_each(value, what),
        };
        let [velocities, accelerations] = &self.rates;
        let velocities = limits(velocity_limits, "velocity_limits", velocities)?;
        let accelerations = limits(acceleration_limits, "acceleration_limits", accelerations)?;
        Ok(TimingLimits::new(&velocities, &accelerations).with_joint_names(&self.joint_names))
    }

    fn timed(&self, limits: &TimingLimits<'_>) -> Result<path::Trajectory, path::PathError> {
        let rests: Vec<usize> = self.jumps.iter().map(|step| step.index).collect();
        path::Trajectory::through(&self.q, self.joint_names.len(), &rests, limits)
    }
}

/// Solves a Cartesian path of an arm's tool with the fewest reconfigurations, then the shortest: a `PathSolution`.
///
/// `path` has one of three forms. Placements: shape (N, 4, 4) or a list of them. Points: shape (N, 7) (x, y, z, then a
/// quaternion w, x, y, z) or (N, 3). A table: the path of its file, whose header names the columns. `order`, "w-first"
/// or "w-last", is that of unnamed quaternion columns. Between two points the tool moves straight and rotates at a
/// constant rate. The arm defines the goal bounds and the obstacles.
///
/// `times`: seconds, shape (N,). With `keep_times`, a step that is too fast for a joint also counts as a
/// reconfiguration. `traversal`: "open", "cyclic" (repeatedly, ends in its first configuration) or "any-start" (once
/// around, from the best point). `start` and `end`: configurations of the first and last row. `joint_weights`: weight
/// of a radian or metre of each joint in lengths. `max_step`: largest joint displacement from point to point on one
/// branch, radians. `samples`: largest number of configurations for each point. `tools`: for `tool_of_points` (N,), or
/// the column `tool` of a table, which give the arm of each point: 0 is this one, 1 and so on are those of `tools`
/// (`arm.with_tool`).
///
/// Raises `InvalidValueError` with the point or option, and `FileError` or `InvalidFileError` for a file.
#[pyfunction]
#[pyo3(signature = (arm, path, *, times = None, keep_times = false, traversal = None, start = None, end = None, joint_weights = None,
    max_step = 0.2, samples = 256, tools = None, tool_of_points = None, order = None))]
#[expect(clippy::too_many_arguments, reason = "they are keywords")]
pub(crate) fn solve_path(
    py: Python<'_>,
    arm: &Bound<'_, Arm>,
    path: &Bound<'_, PyAny>,
    times: Option<&Bound<'_, PyAny>>,
    keep_times: bool,
    traversal: Option<&Bound<'_, PyAny>>,
    start: Option<&Bound<'_, PyAny>>,
    end: Option<&Bound<'_, PyAny>>,
    joint_weights: Option<&Bound<'_, PyAny>>,
    max_step: f64,
    samples: usize,
    tools: Option<Vec<Bound<'_, Arm>>>,
    tool_of_points: Option<Vec<usize>>,
    order: Option<&Bound<'_, PyAny>>,
) -> PyResult<PathSolution> {
    let (path, read_as) = read(path, order)?;
    let numbers = |value: Option<&Bound<'_, PyAny>>, what: &str| {
        value.map(|value| arrays::copied(value, what)).transpose()
    };
    let options = PathOptions {
        times: numbers(times, "times")?,
        keep_times,
        traversal: one_of(traversal, "traversal", TRAVERSALS)?,
        start: numbers(start, "start")?,
        end: numbers(end, "end")?,
        joint_weights: numbers(joint_weights, "joint_weights")?,
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
    Ok(path_solution(&inner_arm, solution.or_raise()?, read_as))
}

fn path_solution(
    arm: &kinopt::Arm,
    solution: kinopt::motion::path::PathSolution,
    read_as: Option<String>,
) -> PathSolution {
    let joint_names: Vec<String> = arm.joints().map(str::to_owned).collect();
    let missed = solution.missed.iter().map(|missed| MissedPoint {
        index: missed.index,
        position_error: missed.position_error,
        orientation_error: missed.orientation_error,
        reason: miss_reason(&missed.reason),
    });
    let blocked = solution.blocked.iter();
    let blocked = blocked.map(|blocked| (blocked.index, Collision::from(blocked.by.clone())));
    let deviation = solution.largest_deviation;
    PathSolution {
        jumps: JointJump::of_arm(arm, &solution.jumps),
        missed: missed.collect(),
        blocked: blocked.collect(),
        entry: solution.entry,
        length: solution.length,
        largest_deviation: deviation.metres,
        largest_deviation_at: deviation.metres_at,
        largest_turn: deviation.radians,
        largest_turn_at: deviation.radians_at,
        q: solution.q,
        joint_names,
        read_as,
        rates: [arm.velocity_limits(), arm.acceleration_limits()].map(<[f64]>::to_vec),
    }
}

/// Reads a path from placements, points or a file, with the interpretation of the file's columns.
fn read(
    path: &Bound<'_, PyAny>,
    order: Option<&Bound<'_, PyAny>>,
) -> PyResult<(CartesianPath, Option<String>)> {
    let orders = [
        ("w-first", QuaternionOrder::WFirst),
        ("w-last", QuaternionOrder::WLast),
    ];
    let order = one_of(order, "order", orders)?;
    if let Ok(file) = path.extract::<PathBuf>() {
        let (path, columns) = CartesianPath::read(file, order).or_raise()?;
        return Ok((path, Some(columns.to_string())));
    }
    let array = path.py().import("numpy")?.call_method1("asarray", (path,));
    let shape = array.and_then(|array| array.getattr("shape")?.extract::<Vec<usize>>());
    let points = match shape.as_deref() {
        Ok([_, 3 | 7]) => {
            let rows = arrays::convert::<f64>(path, "path")?;
            let rows = rows.extract::<Vec<Vec<f64>>>()?;
            let points = rows
                .iter()
                .enumerate()
                .map(|(row, numbers)| point(row, numbers, order));
            points.collect::<PyResult<Vec<_>>>()?
        }
        Ok(shape @ [_, _]) => {
            return Err(invalid(format!(
                "path has shape {}, expected (N, 4, 4), (N, 7) or (N, 3)",
                shape_text(shape)
            )));
        }
        _ => placements(path, "path")?.to_vec("point")?,
    };
    Ok((CartesianPath::new(points).or_raise()?, None))
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

fn point(row: usize, numbers: &[f64], order: QuaternionOrder) -> PyResult<Placement<f64>> {
    let &[x, y, z, a, b, c, d] = numbers else {
        let position = numbers.first_chunk().copied().unwrap_or([f64::NAN; 3]);
        return Ok(Placement::translation(Vector3::from(position)));
    };
    let (w, v) = match order {
        QuaternionOrder::WFirst => (a, Vector3::new(b, c, d)),
        QuaternionOrder::WLast => (d, Vector3::new(a, b, c)),
    };
    let length = (w * w + v.norm_squared()).sqrt();
    // Negated test: NaN fails it.
    let unit = (length - 1.0).abs() <= 1e-3;
    if !unit {
        return Err(invalid(format!(
            "point {row} of the path: its quaternion has length {length}, 1 is needed"
        )));
    }
    let unit = Quaternion {
        w: w / length,
        v: v * length.recip(),
    };
    Ok(Placement::new(unit.to_matrix(), Vector3::new(x, y, z)))
}
