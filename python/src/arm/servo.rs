//! One target a tick, with bounded speeds.

use std::sync::{Arc, Mutex, PoisonError};

use kinopt::arm::{HeldBy, Servo as Ticking, ServoStatus};
use kinopt::ik::Side;
use numpy::PyArray1;
use pyo3::prelude::*;
use self_cell::self_cell;

use crate::arrays;
use crate::error::OrRaise;
use crate::placement::placement;
use crate::solution::Collision;

self_cell!(
    /// A servo and the arm it moves.
    struct Cell {
        owner: Arc<kinopt::Arm>,
        #[covariant]
        dependent: Ticking,
    }
);

/// Follows targets that come at a fixed rate, with bounded joint speeds; made by `Arm.servo`.
///
/// No tick moves a joint further than its velocity limit times the time step, and limits hold to the bit.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Servo {
    cell: Mutex<Cell>,
}

impl Servo {
    pub(super) fn new(
        arm: Arc<kinopt::Arm>,
        start: &[f64],
        time_step: f64,
        velocity_limits: Option<&[f64]>,
        damping: Option<f64>,
    ) -> PyResult<Self> {
        let cell = Cell::try_new(arm, |arm| {
            let mut servo = arm.servo(start, time_step).or_raise()?;
            if let Some(limits) = velocity_limits {
                servo = servo.with_velocity_limits(limits).or_raise()?;
            }
            match damping {
                Some(radians) => servo.with_damping(radians).or_raise(),
                None => Ok(servo),
            }
        })?;
        Ok(Self {
            cell: Mutex::new(cell),
        })
    }
}

#[pymethods]
impl Servo {
    /// Where the arm stands, shape (dof,), radians or metres.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let cell = self.cell.lock().unwrap_or_else(PoisonError::into_inner);
        arrays::list(py, cell.borrow_dependent().q())
    }

    /// Highest speeds, shape (dof,), rad/s or m/s; inf for none.
    #[getter]
    fn velocity_limits<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let cell = self.cell.lock().unwrap_or_else(PoisonError::into_inner);
        arrays::list(py, cell.borrow_dependent().velocity_limits())
    }

    /// One tick towards a target (4 x 4, metres): a `ServoStep`.
    ///
    /// Raises `InvalidValueError` for a target that is no rigid motion.
    fn step(&self, py: Python<'_>, target: &Bound<'_, PyAny>) -> PyResult<ServoStep> {
        let target = placement(target, "target")?;
        py.detach(|| {
            let mut cell = self.cell.lock().unwrap_or_else(PoisonError::into_inner);
            cell.with_dependent_mut(|_, servo| {
                let step = servo.step(target).or_raise()?;
                Ok(ServoStep {
                    q: step.q.to_vec(),
                    velocity: step.velocity.to_vec(),
                    status: status_name(step.status),
                    reached: step.reached(),
                    position_error: step.position_error,
                    orientation_error: step.orientation_error,
                    held: step
                        .held()
                        .map(|(joint, by)| (joint.to_owned(), by_name(by)))
                        .collect(),
                    collisions: step
                        .collisions
                        .iter()
                        .cloned()
                        .map(Collision::from)
                        .collect(),
                })
            })
        })
    }

    fn __repr__(&self) -> String {
        let cell = self.cell.lock().unwrap_or_else(PoisonError::into_inner);
        format!("Servo(at {})", arrays::few(cell.borrow_dependent().q()))
    }
}

fn status_name(status: ServoStatus) -> &'static str {
    match status {
        ServoStatus::OnTarget => "on_target",
        ServoStatus::SpeedLimited => "speed_limited",
        ServoStatus::Settling => "settling",
        ServoStatus::Blocked => "blocked",
        ServoStatus::Touching => "touching",
        _ => "nearest",
    }
}

fn by_name(by: HeldBy) -> &'static str {
    match by {
        HeldBy::Limit(Side::Lower) => "lower limit",
        HeldBy::Limit(Side::Upper) => "upper limit",
        HeldBy::Speed(Side::Lower) => "speed down",
        HeldBy::Speed(Side::Upper) => "speed up",
        _ => "other",
    }
}

/// One tick of a `Servo`: where the arm stands after it, and the truth about it.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct ServoStep {
    q: Vec<f64>,
    velocity: Vec<f64>,
    /// "on_target", "speed_limited" (on its way, as fast as a joint may), "settling" (on its way, held back
    /// by damping alone), "nearest" (at rest at the nearest place), "blocked" (stopped before it touches
    /// something) or "touching" (something touches still that did where the servo began, and comes no nearer).
    #[pyo3(get)]
    status: &'static str,
    /// Whether the tool is within the tolerances of its target, and nothing touches.
    #[pyo3(get)]
    reached: bool,
    /// Distance of the tool from its target, metres.
    #[pyo3(get)]
    position_error: f64,
    /// Angle between the tool and its target, radians.
    #[pyo3(get)]
    orientation_error: f64,
    held: Vec<(String, &'static str)>,
    collisions: Vec<Collision>,
}

#[pymethods]
impl ServoStep {
    /// The joints, shape (dof,), radians or metres, within their limits.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.q)
    }

    /// How fast the joints went in this tick, shape (dof,), rad/s or m/s.
    #[getter]
    fn velocity<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        arrays::list(py, &self.velocity)
    }

    /// The joints that are held back, and by what: [(joint, "lower limit" | "upper limit" | "speed down" |
    /// "speed up")].
    #[getter]
    fn held(&self) -> Vec<(String, &'static str)> {
        self.held.clone()
    }

    /// What is in the way, or touches where the arm stands, the deepest first: `Collision`s; none on target.
    #[getter]
    fn collisions(&self) -> Vec<Collision> {
        self.collisions.clone()
    }

    fn __repr__(&self) -> String {
        format!(
            "ServoStep({}, {:.3e} m, {:.3e} rad)",
            self.status, self.position_error, self.orientation_error
        )
    }
}
