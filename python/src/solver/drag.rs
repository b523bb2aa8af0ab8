//! Drags: one problem with moving targets, solved in every frame.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use kinopt::ik::{MotionLimits, Restarts};
use kinopt::solver::Stopping;
use kinopt_bindings::Value;
use kinopt_bindings::task::Aimed;
use numpy::PyArray1;
use pyo3::prelude::*;

use super::Solver;
use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::has_model::configuration_of_model;
use crate::joint_jump::JointJump;
use crate::object::Object;
use crate::problem::{CompiledProblem, Problem, raised};
use crate::robot::Robot;
use crate::solution::Solution;

/// Default iterations of a frame, as in the library.
const FRAME_ITERATIONS: usize = 40;

/// Solves a problem repeatedly while its targets move, such as a hand dragged by a mouse.
///
/// Each `advance` converges from the end of the last frame, on the current branch, in a bounded number of iterations
/// and without restarts. In one frame no joint moves farther than `max_move`, radians. For a prismatic joint it is the
/// distance by which that angle moves a point at a quarter of the model's reach. If a target jumps or a branch ends,
/// the body follows over several frames; `is_speed_limited` reports it. With `search`, a number of attempts, a frame
/// that converges to a miss also searches from random configurations (sampled by `seed`). `jump` reports a jump to a
/// better solution.
///
/// It starts at the configuration `start`, shape (nq,), which is projected into the limits. `solver` gives the method
/// and the limits of a frame, by default 40 iterations. Raises `InvalidValueError` for a start of another shape, for a
/// problem without tasks, for a geometric method, and for settings out of range. Tasks added to the problem later do
/// not affect the drag.
///
/// With a `time_step` between two frames, seconds, every frame satisfies velocity, acceleration and jerk limits, shape
/// (nq,), rad/s or m/s (s², s³). By default they are those of a robot's files. The first three numbers of a free base
/// limit the norm of its linear rates, the next four that of its angular rates. Limits have priority over all tasks:
/// when targets jump, pinned frames move. Raises `InvalidValueError` for limits without a time step, for a bounded ball
/// joint and for a problem that avoids collisions.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Drag {
    /// The problem of the drag.
    #[pyo3(get)]
    problem: Py<Problem>,
    /// Tasks of the problem at the start of the drag.
    compiled: Arc<CompiledProblem>,
    /// Locked only without the GIL, because frames may call back into Python.
    inner: Mutex<kinopt::ik::Drag>,
}

impl Drag {
    fn lock(&self) -> MutexGuard<'_, kinopt::ik::Drag> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Reads the drag.
    fn look<T: Send>(&self, py: Python<'_>, what: impl FnOnce(&kinopt::ik::Drag) -> T + Send) -> T {
        py.detach(|| what(&self.lock()))
    }

    /// Moves the given targets and runs `on`.
    fn go(
        &self,
        py: Python<'_>,
        targets: Option<&Bound<'_, PyAny>>,
        on: impl FnOnce(&mut kinopt::ik::Drag) + Send,
    ) -> PyResult<Solution> {
        let moves = self.compiled.moves(targets)?;
        let solution = py.detach(|| {
            let mut drag = self.lock();
            for (_, aim) in &moves {
                aim(&mut Aimed::Drag(&mut drag))?;
            }
            on(&mut drag);
            raised().map(|()| drag.solution().clone())
        })?;
        Ok(Solution::new(solution, self.compiled.coordinates(py)?))
    }
}

#[pymethods]
impl Drag {
    #[new]
    #[pyo3(signature = (problem, start, *, max_move = None, time_step = None, velocity_limits = None, acceleration_limits = None, jerk_limits = None, search = None, seed = 0, solver = None))]
    #[allow(clippy::too_many_arguments, reason = "keyword arguments of Python")]
    fn new(
        py: Python<'_>,
        problem: &Bound<'_, Problem>,
        start: &Bound<'_, PyAny>,
        max_move: Option<f64>,
        time_step: Option<f64>,
        velocity_limits: Option<&Bound<'_, PyAny>>,
        acceleration_limits: Option<&Bound<'_, PyAny>>,
        jerk_limits: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] search: Option<usize>,
        #[pyo3(from_py_with = crate::arrays::whole)] seed: u64,
        solver: Option<&Bound<'_, Solver>>,
    ) -> PyResult<Self> {
        let start = configuration_of_model(problem.get().model(py).bind(py), start, "start")?;
        let start = arrays::vector(&start, "start")?.to_vec();
        let compiled = problem.get().compiled()?;
        let inner_problem = &compiled.inner;
        let new = py.detach(|| {
            let drag = kinopt::ik::Drag::new(inner_problem.clone(), &start).or_raise();
            raised().and(drag)
        });
        let mut drag = new?;
        if let Some(solver) = solver {
            let method = solver.get().optimiser("a drag")?;
            let frame = Stopping::default().with_max_iterations(FRAME_ITERATIONS);
            let frame = solver.get().limits.stopping(frame);
            drag = drag.with_solver(method.clone(), frame).or_raise()?;
        }
        if let Some(radians) = max_move {
            drag = drag.with_max_move(radians).or_raise()?;
        }
        if let Some(attempts) = search {
            let restarts = Restarts::default().with_attempts(attempts);
            drag = drag.with_search(restarts.with_seed(seed)).or_raise()?;
        }
        let rate_limits = [velocity_limits, acceleration_limits, jerk_limits];
        match time_step {
            Some(time_step) => {
                let limits = motion_limits(py, problem, inner_problem, rate_limits)?;
                drag = drag.with_motion_limits(time_step, &limits).or_raise()?;
            }
            None if rate_limits.iter().any(Option::is_some) => {
                return Err(invalid("limits of rates need a time_step"));
            }
            None => {}
        }
        Ok(Self {
            problem: problem.clone().unbind(),
            compiled,
            inner: Mutex::new(drag),
        })
    }

    /// Moves targets, by the tasks' names or indices: {"hand": [0.4, 0.1, 0.3]}.
    ///
    /// Raises `UnknownNameError` for an unknown task, `InvalidValueError` for targets of another shape and for numbers
    /// that are not finite.
    fn set_targets(&self, py: Python<'_>, targets: &Bound<'_, PyAny>) -> PyResult<()> {
        let moves = self.compiled.moves(Some(targets))?;
        py.detach(|| {
            let mut drag = self.lock();
            let mut moves = moves.iter();
            moves.try_for_each(|(_, aim)| aim(&mut Aimed::Drag(&mut drag)))
        })
    }

    /// Computes one frame, after moving the given targets.
    ///
    /// Raises as `set_targets`.
    #[pyo3(signature = (targets = None))]
    fn advance(&self, py: Python<'_>, targets: Option<&Bound<'_, PyAny>>) -> PyResult<Solution> {
        self.go(py, targets, |drag| {
            drag.advance();
        })
    }

    /// Computes at most `frames` frames, until the targets are reached and no joint is limited by `max_move`, or the
    /// drag is at rest.
    ///
    /// Raises as `set_targets`.
    #[pyo3(signature = (targets = None, *, frames = 1000))]
    fn follow(
        &self,
        py: Python<'_>,
        targets: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = crate::arrays::whole)] frames: usize,
    ) -> PyResult<Solution> {
        at_least_one(frames)?;
        self.go(py, targets, |drag| {
            drag.follow(frames);
        })
    }

    /// Converges from the current configuration on the current branch, for distant targets. Computes at most `frames`
    /// frames for each of its phases.
    ///
    /// Raises as `set_targets`.
    #[pyo3(signature = (targets = None, *, frames = 1000))]
    fn settle(
        &self,
        py: Python<'_>,
        targets: Option<&Bound<'_, PyAny>>,
        #[pyo3(from_py_with = crate::arrays::whole)] frames: usize,
    ) -> PyResult<Solution> {
        at_least_one(frames)?;
        self.go(py, targets, |drag| {
            drag.settle(frames);
        })
    }

    /// Continues from another configuration, shape (nq,), projected into the limits.
    ///
    /// Raises `InvalidValueError` for another length and for numbers that are not finite.
    fn set_configuration(&self, py: Python<'_>, q: &Bound<'_, PyAny>) -> PyResult<()> {
        let q = configuration_of_model(self.problem.get().model(py).bind(py), q, "q")?;
        let q = arrays::vector(&q, "q")?.to_vec();
        py.detach(|| self.lock().set_configuration(&q).or_raise())
    }

    /// Moves joints and frames on their parents to their placements in `model`, which has the joints of the problem's
    /// model. The configuration stays. For a character whose scales shear its bones, use
    /// `skeleton.standing_in(pose).model` of its pose after each frame.
    ///
    /// Raises `InvalidValueError` for a model of other joints and for a problem that avoids collisions.
    fn move_joints(&self, py: Python<'_>, model: &Bound<'_, crate::model::Model>) -> PyResult<()> {
        let model = &model.get().inner;
        py.detach(|| self.lock().move_joints(model).or_raise())
    }

    /// Current configuration, shape (nq,).
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let q = self.look(py, |drag| drag.q().to_vec());
        arrays::list(py, &q)
    }

    /// Solution of the last frame; None before the first.
    #[getter]
    fn solution(&self, py: Python<'_>) -> PyResult<Option<Solution>> {
        let solution = self.look(py, |drag| drag.solution().clone());
        if solution.q.is_empty() {
            return Ok(None);
        }
        let coordinates = self.compiled.coordinates(py)?;
        Ok(Some(Solution::new(solution, coordinates)))
    }

    /// True if a joint moved by its limit for a frame; the next frames continue.
    #[getter]
    fn is_speed_limited(&self, py: Python<'_>) -> bool {
        self.look(py, kinopt::ik::Drag::is_speed_limited)
    }

    /// True if the next frame would change nothing.
    #[getter]
    fn is_at_rest(&self, py: Python<'_>) -> bool {
        self.look(py, kinopt::ik::Drag::is_at_rest)
    }

    /// Jump of the last frame to another branch; None without one. `index` counts the frames, from 0.
    #[getter]
    fn jump(&self, py: Python<'_>) -> Option<JointJump> {
        self.look(py, |drag| {
            let jump = drag.jump()?;
            let problem = drag.problem();
            let mut leaders = problem.parameters().leaders().iter();
            let variable = leaders.position(|coordinate| *coordinate == jump.joint)?;
            Some(JointJump::new(&jump, &problem.names().joints[variable]))
        })
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        Ok(format!("Drag({})", self.problem.bind(py).repr()?))
    }
}

/// Limits of velocity, acceleration and jerk: the given ones, else those of the robot's files.
fn motion_limits(
    py: Python<'_>,
    problem: &Bound<'_, Problem>,
    inner_problem: &kinopt::Problem,
    rate_limits: [Option<&Bound<'_, PyAny>>; 3],
) -> PyResult<MotionLimits> {
    let model = problem.get().model(py);
    let mut limits = match model.bind(py).cast::<Robot>() {
        Ok(robot) => robot.get().inner.motion_limits(),
        Err(_) => MotionLimits::unlimited(inner_problem.configuration_len()),
    };
    let names = ["velocity_limits", "acceleration_limits", "jerk_limits"];
    let limits_of_rates = [
        &mut limits.velocity,
        &mut limits.acceleration,
        &mut limits.jerk,
    ];
    for ((limit, value), name) in limits_of_rates.into_iter().zip(rate_limits).zip(names) {
        if let Some(value) = value {
            *limit = match Object::of(value).as_number() {
                Some(number) => vec![number; limit.len()],
                None => arrays::vector(value, name)?.to_vec(),
            };
        }
    }
    Ok(limits)
}

fn at_least_one(frames: usize) -> PyResult<()> {
    match frames {
        0 => Err(invalid("frames is 0, expected at least 1")),
        _ => Ok(()),
    }
}
