//! Joint paths of arms, and their times.

use std::sync::Arc;

use kinopt::motion::path::TimingLimits;
use kinopt_bindings::per_joint::per_joint;
use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

use crate::arm::Arm;
use crate::arrays;
use crate::coordinates::Coordinates;
use crate::error::{OrRaise, invalid};
use crate::in_python;
use crate::joint_jump::JointJump;
use crate::object::Object;
use crate::pickling;
use crate::trajectory::{TimedSpline, Trajectory};

/// Joint path of an arm: one configuration a row, with its jumps and a report. `arm.track` reports the `Solutions` of
/// the rows, `solve_path` a `PathReport`.
#[pyclass(frozen, generic, module = "kinopt")]
pub(crate) struct JointPath {
    inner: kinopt::arm::JointPath<()>,
    /// The arm of the path.
    #[pyo3(get)]
    arm: Py<Arm>,
    /// True if all rows are reached without jumps, and all steps are collision-free.
    #[pyo3(get)]
    reached: bool,
    /// Errors of the path: `Solutions` or a `PathReport`.
    #[pyo3(get)]
    report: Py<PyAny>,
}

impl JointPath {
    /// Path of an arm with a report in Python.
    pub(crate) fn new(
        arm: &Bound<'_, Arm>,
        inner: kinopt::arm::JointPath<()>,
        reached: bool,
        report: Py<PyAny>,
    ) -> Self {
        let arm = arm.clone().unbind();
        Self {
            inner,
            arm,
            reached,
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
    /// acceleration of the tool, in metres or radians and seconds. `arm`: the arm of this tool, by default that of the
    /// path. `corner_tolerance`: largest distance of a joint from the path at a blended corner, radians or metres; with
    /// 0 the arm stops at corners. `grid_points`: number of samples of the speed profile over the whole path.
    /// `allow_unreached`: times a path with `unreached` rows too, which is an error by default.
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
        let arm = arm.map_or_else(|| self.arm.get(), Bound::get);
        let arm_inner = Arc::clone(&arm.inner);
        let mut limits = self.timing_limits(acceleration_limits, velocity_limits)?;
        if let Some(jerks) = jerk_limits {
            limits = limits.with_jerk_limits(&self.one_each(jerks, "jerk_limits")?);
        }
        let tool_linear_limits =
            tool_limits(tool_linear_limits, "tool_linear_limits", "m/s and m/s²")?;
        let tool_angular_limits = tool_limits(
            tool_angular_limits,
            "tool_angular_limits",
            "rad/s and rad/s²",
        )?;
        if tool_linear_limits.is_some() || tool_angular_limits.is_some() {
            limits = limits.with_arm(&arm_inner);
        }
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
        let coordinates = self.coordinates(py);
        let model = self.arm.clone_ref(py).into_any();
        Ok(Trajectory::of(trajectory, coordinates, report, Some(model)))
    }

    /// One configuration for each point or target, shape (N, dof), radians or metres.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::list(py, &self.inner.q).reshape([self.inner.rows().len(), self.inner.nq])
    }

    /// Steps in which a joint moves farther than its bound, in order. `solve_path` lists reconfigurations only.
    #[getter]
    fn jumps(&self) -> Vec<JointJump> {
        JointJump::of_arm(&self.arm.get().inner, &self.inner.jumps)
    }

    /// Names of the joints, the columns of `q`.
    #[getter]
    fn joint_names(&self) -> Vec<&str> {
        self.arm.get().inner.joints().collect()
    }

    /// Names, limits and units of the columns of `q`.
    #[getter]
    fn coordinates(&self, py: Python<'_>) -> Py<Coordinates> {
        self.arm.get().coordinates.clone_ref(py)
    }

    /// Table with one row for each point and one column for each joint: a pandas `DataFrame`.
    ///
    /// Raises `ImportError` without pandas, which the extra `tables` installs.
    fn to_frame<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python::call("to_frame", "kinopt.tables", slf, &[])
    }

    /// Table as of `to_frame`: a pyarrow `Table`.
    ///
    /// Raises `ImportError` without pyarrow, which the extra `tables` installs.
    fn to_arrow<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python::call("to_arrow", "kinopt.tables", slf, &[])
    }

    /// Draws the joints by row with their limits and jumps, and the path of the tool: a matplotlib `Figure`.
    ///
    /// `joints`: names of the joints to draw, by default all. `figure`: a `Figure` or `SubFigure` to draw into, by
    /// default a new one. Raises `UnknownNameError` for a joint, and `ImportError` without matplotlib, which the extra
    /// `plot` installs.
    #[pyo3(signature = (*, joints = None, figure = None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        joints: Option<&Bound<'py, PyAny>>,
        figure: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let keywords = [("joints", joints), ("figure", figure)];
        in_python::call("plot_path", "kinopt.plots", slf, &keywords)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python::call("path_page", "kinopt.plots.html", slf, &[])
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
        let json = serde_json::to_string(&self.inner).or_raise()?;
        let (arm, report) = (self.arm.clone_ref(py), self.report.clone_ref(py));
        pickling::by_rebuild::<Self>(py, (arm, json, self.reached, report))
    }

    #[staticmethod]
    fn _rebuild(arm: Py<Arm>, json: &str, reached: bool, report: Py<PyAny>) -> PyResult<Self> {
        Ok(Self {
            inner: pickling::of_json(json)?,
            arm,
            reached,
            report,
        })
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
        let names: Vec<String> = self.arm.get().inner.joints().map(str::to_owned).collect();
        per_joint(&Object::of(value), what, &names, None)
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
        let arm = &self.arm.get().inner;
        let velocities = limits(velocity_limits, "velocity_limits", arm.velocity_limits())?;
        let accelerations = limits(
            acceleration_limits,
            "acceleration_limits",
            arm.acceleration_limits(),
        )?;
        let names: Vec<String> = arm.joints().map(str::to_owned).collect();
        Ok(TimingLimits::new(&velocities, &accelerations).with_joint_names(&names))
    }
}
