//! Whole motions: many frames solved as one.

mod by_frame;
mod solution;

use std::sync::Arc;

use kinopt::model::FrameId;
use kinopt::motion::clip::{self, Contact, MotionSolver, RateCost, Windows};
use kinopt::spatial::Vector3;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

use self::by_frame::{ByFrame, of_tasks};
pub(crate) use self::solution::{ActiveMotionLimit, MissedFrame, MotionSolution};
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::has_model::model_of;
use crate::pickling;
use crate::problem::{self, ParameterMap, Stated, limits_of, raised};
use crate::robot::Robot;

/// Many frames of one model as one bounded least-squares problem.
///
/// `frames` frames are `time_step` seconds apart. `tasks` are those of `kinopt.tasks` in every frame, `parameters`,
/// `bounds` and `tolerance` as of a `Problem`. `targets` says where tasks are frame by frame: {"task": one target a frame}, by the
/// tasks' names or numbers, and `weights` what multiplies their rows: {"task": (frames,)}; 0 asks nothing.
///
/// `velocity`, `acceleration` and `jerk` are what those cost, per rad/s or m/s and so on: a weight, or (weight, {"joint":
/// factor}). `max_speeds` are hard limits from each frame to the next, {"joint": rad/s or m/s}; unset those of a robot's file, {} none.
/// A ball's is of the angle that it turns by; a free joint has (m/s, rad/s), of the way that its place goes and of its turn.
/// `contacts` are `kinopt.Contact`s: what stands still over a span. `first` and `last` fix those frames' configurations.
/// A model's closed loops and its balls' cones hold in every frame.
///
/// Raises `UnknownNameError` for names that do not exist, and `InvalidValueError` for what is out of range, with its name.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct MotionProblem {
    inner: Arc<clip::MotionProblem>,
    joint_names: Vec<String>,
    given: (Py<PyAny>, usize, f64, Py<PyList>),
    options: Py<PyDict>,
}

/// What is given by keywords.
const OPTIONS: [&str; 12] = [
    "parameters",
    "bounds",
    "tolerance",
    "targets",
    "weights",
    "velocity",
    "acceleration",
    "jerk",
    "max_speeds",
    "contacts",
    "first",
    "last",
];

#[pymethods]
impl MotionProblem {
    #[new]
    #[pyo3(signature = (
        model, frames, time_step, tasks, *, parameters = None, bounds = None, tolerance = None, targets = None,
        weights = None, velocity = None, acceleration = None, jerk = None, max_speeds = None, contacts = None,
        first = None, last = None
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn new(
        model: &Bound<'_, PyAny>,
        frames: usize,
        time_step: f64,
        tasks: &Bound<'_, PyAny>,
        parameters: Option<&Bound<'_, ParameterMap>>,
        bounds: Option<&Bound<'_, PyAny>>,
        tolerance: Option<&Bound<'_, PyAny>>,
        targets: Option<&Bound<'_, PyAny>>,
        weights: Option<&Bound<'_, PyAny>>,
        velocity: Option<&Bound<'_, PyAny>>,
        acceleration: Option<&Bound<'_, PyAny>>,
        jerk: Option<&Bound<'_, PyAny>>,
        max_speeds: Option<&Bound<'_, PyAny>>,
        contacts: Option<&Bound<'_, PyAny>>,
        first: Option<&Bound<'_, PyAny>>,
        last: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let py = model.py();
        let tasks = tasks.try_iter();
        let tasks = tasks.map_err(|_| invalid("tasks must be a list of tasks"))?;
        let tasks = PyTuple::new(py, tasks.collect::<PyResult<Vec<_>>>()?)?;
        let options = PyDict::new(py);
        let given = [
            parameters.map(Bound::as_any),
            bounds,
            tolerance,
            targets,
            weights,
            velocity,
            acceleration,
            jerk,
            max_speeds,
            contacts,
            first,
            last,
        ];
        // What may be changed later by who made it is copied.
        let copy = py.import("copy")?;
        for (name, value) in OPTIONS.into_iter().zip(given) {
            if let Some(value) = value {
                options.set_item(name, copy.call_method1("deepcopy", (value,))?)?;
            }
        }
        let inner = build(model, frames, time_step, &tasks, &options)?;
        let own = model_of(model)?;
        let names = crate::model::Model { inner: own }.coordinate_names();
        Ok(Self {
            inner: Arc::new(inner),
            joint_names: names,
            given: (
                model.clone().unbind(),
                frames,
                time_step,
                tasks.to_list().unbind(),
            ),
            options: options.unbind(),
        })
    }

    /// How many frames there are.
    #[getter]
    fn frames(&self) -> usize {
        self.inner.frames()
    }

    /// The time from a frame to the next, in seconds.
    #[getter]
    fn time_step(&self) -> f64 {
        self.inner.time_step_s()
    }

    /// The names of the tasks.
    #[getter]
    fn task_names(&self) -> Vec<String> {
        let problem = self.inner.problem();
        let names = (0..problem.tasks()).filter_map(|task| problem.task_name(task));
        names.map(str::to_owned).collect()
    }

    /// Solves the motion from one configuration, shape (nq,), frame by frame first, or from a motion near it, shape (frames, nq),
    /// which need not keep any limit.
    ///
    /// `tolerance` is the share of the cost that a step must promise; `slip` how far what stands may slip from a frame to the
    /// next, metres; `curvature` whether frames bend as they do or as JᵀJ says, which is less exact far from targets and less
    /// work. `windows` = (frames, ahead) solves a long motion window by window. Python's other threads run meanwhile.
    ///
    /// Raises `InvalidValueError` for starts that are not finite, options out of range, fixed frames that speed limits part.
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
    ) -> PyResult<MotionSolution> {
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
        Ok(MotionSolution::new(
            &solved,
            self.joint_names.clone(),
            width,
        ))
    }

    fn __repr__(&self) -> String {
        let (frames, step) = (self.frames(), self.time_step());
        format!(
            "MotionProblem({frames} frames, {step} s apart, {} tasks)",
            self.inner.problem().tasks()
        )
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let (py, own) = (slf.py(), slf.get());
        let (model, frames, time_step, tasks) = &own.given;
        let arguments = (model, *frames, *time_step, tasks).into_pyobject(py)?;
        pickling::by_keywords::<Self>(py, &arguments, own.options.bind(py))
    }
}

fn build(
    whole: &Bound<'_, PyAny>,
    frames: usize,
    time_step: f64,
    tasks: &Bound<'_, PyTuple>,
    options: &Bound<'_, PyDict>,
) -> PyResult<clip::MotionProblem> {
    let py = whole.py();
    let own = model_of(whole)?;
    // States one frame first: names, tasks and options are then known to be right.
    let of_frame = PyDict::new(py);
    for name in ["parameters", "bounds", "tolerance"] {
        if let Some(value) = options.get_item(name)? {
            of_frame.set_item(name, value)?;
        }
    }
    of_frame.set_item("derivatives", "analytic")?;
    of_frame.set_item("preferences", "traded")?;
    let stated = Stated::new(whole, tasks, &of_frame, None)?.map_err(invalid)?;
    let mut builder = clip::MotionProblem::builder(&own, frames, time_step);
    let map = options.get_item("parameters")?;
    let robot = whole.cast::<Robot>().ok();
    match (map, robot) {
        (Some(map), _) => drop(builder.parameters(map.cast::<ParameterMap>()?.get().inner.clone())),
        (None, Some(robot)) => drop(builder.parameters(robot.get().inner.map().clone())),
        (None, None) => {}
    }
    for (joint, limits) in problem::items(options.get_item("bounds")?.as_ref(), "bounds")? {
        let joint = arrays::name(&joint, "a joint of bounds")?;
        builder.bound(joint.as_str(), limits_of(&limits, "bounds")?);
    }
    let mut asked = ByFrame {
        targets: of_tasks(options, "targets", &stated)?,
        weights: of_tasks(options, "weights", &stated)?,
        builder: &mut builder,
        task: 0,
        frames,
    };
    for (k, task) in tasks.iter().enumerate() {
        asked.task = k;
        problem::add(&task, whole, &own, &mut asked)?;
    }
    if let Some(tolerance) = options.get_item("tolerance")? {
        for (quantity, tolerance) in problem::tolerances(&tolerance)? {
            builder.tolerance(quantity, tolerance);
        }
    }
    let rates: [(&str, OfWeight); 3] = [
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
            for (joint, speed) in problem::items(Some(&speeds), "max_speeds")? {
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
        for given in contacts.try_iter()? {
            builder.contact(contact(&given?, &own)?);
        }
    }
    for (name, is_first) in [("first", true), ("last", false)] {
        if let Some(q) = options.get_item(name)? {
            let q = arrays::vector_of(&q, name, own.configuration_len())?;
            match is_first {
                true => builder.first(&q),
                false => builder.last(&q),
            };
        }
    }
    builder.build().or_raise()
}

/// A rate cost of a weight.
type OfWeight = fn(f64) -> RateCost;

/// A weight, or a weight and factors by joint.
fn rate_cost(value: &Bound<'_, PyAny>, name: &str, cost: OfWeight) -> PyResult<RateCost> {
    if let Ok((weight, factors)) = value.extract::<(f64, Bound<'_, PyAny>)>() {
        let mut own = cost(weight);
        for (joint, factor) in problem::items(Some(&factors), name)? {
            let joint = arrays::name(&joint, &format!("a joint of {name}"))?;
            own = own.times(joint, arrays::number(&factor, name)?);
        }
        return Ok(own);
    }
    Ok(cost(arrays::number(value, name)?))
}

/// A `kinopt.Contact`.
fn contact(given: &Bound<'_, PyAny>, model: &kinopt::Model) -> PyResult<Contact> {
    let get = |name: &str| match given.getattr_opt(name)? {
        Some(value) => Ok(value),
        None => Err(invalid(format!(
            "contacts holds {}, which is no kinopt.Contact",
            given.repr()?
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
