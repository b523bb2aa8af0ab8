//! Trajectories along joint paths.

use kinopt::motion::path;
use numpy::{PyArray1, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays;
use crate::joint_path::JointPath;

/// Configurations over time, along the rows of a path.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Trajectory {
    pub(crate) inner: path::Trajectory,
    /// Names of the joints, the columns of `q`.
    #[pyo3(get)]
    pub(crate) joint_names: Vec<String>,
    pub(crate) solution: Py<JointPath>,
    pub(crate) options: Py<PyDict>,
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
impl Trajectory {
    /// Time of each row of the path, shape (N,), seconds, the first at 0.
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, self.inner.times())
    }

    /// Time of the last row, seconds.
    #[getter]
    fn duration(&self) -> f64 {
        self.inner.duration()
    }

    /// Joint values, velocities and accelerations at a time in seconds, or at several of shape (T,). Before the start
    /// and after the end the arm is at rest.
    ///
    /// Raises `InvalidValueError` if `time` holds no numbers.
    fn at<'py>(&self, py: Python<'py>, time: &Bound<'py, PyAny>) -> PyResult<TrajectoryPoint> {
        let times = arrays::Queries::numbers(time, "time")?;
        let width = self.joint_names.len();
        let mut rows: [Vec<f64>; 3] = Default::default();
        let mut point = path::TrajectoryPoint::default();
        for time in times.all() {
            self.inner.write_at(*time, &mut point);
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
        let rows = self.inner.times().len();
        format!("Trajectory({rows} rows, {:.3} s)", self.inner.duration())
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, trajectory) = (slf.py(), slf.get());
        let method = py.get_type::<JointPath>().getattr("trajectory")?;
        let partial = py.import("functools")?.getattr("partial")?;
        let constructor = partial.call((method,), Some(trajectory.options.bind(py)))?;
        let arguments = (trajectory.solution.clone_ref(py),);
        Ok((constructor, arguments).into_pyobject(py)?.into_any())
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
