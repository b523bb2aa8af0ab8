//! Trajectories, and the joint values between the rows of a path.

use kinopt::motion::path;
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arrays;
use crate::error::invalid;
use crate::pickling;

/// Configurations over time, with a report.
///
/// The report depends on the origin: `JointPath.trajectory` reports a `TimedSpline`, `MotionProblem.solve` a
/// `MotionReport`, `retarget` a `RetargetReport`.
///
/// `times`: shape (N,), seconds. `q`: shape (N, nq). Raises `InvalidValueError` for other shapes.
#[pyclass(frozen, generic, module = "kinopt")]
pub(crate) struct Trajectory {
    inner: kinopt::motion::Trajectory<()>,
    /// Names of the numbers of a configuration, the columns of `q`.
    #[pyo3(get)]
    names: Vec<String>,
    /// Errors or further data of the trajectory.
    #[pyo3(get)]
    report: Py<PyAny>,
}

impl Trajectory {
    /// Trajectory with a report in Python.
    pub(crate) fn of(
        inner: kinopt::motion::Trajectory<()>,
        names: Vec<String>,
        report: Py<PyAny>,
    ) -> Self {
        Self {
            inner,
            names,
            report,
        }
    }
}

#[pymethods]
impl Trajectory {
    #[new]
    fn new(
        times: &Bound<'_, PyAny>,
        q: &Bound<'_, PyAny>,
        names: Vec<String>,
        report: Py<PyAny>,
    ) -> PyResult<Self> {
        let nq = names.len();
        let q = arrays::rows(q, "q", nq)?;
        let times = arrays::vector_of(times, "times", q.shape()[0])?;
        let inner = kinopt::motion::Trajectory {
            times: times.to_vec(),
            q: q.to_vec(),
            nq,
            report: (),
        };
        Ok(Self {
            inner,
            names,
            report,
        })
    }

    /// Sample times, shape (N,), seconds, the first at 0.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.inner.times)
    }

    /// Configurations, shape (N, nq), radians and metres.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        arrays::list(py, &self.inner.q).reshape([self.inner.times.len(), self.inner.nq])
    }

    /// Time of the last sample, seconds.
    #[getter]
    fn duration(&self) -> f64 {
        self.inner.duration()
    }

    /// Joint state at one time, or at several, seconds: `TrajectoryPoint`. Times before the start or after the end count
    /// as these.
    ///
    /// Only a trajectory of a path has joint states between its rows; others raise `InvalidValueError`.
    fn at<'py>(&self, py: Python<'py>, time: &Bound<'py, PyAny>) -> PyResult<TrajectoryPoint> {
        match self.report.bind(py).cast::<TimedSpline>() {
            Ok(spline) => spline.get().at(py, time),
            Err(_) => Err(invalid(
                "only a trajectory of a path has joint states between its rows; interpolate `q` over `times`",
            )),
        }
    }

    fn __len__(&self) -> usize {
        self.inner.times.len()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let (rows, seconds) = (self.inner.times.len(), self.inner.duration());
        let report = self.report.bind(py).repr()?;
        Ok(format!("Trajectory({rows} rows, {seconds:.3} s, {report})"))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, trajectory) = (slf.py(), slf.get());
        let arguments = (
            trajectory.times(py),
            trajectory.q(py)?,
            &trajectory.names,
            trajectory.report.clone_ref(py),
        );
        pickling::by_class::<Self>(py, arguments)
    }
}

/// Joint values over time between the rows of a path: cubic splines, from rest to rest.
#[pyclass(frozen, module = "kinopt")]
#[derive(Serialize, Deserialize)]
pub(crate) struct TimedSpline {
    inner: path::TimedSpline,
    width: usize,
}

impl TimedSpline {
    pub(crate) fn new(inner: path::TimedSpline, width: usize) -> Self {
        Self { inner, width }
    }
}

/// Joint state at one time of a trajectory, or at several.
#[pyclass(frozen, get_all, module = "kinopt")]
pub(crate) struct TrajectoryPoint {
    /// Joint values, radians or metres, shape (dof,) at one time and (T, dof) at several.
    q: Py<PyArrayDyn<f64>>,
    /// Joint velocities, rad/s or m/s; shape of `q`.
    velocity: Py<PyArrayDyn<f64>>,
    /// Joint accelerations, rad/s² or m/s²; shape of `q`.
    acceleration: Py<PyArrayDyn<f64>>,
}

#[pymethods]
impl TimedSpline {
    /// Joint values, velocities and accelerations at a time in seconds, or at several of shape (T,). Before the start
    /// and after the end the arm is at rest.
    ///
    /// Raises `InvalidValueError` if `time` holds no numbers.
    fn at<'py>(&self, py: Python<'py>, time: &Bound<'py, PyAny>) -> PyResult<TrajectoryPoint> {
        let times = arrays::Queries::numbers(time, "time")?;
        let width = self.width;
        let mut rows: [Vec<f64>; 3] = Default::default();
        let mut point = path::TrajectoryPoint::default();
        for time in times.all() {
            self.inner
                .write_at(arrays::finite(*time, "time")?, &mut point);
            for (rows, row) in rows
                .iter_mut()
                .zip([&point.q, &point.velocity, &point.acceleration])
            {
                rows.extend(row);
            }
        }
        let shape = times.shape(&[width]);
        let array = |rows: &[f64]| {
            let array = arrays::list(py, rows).reshape(shape.clone())?;
            PyResult::Ok(array.unbind())
        };
        let [q, velocity, acceleration] = &rows;
        Ok(TrajectoryPoint {
            q: array(q)?,
            velocity: array(velocity)?,
            acceleration: array(acceleration)?,
        })
    }

    fn __repr__(&self) -> String {
        format!("TimedSpline({} stretches)", self.inner.stretch_count())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_json::<Self>(py, self)
    }

    #[staticmethod]
    fn _rebuild(json: &str) -> PyResult<Self> {
        pickling::of_json(json)
    }
}

#[pymethods]
impl TrajectoryPoint {
    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("TrajectoryPoint(q={})", self.q.bind(py).repr()?))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, point) = (slf.py(), slf.get());
        let parts = [&point.q, &point.velocity, &point.acceleration];
        let [q, velocity, acceleration] = parts.map(|part| part.clone_ref(py));
        crate::pickling::by_rebuild::<Self>(py, (q, velocity, acceleration))
    }

    #[staticmethod]
    fn _rebuild(
        q: Py<PyArrayDyn<f64>>,
        velocity: Py<PyArrayDyn<f64>>,
        acceleration: Py<PyArrayDyn<f64>>,
    ) -> Self {
        Self {
            q,
            velocity,
            acceleration,
        }
    }
}
