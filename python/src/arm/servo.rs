//! Servos: one target in each control cycle, within all joint limits.

use std::sync::{Arc, Mutex, PoisonError};

use kinopt::arm::{Servo as Controlled, ServoStep as Cycle};
use kinopt::task::PoseBounds;
use kinopt_bindings::names::{held_by, servo_status};
use kinopt_bindings::option::servo::ServoOptions;
use numpy::PyArray1;
use pyo3::prelude::*;
use self_cell::self_cell;

use crate::arrays::{self, Floats};
use crate::error::OrRaise;
use crate::object::Object;
use crate::placement;
use crate::solution::Collision;

self_cell!(
    /// A servo and its arm.
    struct Cell {
        owner: Arc<kinopt::Arm>,
        #[covariant]
        dependent: Controlled,
    }
);

/// Servo: one joint position command in each control cycle; made by `Arm.servo`.
///
/// Every cycle satisfies the position, velocity, acceleration and jerk limits of the joints for any targets.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Servo {
    goal: PoseBounds,
    cell: Mutex<Cell>,
}

impl Servo {
    pub(super) fn new(
        arm: Arc<kinopt::Arm>,
        start: &[f64],
        time_step: f64,
        options: &ServoOptions,
    ) -> PyResult<Self> {
        let goal = arm.goal();
        let cell = Cell::try_new(arm, |arm| {
            let servo = arm.servo(start, time_step).or_raise()?;
            options.apply::<Object>(servo)
        })?;
        Ok(Self {
            goal,
            cell: Mutex::new(cell),
        })
    }

    fn list<'py>(
        &self,
        py: Python<'py>,
        numbers: fn(&Controlled<'_>) -> Vec<f64>,
    ) -> Bound<'py, PyArray1<f64>> {
        let cell = self.cell.lock().unwrap_or_else(PoisonError::into_inner);
        arrays::list(py, &numbers(cell.borrow_dependent()))
    }
}

#[pymethods]
impl Servo {
    /// Commanded joint positions, shape (dof,), radians or metres.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.list(py, |servo| servo.q().to_vec())
    }

    /// Commanded velocities, shape (dof,), rad/s or m/s.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.list(py, |servo| servo.velocity().to_vec())
    }

    /// Commanded accelerations, shape (dof,), rad/s² or m/s².
    #[getter]
    fn acceleration<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.list(py, |servo| servo.acceleration().to_vec())
    }

    /// Velocity limits, shape (dof,), rad/s or m/s; inf for none.
    #[getter]
    fn velocity_limits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.list(py, |servo| servo.velocity_limits().to_vec())
    }

    /// Acceleration limits, shape (dof,), rad/s² or m/s²; inf for none.
    #[getter]
    fn acceleration_limits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.list(py, |servo| servo.acceleration_limits().to_vec())
    }

    /// Jerk limits, shape (dof,), rad/s³ or m/s³; inf for none.
    #[getter]
    fn jerk_limits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.list(py, |servo| servo.jerk_limits().to_vec())
    }

    /// One control cycle towards a target, a placement: a `ServoStep`.
    ///
    /// Raises `InvalidValueError` for a target that is not a rigid motion; the state is then unchanged.
    fn step(&self, py: Python<'_>, target: &Bound<'_, PyAny>) -> PyResult<ServoStep> {
        let target = placement::target(target, "target", &self.goal)?;
        py.detach(|| {
            let mut cell = self.cell.lock().unwrap_or_else(PoisonError::into_inner);
            cell.with_dependent_mut(|_, servo| Ok(ServoStep::of(&servo.step(target).or_raise()?)))
        })
    }

    /// One control cycle of a stop: every joint brakes as hard as its limits allow. Call it in each cycle until the
    /// status is "stopped".
    fn stop(&self, py: Python<'_>) -> ServoStep {
        py.detach(|| {
            let mut cell = self.cell.lock().unwrap_or_else(PoisonError::into_inner);
            cell.with_dependent_mut(|_, servo| ServoStep::of(&servo.stop()))
        })
    }

    fn __repr__(&self) -> String {
        let cell = self.cell.lock().unwrap_or_else(PoisonError::into_inner);
        format!("Servo(at {})", arrays::few(cell.borrow_dependent().q()))
    }
}

/// One control cycle of a `Servo`: the commanded configuration and its errors.
#[pyclass(frozen, get_all, module = "kinopt")]
pub(crate) struct ServoStep {
    /// Commanded joint positions, shape (dof,), radians or metres, within their limits.
    q: Floats,
    /// Difference of `q` to the last cycle, divided by the time step, shape (dof,), rad/s or m/s.
    velocity: Floats,
    /// Difference of `velocity` to the last cycle, divided by the time step, shape (dof,), rad/s² or m/s².
    acceleration: Floats,
    /// State of the servo:
    ///
    /// - "on_target": the tool is within its tolerances.
    /// - "speed_limited": moving; a velocity, acceleration or jerk limit is active.
    /// - "settling": moving; no limit is active: damping or a straight line slows the motion.
    /// - "nearest": at rest at the closest pose to a target out of reach.
    /// - "blocked": brakes or rests before a collision.
    /// - "touching": a pair in contact at the start of the servo is still in contact.
    /// - "stopping", "stopped": braking and at rest after `Servo.stop`.
    status: &'static str,
    /// True if the tool is within the tolerances of its target, and no pair is in contact. The arm may still move: see
    /// `velocity`.
    reached: bool,
    /// Distance of the tool from its target, metres.
    position_error: f64,
    /// Angle between the tool and its target, radians.
    orientation_error: f64,
    /// Joints with an active limit, and that limit: [(joint, "lower limit" | "upper limit" | "speed down" | "speed up"
    /// | "acceleration down" | "acceleration up" | "below lower limit" | "above upper limit")]. The acceleration limits
    /// include jerk and braking distance. The last two are joints that began outside their limits and return.
    held: Vec<(String, &'static str)>,
    /// Pairs that block the motion, or that are in contact, the deepest first: `Collision`s; empty on target.
    collisions: Vec<Collision>,
}

impl ServoStep {
    fn of(step: &Cycle<'_>) -> Self {
        Self {
            q: Floats(step.q.to_vec()),
            velocity: Floats(step.velocity.to_vec()),
            acceleration: Floats(step.acceleration.to_vec()),
            status: servo_status(step.status),
            reached: step.reached(),
            position_error: step.position_error,
            orientation_error: step.orientation_error,
            held: step
                .held()
                .map(|(joint, by)| (joint.to_owned(), held_by(by)))
                .collect(),
            collisions: step
                .collisions
                .iter()
                .cloned()
                .map(Collision::from)
                .collect(),
        }
    }
}

#[pymethods]
impl ServoStep {
    fn __repr__(&self) -> String {
        format!(
            "ServoStep({}, {:.3e} m, {:.3e} rad)",
            self.status, self.position_error, self.orientation_error
        )
    }
}
