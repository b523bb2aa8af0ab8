//! Parts of a solution: reports of tasks, active limits and collisions.

use kinopt_bindings::names;
use pyo3::prelude::*;
use serde::{Deserialize, Serialize};

use crate::error::OrRaise;
use crate::pickling;

/// Number of evaluations of a search.
#[pyclass(frozen, eq, module = "kinopt", get_all)]
#[derive(PartialEq)]
pub(crate) struct Counts {
    /// Residual evaluations.
    residuals: usize,
    /// Jacobian evaluations.
    jacobians: usize,
    /// Gradient evaluations without a Jacobian.
    gradients: usize,
}

impl From<kinopt::solver::Counts> for Counts {
    fn from(counts: kinopt::solver::Counts) -> Self {
        Self {
            residuals: counts.residuals,
            jacobians: counts.jacobians,
            gradients: counts.gradients,
        }
    }
}

#[pymethods]
impl Counts {
    fn __repr__(&self) -> String {
        format!(
            "Counts(residuals={}, jacobians={}, gradients={})",
            self.residuals, self.jacobians, self.gradients
        )
    }
}

/// A pair that is nearer than the margin, or that blocks a motion. Its text names both and their kinds.
#[pyclass(frozen, eq, module = "kinopt")]
#[derive(Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Collision(kinopt::ik::Collision);

impl From<kinopt::ik::Collision> for Collision {
    fn from(pair: kinopt::ik::Collision) -> Self {
        Self(pair)
    }
}

#[pymethods]
impl Collision {
    /// A link of the robot, or an obstacle attached to one.
    #[getter]
    fn first(&self) -> &str {
        &self.0.first
    }

    /// An obstacle, or another link.
    #[getter]
    fn second(&self) -> &str {
        &self.0.second
    }

    /// Kind of the first: "link" or "obstacle".
    #[getter]
    fn first_kind(&self) -> &'static str {
        self.0.first_kind.name()
    }

    /// Kind of the second: "link" or "obstacle".
    #[getter]
    fn second_kind(&self) -> &'static str {
        self.0.second_kind.name()
    }

    /// Distance, metres; negative for penetration.
    #[getter]
    fn distance(&self) -> f64 {
        self.0.distance
    }

    /// Penetration depth, metres; 0 without contact.
    #[getter]
    fn depth(&self) -> f64 {
        self.0.depth()
    }

    /// True if the pair blocks the motion to a configuration. A step of a path or of a drag, or a part of it, was not
    /// made, because it is not proven collision-free. `distance` is that at the end of the motion, up to a micrometre
    /// more than the margin.
    #[getter]
    fn on_the_way(&self) -> bool {
        self.0.on_the_way
    }

    fn __str__(&self) -> String {
        self.0.to_string()
    }

    fn __repr__(&self) -> String {
        format!("Collision({}, distance={})", self.0, self.0.distance)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_json::<Self>(py, self)
    }

    #[staticmethod]
    fn _rebuild(json: &str) -> PyResult<Self> {
        pickling::of_json(json)
    }
}

/// Report of one task.
#[pyclass(frozen, get_all, module = "kinopt")]
pub(crate) struct TaskReport {
    /// Name of the task.
    name: String,
    /// First frame of the task; None if it uses no frame.
    frame: Option<String>,
    /// "goal" or "preference".
    role: &'static str,
    /// True if the task closes a loop of the model, and is not one of the problem.
    is_loop: bool,
    /// Strict priority level: level 0 comes first.
    level: usize,
    /// True if all its rows with a positive weight are within tolerance.
    reached: bool,
    /// Errors of its rows by quantity.
    rows: Vec<RowBlockReport>,
    /// Error in metres (for rigs, the rig's unit); None if the task does not measure it.
    position_error: Option<f64>,
    /// Error in radians; None if the task does not measure it.
    orientation_error: Option<f64>,
}

impl From<kinopt::ik::TaskReport<'_>> for TaskReport {
    fn from(report: kinopt::ik::TaskReport<'_>) -> Self {
        Self {
            name: report.name.to_owned(),
            frame: report.frame.map(str::to_owned),
            role: names::role(report.role),
            is_loop: report.is_loop,
            level: report.level,
            reached: report.reached,
            rows: report.rows.iter().map(RowBlockReport::from).collect(),
            position_error: report.position_error(),
            orientation_error: report.orientation_error(),
        }
    }
}

#[pymethods]
impl TaskReport {
    /// Error in rows of a quantity, in its unit: "metres", "radians", "pixels", "joint units", "joint units per second"
    /// or "ratio"; None if the task has no such rows. Another name raises `UnknownNameError`.
    fn error(&self, quantity: &str) -> PyResult<Option<f64>> {
        let quantity = names::quantity(quantity).or_raise()?.to_string();
        let errors = self.rows.iter().filter(|rows| rows.quantity == quantity);
        Ok(errors.map(|rows| rows.error).reduce(f64::hypot))
    }

    fn __repr__(&self) -> String {
        let errors: Vec<String> = self.rows.iter().map(RowBlockReport::text).collect();
        let reached = if self.reached {
            "reached"
        } else {
            "not reached"
        };
        format!(
            "TaskReport({:?}, {}, {reached}, {})",
            self.name,
            self.role,
            errors.join(", ")
        )
    }
}

/// Error of a task's rows of one quantity, before weighting.
#[pyclass(frozen, get_all, module = "kinopt")]
#[derive(Clone)]
pub(crate) struct RowBlockReport {
    /// Quantity of the rows: "metres", "radians", "pixels", "joint units", "joint units per second" or "ratio".
    quantity: String,
    /// Euclidean norm of the rows, in the unit of `quantity`, independent of their weight.
    error: f64,
    /// True if the error is within the task's tolerance. Rows of weight 0 never count as missed.
    reached: bool,
}

impl From<&kinopt::ik::RowBlockReport> for RowBlockReport {
    fn from(rows: &kinopt::ik::RowBlockReport) -> Self {
        Self {
            quantity: rows.quantity.to_string(),
            error: rows.error,
            reached: rows.reached,
        }
    }
}

impl RowBlockReport {
    fn text(&self) -> String {
        format!("{:.3e} {}", self.error, self.quantity)
    }
}

#[pymethods]
impl RowBlockReport {
    fn __repr__(&self) -> String {
        format!("RowBlockReport({})", self.text())
    }
}

/// Active limit of a solution: the joint is at the limit, and the cost would decrease beyond it.
#[pyclass(frozen, get_all, module = "kinopt")]
pub(crate) struct ActiveLimit {
    /// Name of the joint.
    joint: String,
    /// "lower" or "upper".
    side: &'static str,
    /// "limit" for a joint limit, "move" for a `max_move` of the query.
    kind: &'static str,
    /// The limit, radians or metres.
    value: f64,
    /// True if the limit is an angle.
    is_angle: bool,
    /// Slope of the cost beyond the limit, per radian or metre.
    push: f64,
}

impl From<kinopt::ik::ActiveLimit<'_>> for ActiveLimit {
    fn from(limit: kinopt::ik::ActiveLimit<'_>) -> Self {
        Self {
            joint: limit.joint.to_owned(),
            side: names::side(limit.side),
            kind: names::bound_kind(limit.kind),
            value: limit.value,
            is_angle: limit.is_angle,
            push: limit.push,
        }
    }
}

#[pymethods]
impl ActiveLimit {
    fn __repr__(&self) -> String {
        let unit = if self.is_angle { "rad" } else { "m" };
        format!(
            "ActiveLimit({:?}, {} {} {} {unit})",
            self.joint, self.side, self.kind, self.value
        )
    }
}
