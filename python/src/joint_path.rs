//! Joint paths of arms, and their times.

use std::sync::Arc;

use kinopt::arm::JointJump as InnerJump;
use kinopt::motion::path::TimingLimits;
use kinopt_bindings::per_joint::per_joint;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arm::Arm;
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::joint_jump::JointJump;
use crate::object::Object;
use crate::pickling;
use crate::trajectory::{TimedSpline, Trajectory};

/// Joint path of an arm: one configuration a row, with its jumps and a report. `arm.track` reports the `Solutions` of
/// the rows, `solve_path` a `PathReport`.
#[pyclass(frozen, generic, module = "kinopt")]
#[derive(Serialize, Deserialize)]
pub(crate) struct JointPath {
    inner: kinopt::arm::JointPath<()>,
    /// Names of the joints, the columns of `q`.
    #[pyo3(get)]
    joint_names: Vec<String>,
    /// True if all rows are reached without jumps, and all steps are collision-free.
    #[pyo3(get)]
    reached: bool,
    /// Velocity and acceleration limits of the arm, rad/s or m/s, and rad/s² or m/s².
    #[serde(with = "pickling::limits")]
    rates: [Vec<f64>; 2],
    /// Errors of the path: `Solutions` or a `PathReport`.
    #[pyo3(get)]
    #[serde(skip, default = "none")]
    report: Py<PyAny>,
}

/// Report of a path that is being unpickled.
fn none() -> Py<PyAny> {
    Python::attach(|py| py.None())
}

impl JointPath {
    /// Path of an arm with a report in Python.
    pub(crate) fn new(
        arm: &kinopt::Arm,
        inner: kinopt::arm::JointPath<()>,
        reached: bool,
        report: Py<PyAny>,
    ) -> Self {
        Self {
            inner,
            joint_names: arm.joints().map(str::to_owned).collect(),
            reached,
            rates: [arm.velocity_limits(), arm.acceleration_limits()].map(<[f64]>::to_vec),
            report,
        }
    }
}

#[pymethods]
impl JointPath {
    /// Time of each row, shape (N,), seconds, starting at 0: time-optimal under joint acceleration and velocity limits,
    /// shape (dof,) or one number for all joints. Default: the limits of the arm; accelerations come from
    /// `Robot.with_joint_limits`. The arm is at rest before and after a reconfiguration. Equal to
    /// `trajectory(acceleration_limits, velocity_limits).times`.
    ///
    /// Raises `InvalidValueError` for limits that are not above 0, if no moving joint has a finite acceleration limit,
    /// and for `unreached` rows unless `allow_unreached` is True.
    #[pyo3(signature = (*, acceleration_limits = None, velocity_limits = None, allow_unreached = false))]
    fn times<'py>(
        &self,
        py: Python<'py>,
        acceleration_limits: Option<&Bound<'py, PyAny>>,
        velocity_limits: Option<&Bound<'py, PyAny>>,
        allow_unreached: bool,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let limits = self.timing_limits(acceleration_limits, velocity_limits)?;
        let limits = limits.with_unreached_allowed(allow_unreached);
        let solved = py.detach(|| self.inner.trajectory(&limits)).or_raise()?;
        Ok(PyArray1::from_slice(py, &solved.times))
    }

    /// Time-optimal `Trajectory` along the rows, from rest to rest, with a `TimedSpline` as report. Joint limits have
    /// shape (dof,), or are one number for all joints.
    ///
    /// `acceleration_limits` and `velocity_limits`: as for `times`. `jerk_limits`: largest rates of change of
    /// accelerations, unbounded by default. `tool_linear_limits` and `tool_angular_limits`: largest speed and
    /// acceleration of the tool, in metres or radians and seconds; they require `arm`. `corner_tolerance`: largest
    /// distance of a joint from the path at a blended corner, radians or metres; with 0 the arm stops at corners.
    /// `grid_points`: number of samples of the speed profile over the whole path. `allow_unreached`: times a path with
    /// `unreached` rows too, which is an error by default.
    ///
    /// Joints follow a cubic spline within 1e-5 (radians or metres) of every row. Raises `InvalidValueError` with the
    /// option and joint.
    #[pyo3(signature = (*, acceleration_limits = None, velocity_limits = None, jerk_limits = None, arm = None,
        tool_linear_limits = None, tool_angular_limits = None, corner_tolerance = 1e-3, grid_points = 1000,
        allow_unreached = false))]
    #[expect(clippy::too_many_arguments, reason = "they are keywords")]
    fn trajectory(
        &self,
        py: Python<'_>,
        acceleration_limits: Option<&Bound<'_, PyAny>>,
        velocity_limits: Option<&Bound<'_, PyAny>>,
        jerk_limits: Option<&Bound<'_, PyAny>>,
        arm: Option<&Bound<'_, Arm>>,
        tool_linear_limits: Option<&Bound<'_, PyAny>>,
        tool_angular_limits: Option<&Bound<'_, PyAny>>,
        corner_tolerance: f64,
        grid_points: usize,
        allow_unreached: bool,
    ) -> PyResult<Trajectory> {
        let arm_inner = arm.map(|arm| Arc::clone(&arm.get().inner));
        let mut limits = self.timing_limits(acceleration_limits, velocity_limits)?;
        if let Some(jerks) = jerk_limits {
            limits = limits.with_jerk_limits(&self.one_each(jerks, "jerk_limits")?);
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
            .with_grid_points(grid_points)
            .with_unreached_allowed(allow_unreached);
        let trajectory = py.detach(|| self.inner.trajectory(&limits)).or_raise()?;
        let (trajectory, spline) = trajectory.split_report();
        let report = Py::new(py, TimedSpline::new(spline, self.inner.nq))?.into_any();
        Ok(Trajectory::of(trajectory, self.joint_names.clone(), report))
    }

    /// One configuration for each point or target, shape (N, dof), radians or metres.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::list(py, &self.inner.q).reshape([self.inner.rows().len(), self.inner.nq])
    }

    /// Steps in which a joint moves farther than its bound, in order. `solve_path` lists reconfigurations only.
    #[getter]
    fn jumps(&self) -> Vec<JointJump> {
        let name = |jump: &InnerJump| JointJump::new(jump, &self.joint_names[jump.joint]);
        self.inner.jumps.iter().map(name).collect()
    }

    /// Rows that are not reached, or whose step is not proven collision-free, in order. The report has the reasons.
    #[getter]
    fn unreached(&self) -> Vec<usize> {
        self.inner.unreached.clone()
    }

    fn __len__(&self) -> usize {
        self.inner.rows().len()
    }

    fn __repr__(&self) -> String {
        let (rows, jumps) = (self.inner.rows().len(), self.inner.jumps.len());
        let reached = if self.reached {
            "reached"
        } else {
            "not reached"
        };
        format!("JointPath({rows} rows, {reached}, {jumps} jumps)")
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let json = serde_json::to_string(self).or_raise()?;
        pickling::by_rebuild::<Self>(py, (json, self.report.clone_ref(py)))
    }

    #[staticmethod]
    fn _rebuild(json: &str, report: Py<PyAny>) -> PyResult<Self> {
        let path = pickling::of_json(json)?;
        Ok(Self { report, ..path })
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

impl JointPath {
    /// Returns one number for each joint, from a list, from one number for all, or from a dict by joint name.
    fn one_each(&self, value: &Bound<'_, PyAny>, what: &str) -> PyResult<Vec<f64>> {
        per_joint(&Object::of(value), what, &self.joint_names, None)
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
}
