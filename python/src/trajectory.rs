//! Trajectories with their files, and the joint values between the rows of a path.

use std::path::PathBuf;

use kinopt::model::UnknownName;
use kinopt::motion::path;
use kinopt_bindings::motion_file::write_robot_glb;
use kinopt_bindings::trajectory_file::{Contacts, TableLayout, TrajectoryFormat, TrajectoryTable};
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods};
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::arrays;
use crate::coordinates::Coordinates;
use crate::error::{OrRaise, invalid};
use crate::in_python;
use crate::pickling;
use crate::retargeting::{figure_target, target_of};

/// Configurations over time, with a report.
///
/// The report depends on the origin: `JointPath.trajectory` reports a `TimedSpline`, `MotionProblem.solve` a
/// `MotionReport`, `retarget` a `RetargetReport`.
///
/// `times`: shape (N,), seconds. `q`: shape (N, nq). `names`: of the numbers of a configuration. `model`: the arm, robot,
/// model or figure of the configurations, for limits, files and plots. Raises `InvalidValueError` for other shapes.
#[pyclass(frozen, generic, module = "kinopt")]
pub(crate) struct Trajectory {
    inner: kinopt::motion::Trajectory<()>,
    /// Names, limits and units of the columns of `q`.
    #[pyo3(get)]
    coordinates: Py<Coordinates>,
    /// The arm, robot, model or figure of the configurations; None if unknown.
    #[pyo3(get)]
    model: Option<Py<PyAny>>,
    /// Errors or further data of the trajectory.
    #[pyo3(get)]
    report: Py<PyAny>,
}

impl Trajectory {
    /// Trajectory with a report in Python.
    pub(crate) fn of(
        inner: kinopt::motion::Trajectory<()>,
        coordinates: Py<Coordinates>,
        report: Py<PyAny>,
        model: Option<Py<PyAny>>,
    ) -> Self {
        Self {
            inner,
            coordinates,
            model,
            report,
        }
    }
}

/// Names, limits and units of the configurations of an arm, a robot, a model or a figure.
fn coordinates_of(model: &Bound<'_, PyAny>) -> PyResult<Coordinates> {
    if let Some(coordinates) = model.getattr_opt("coordinates")? {
        return Ok(coordinates.cast::<Coordinates>()?.get().clone());
    }
    Ok(Coordinates::of_model(target_of(model)?.model()))
}

/// Frame rate and contacts of a `RetargetReport`; `None` for other reports.
fn contacts_of(report: &Bound<'_, PyAny>) -> PyResult<Option<Contacts>> {
    let Some(frames) = report.getattr_opt("contact_frames")? else {
        return Ok(None);
    };
    let flags: Vec<Vec<bool>> = report
        .getattr("contacts")?
        .call_method0("tolist")?
        .extract()?;
    let points = report.getattr("contact_points")?.call_method0("tolist")?;
    Ok(Some(Contacts {
        frame_rate: report.getattr("fps")?.extract()?,
        frames: frames.extract()?,
        points: points.extract()?,
        flags: flags.concat(),
    }))
}

#[pymethods]
impl Trajectory {
    #[new]
    #[pyo3(signature = (times, q, names, report, model = None))]
    fn new(
        times: &Bound<'_, PyAny>,
        q: &Bound<'_, PyAny>,
        names: Vec<String>,
        report: Py<PyAny>,
        model: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = times.py();
        let nq = names.len();
        let q = arrays::rows(q, "q", nq)?;
        let times = arrays::vector_of(times, "times", q.shape()[0])?;
        let inner = kinopt::motion::Trajectory {
            times: times.to_vec(),
            q: q.to_vec(),
            nq,
            report: (),
        };
        let coordinates = match model {
            Some(model) => coordinates_of(model)?,
            None => Coordinates::named(names.clone()),
        };
        if coordinates.names != names {
            let mut pairs = names.iter().zip(&coordinates.names);
            return Err(invalid(match pairs.find(|(given, own)| given != own) {
                Some((given, own)) => {
                    format!("names has `{given}` in place of the model's `{own}`")
                }
                None => format!(
                    "names has {nq} names, the model {}",
                    coordinates.names.len()
                ),
            }));
        }
        Ok(Self {
            inner,
            coordinates: Py::new(py, coordinates)?,
            model: model.map(|model| model.clone().unbind()),
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

    /// Names of the numbers of a configuration, the columns of `q`.
    #[getter]
    fn names(&self) -> Vec<String> {
        self.coordinates.get().names.clone()
    }

    /// Time of the last sample, seconds.
    #[getter]
    fn duration(&self) -> f64 {
        self.inner.duration()
    }

    /// Joint state at one time, or at several of shape (T,), seconds: `TrajectoryPoint`. Times before the start or after
    /// the end count as these.
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

    /// Writes a .npz, .json, .csv, .bvh or .glb file, as the command does. The file appears once it is complete.
    ///
    /// A .npz and a .json have `q` and `names`, and `times` in seconds or, of a retargeted motion, `fps`, `contacts`,
    /// `contact_frames` and `contact_points`. A .csv has a row for each sample: time, configuration, and contacts (1 in
    /// contact). Without `header` its rows are bare configurations, whose free base has the quaternion x, y, z, w: the
    /// `layout` "lafan1" of Unitree. With "mujoco" it is w, x, y, z, and a .npz has `qpos` instead of `q`.
    ///
    /// .bvh needs a motion retargeted to a rig, skeleton, scene or motion capture. A .glb of a `SceneFile` keeps all
    /// content of the file; of a `Scene` it has no materials. A .glb of a retargeted robot has a node for each link.
    /// `clip` names its clip.
    ///
    /// Raises `InvalidValueError` for another extension, and for bones that the model does not have. Raises `FileError`
    /// if the file cannot be written.
    #[pyo3(signature = (path, *, header = true, clip = "retargeted", layout = "lafan1"))]
    fn save(
        &self,
        py: Python<'_>,
        path: PathBuf,
        header: bool,
        clip: &str,
        layout: &str,
    ) -> PyResult<()> {
        let known = TableLayout::ALL.iter().find(|(name, _)| *name == layout);
        let unknown = || UnknownName::new("layout", layout, TableLayout::ALL.map(|(name, _)| name));
        let layout = known
            .map(|(_, layout)| *layout)
            .ok_or_else(unknown)
            .or_raise()?;
        let format = TrajectoryFormat::of(&path).ok_or_else(|| {
            invalid(format!(
                "{}: unsupported extension; expected .npz, .json, .csv, .bvh or .glb",
                path.display()
            ))
        })?;
        let contacts = contacts_of(self.report.bind(py))?;
        let model = self.model.as_ref().map(|model| model.bind(py));
        if let (true, Some(contacts), Some(model)) = (format.has_bones(), &contacts, model) {
            let motion = (&*self.inner.q, contacts.frame_rate);
            if figure_target::write(model, motion, clip, (format, &path))? {
                return Ok(());
            }
        }
        let robot = model.filter(|_| contacts.is_some()).map(target_of);
        let robot = robot.transpose()?;
        if let (TrajectoryFormat::Glb, Some(robot), Some(contacts)) = (format, &robot, &contacts) {
            let motion = (&*self.inner.q, contacts.frame_rate);
            return py
                .detach(|| write_robot_glb(robot, motion, clip, &path))
                .or_raise();
        }
        let is_free = robot.is_some_and(|robot| {
            let root = robot.free_root();
            root.is_some_and(|joint| robot.model().coordinate(joint) == Some(0))
        });
        let table = TrajectoryTable {
            names: &self.coordinates.get().names,
            times: &self.inner.times,
            q: &self.inner.q,
            contacts: contacts.as_ref(),
            is_free,
            layout,
        };
        let header = header || contacts.is_none();
        py.detach(|| table.write(format, header, &path)).or_raise()
    }

    /// Table with one row for each sample: `time` in seconds, a column for each number of a configuration and, of a
    /// retargeted motion, "FRAME in contact". A pandas `DataFrame`.
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

    /// Draws the joints over time with their limits: a matplotlib `Figure`. Of an arm it also has the path of the tool,
    /// of a body with masses the centre of mass over its support polygon.
    ///
    /// `joints`: names of the numbers of a configuration to draw, by default all but those of the base. `support`:
    /// points on the ground that span the support polygon, shape (K, 3), metres; by default the contacts of a
    /// retargeted motion. `figure`: a `Figure` or `SubFigure` to draw into, by default a new one. Raises
    /// `UnknownNameError` for a joint, and `ImportError` without matplotlib, which the extra `plot` installs.
    #[pyo3(signature = (*, joints = None, support = None, figure = None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        joints: Option<&Bound<'py, PyAny>>,
        support: Option<&Bound<'py, PyAny>>,
        figure: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let keywords = [("joints", joints), ("support", support), ("figure", figure)];
        in_python::call("plot_trajectory", "kinopt.plots", slf, &keywords)
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python::call("trajectory_page", "kinopt.plots.html", slf, &[])
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
            trajectory.names(),
            trajectory.report.clone_ref(py),
            trajectory.model.as_ref().map(|model| model.clone_ref(py)),
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
