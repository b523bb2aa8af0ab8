//! Trajectory optimisation: all samples of a motion in one problem.

mod by_frame;
mod report;

use std::sync::Arc;

use kinopt::model::FrameId;
use kinopt::motion::trajectory::{self, Contact, MotionSolver, RateCost, Windows};
use kinopt::spatial::Vector3;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use self::by_frame::{ByFrame, of_tasks};
pub(crate) use self::report::{ActiveMotionLimit, MissedFrame, MotionReport};
use crate::arrays;
use crate::coordinates::Coordinates;
use crate::error::{OrRaise, invalid};
use crate::has_model::model_of;
use crate::pickling;
use crate::problem::{self, CompiledProblem, ParameterMap, limits_of, raised};
use crate::robot::Robot;
use crate::trajectory::Trajectory;

/// All samples of a trajectory of one model as one bounded least-squares problem.
///
/// `frames` samples are `time_step` seconds apart. `tasks` are those of `kinopt.tasks` in every sample; `parameters`,
/// `bounds` and `tolerance` are as in `Problem`. `targets` sets the targets of tasks by sample: {"task": one target for
/// each sample}, by the tasks' names or indices. `weights` are factors of their rows: {"task": (frames,)}; 0 disables
/// the task.
///
/// `velocity`, `acceleration` and `jerk` are costs of these rates, per rad/s or m/s and so on: a weight, or (weight,
/// {"joint": factor}). `max_speeds` are hard limits between successive samples, {"joint": rad/s or m/s}; by default
/// those of a robot's file, {} for none. For a ball it limits the rotation angle; a free joint has (m/s, rad/s), for
/// its translation and its rotation. `contacts` are `kinopt.Contact`s: frames locked in place over a span. `first` and
/// `last` fix the configurations of these samples. Closed loops of the model and cones of its balls hold in every
/// sample.
///
/// Raises `UnknownNameError` for unknown names, and `InvalidValueError`, with the name, for values out of range.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct MotionProblem {
    inner: Arc<trajectory::MotionProblem>,
    arguments: (Py<PyAny>, usize, f64, Py<PyList>),
    options: Py<PyDict>,
}

#[pymethods]
impl MotionProblem {
    #[new]
    #[pyo3(signature = (
        model, frames, time_step, tasks, *, targets = None, velocity = None, acceleration = None, jerk = None,
        contacts = None, first = None, last = None, bounds = None, max_speeds = None, tolerance = None, weights = None,
        parameters = None
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        model: &Bound<'_, PyAny>,
        frames: usize,
        time_step: f64,
        tasks: &Bound<'_, PyAny>,
        targets: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        acceleration: Option<&Bound<'_, PyAny>>,
        jerk: Option<&Bound<'_, PyAny>>,
        contacts: Option<&Bound<'_, PyAny>>,
        first: Option<&Bound<'_, PyAny>>,
        last: Option<&Bound<'_, PyAny>>,
        bounds: Option<&Bound<'_, PyAny>>,
        max_speeds: Option<&Bound<'_, PyAny>>,
        tolerance: Option<&Bound<'_, PyAny>>,
        weights: Option<&Bound<'_, PyAny>>,
        parameters: Option<&Bound<'_, ParameterMap>>,
    ) -> PyResult<Self> {
        let py = model.py();
        let tasks = tasks.try_iter();
        let tasks = tasks.map_err(|_| invalid("tasks must be a list of tasks"))?;
        let tasks = PyTuple::new(py, tasks.collect::<PyResult<Vec<_>>>()?)?;
        let keywords = [
            ("parameters", parameters.map(Bound::as_any)),
            ("bounds", bounds),
            ("tolerance", tolerance),
            ("targets", targets),
            ("weights", weights),
            ("velocity", velocity),
            ("acceleration", acceleration),
            ("jerk", jerk),
            ("max_speeds", max_speeds),
            ("contacts", contacts),
            ("first", first),
            ("last", last),
        ];
        let options = pickling::kept(py, &keywords)?;
        let inner = build(model, frames, time_step, &tasks, &options)?;
        Ok(Self {
            inner: Arc::new(inner),
            arguments: (
                model.clone().unbind(),
                frames,
                time_step,
                tasks.to_list().unbind(),
            ),
            options: options.unbind(),
        })
    }

    /// Number of samples.
    #[getter]
    fn frames(&self) -> usize {
        self.inner.frames()
    }

    /// Time between two samples, in seconds.
    #[getter]
    fn time_step(&self) -> f64 {
        self.inner.time_step_s()
    }

    /// Names of the tasks.
    #[getter]
    fn task_names(&self) -> Vec<String> {
        let problem = self.inner.problem();
        let names = (0..problem.tasks()).filter_map(|task| problem.task_name(task));
        names.map(str::to_owned).collect()
    }

    /// Solves the trajectory from one configuration, shape (nq,), or from an initial trajectory, shape (frames, nq).
    /// From one configuration the samples are first solved one by one. An initial trajectory need not satisfy limits.
    ///
    /// `tolerance` is the smallest relative decrease of the cost that a step must predict. `slip` is the largest drift
    /// of a contact between samples, metres. `curvature` selects the exact curvature of the samples, or JᵀJ, which is
    /// less accurate far from targets and cheaper. `windows` = (frames, ahead) solves a long trajectory window by
    /// window. The GIL is released.
    ///
    /// Raises `InvalidValueError` for starts that are not finite, options out of range, and fixed samples that conflict
    /// with speed limits.
    #[pyo3(signature = (start, *, tolerance = None, max_iterations = None, slip = None, curvature = true, windows = None))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn solve(
        &self,
        py: Python<'_>,
        start: &Bound<'_, PyAny>,
        tolerance: Option<f64>,
        max_iterations: Option<usize>,
        slip: Option<f64>,
        curvature: bool,
        windows: Option<(usize, usize)>,
    ) -> PyResult<Trajectory> {
        let mut solver = MotionSolver::default().with_curvature(curvature);
        if let Some(tolerance) = tolerance {
            solver = solver.with_tolerance(tolerance);
        }
        if let Some(iterations) = max_iterations {
            solver = solver.with_max_iterations(iterations);
        }
        if let Some(slip) = slip {
            solver = solver.with_slip(slip);
        }
        if let Some((frames, ahead)) = windows {
            solver = solver.with_windows(Some(Windows::new(frames, ahead)));
        }
        let width = self.inner.configuration_len();
        let one = arrays::axes(start)? == 1;
        let start = match one {
            true => arrays::vector_of(start, "start", width)?.to_vec(),
            false => arrays::rows(start, "start", width)?.to_vec(),
        };
        let solved = py.detach(|| {
            let solved = match one {
                true => solver.solve(&self.inner, &start),
                false => solver.solve_near(&self.inner, &start),
            };
            raised().map(|()| solved)
        })?;
        let solved = solved.or_raise()?;
        let (solved, report) = solved.split_report();
        let report = MotionReport::new(&report, solved.times.len());
        let report = Py::new(py, report)?.into_any();
        let model = self.arguments.0.bind(py);
        let coordinates = Coordinates::of_model(&*model_of(model)?);
        let coordinates = Py::new(py, coordinates)?;
        let model = Some(model.clone().unbind());
        Ok(Trajectory::of(solved, coordinates, report, model))
    }

    fn __repr__(&self) -> String {
        let (frames, step) = (self.frames(), self.time_step());
        format!(
            "MotionProblem({frames} frames, {step} s apart, {} tasks)",
            self.inner.problem().tasks()
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, problem) = (slf.py(), slf.get());
        let (model, frames, time_step, tasks) = &problem.arguments;
        let arguments = (model, *frames, *time_step, tasks).into_pyobject(py)?;
        pickling::by_keywords::<Self>(py, &arguments, problem.options.bind(py))
    }
}

fn build(
    python_model: &Bound<'_, PyAny>,
    frames: usize,
    time_step: f64,
    tasks: &Bound<'_, PyTuple>,
    options: &Bound<'_, PyDict>,
) -> PyResult<trajectory::MotionProblem> {
    let py = python_model.py();
    let inner_model = model_of(python_model)?;
    // Compiles the problem of one sample first, which validates names, tasks and options.
    let of_frame = PyDict::new(py);
    for name in ["parameters", "bounds", "tolerance"] {
        if let Some(value) = options.get_item(name)? {
            of_frame.set_item(name, value)?;
        }
    }
    of_frame.set_item("derivatives", "analytic")?;
    of_frame.set_item("preferences", "traded")?;
    let compiled = CompiledProblem::new(python_model, tasks, &of_frame, None)?.map_err(invalid)?;
    let mut builder = trajectory::MotionProblem::builder(&inner_model, frames, time_step);
    let map = options.get_item("parameters")?;
    let robot = python_model.cast::<Robot>().ok();
    match (map, robot) {
        (Some(map), _) => drop(builder.parameters(map.cast::<ParameterMap>()?.get().inner.clone())),
        (None, Some(robot)) => drop(builder.parameters(robot.get().inner.map().clone())),
        (None, None) => {}
    }
    for (joint, limits) in arrays::items(options.get_item("bounds")?.as_ref(), "bounds")? {
        let joint = arrays::name(&joint, "a joint of bounds")?;
        builder.bound(joint.as_str(), limits_of(&limits, "bounds")?);
    }
    let mut by_frame = ByFrame {
        targets: of_tasks(options, "targets", &compiled)?,
        weights: of_tasks(options, "weights", &compiled)?,
        builder: &mut builder,
        task: 0,
        frames,
    };
    for (k, task) in tasks.iter().enumerate() {
        by_frame.task = k;
        problem::add(&task, python_model, &inner_model, &mut by_frame)?;
    }
    if let Some(tolerance) = options.get_item("tolerance")? {
        for (quantity, tolerance) in problem::tolerances(&tolerance)? {
            builder.tolerance(quantity, tolerance);
        }
    }
    let rates: [(&str, CostOfWeight); 3] = [
        ("velocity", RateCost::velocity),
        ("acceleration", RateCost::acceleration),
        ("jerk", RateCost::jerk),
    ];
    for (name, cost) in rates {
        if let Some(value) = options.get_item(name)? {
            builder.rate_cost(rate_cost(&value, name, cost)?);
        }
    }
    match (options.get_item("max_speeds")?, robot) {
        (Some(speeds), _) => {
            for (joint, speed) in arrays::items(Some(&speeds), "max_speeds")? {
                let joint = arrays::name(&joint, "a joint of max_speeds")?;
                if let Ok((linear, angular)) = speed.extract::<(f64, f64)>() {
                    builder.max_free_speed(&joint, linear, angular);
                    continue;
                }
                let speed = arrays::number(&speed, &format!("the speed of {joint}"))?;
                builder.max_speed(joint.as_str(), speed);
            }
        }
        (None, Some(robot)) => drop(builder.max_speeds_of(&robot.get().inner)),
        (None, None) => {}
    }
    if let Some(contacts) = options.get_item("contacts")? {
        for object in contacts.try_iter()? {
            builder.contact(contact(&object?, &inner_model)?);
        }
    }
    for (name, is_first) in [("first", true), ("last", false)] {
        if let Some(q) = options.get_item(name)? {
            let q = arrays::vector_of(&q, name, inner_model.configuration_len())?;
            match is_first {
                true => builder.first(&q),
                false => builder.last(&q),
            };
        }
    }
    builder.build().or_raise()
}

/// Constructor of a rate cost from a weight.
type CostOfWeight = fn(f64) -> RateCost;

/// Reads a weight, or a weight and factors by joint.
fn rate_cost(value: &Bound<'_, PyAny>, name: &str, cost: CostOfWeight) -> PyResult<RateCost> {
    if let Ok((weight, factors)) = value.extract::<(f64, Bound<'_, PyAny>)>() {
        let mut weighted = cost(weight);
        for (joint, factor) in arrays::items(Some(&factors), name)? {
            let joint = arrays::name(&joint, &format!("a joint of {name}"))?;
            weighted = weighted.scale(joint, arrays::number(&factor, name)?);
        }
        return Ok(weighted);
    }
    Ok(cost(arrays::number(value, name)?))
}

/// Reads a `kinopt.Contact`.
fn contact(object: &Bound<'_, PyAny>, model: &kinopt::Model) -> PyResult<Contact> {
    let get = |name: &str| match object.getattr_opt(name)? {
        Some(value) => Ok(value),
        None => Err(invalid(format!(
            "contacts holds {}, which is no kinopt.Contact",
            object.repr()?
        ))),
    };
    let frame: FrameId = model
        .frame(&arrays::name(&get("frame")?, "the frame of a contact")?)
        .or_raise()?;
    let (start, stop) = (
        arrays::whole(&get("start")?)?,
        arrays::whole(&get("stop")?)?,
    );
    let points = arrays::rows(&get("at")?, "the points of a contact", 3)?;
    let points = points
        .chunks_exact(3)
        .map(|at| Vector3::new(at[0], at[1], at[2]));
    Ok(Contact::new(frame, start..stop).at(points))
}
