//! Parts of a solution: reports of tasks, active limits and collisions.

use kinopt::ik::{BoundKind, Side};
use kinopt::task::{Quantity, Role};
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
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct TaskReport {
    /// Name of the task.
    #[pyo3(get)]
    name: String,
    /// First frame of the task; None if it uses no frame.
    #[pyo3(get)]
    frame: Option<String>,
    role: Role,
    /// True if the task closes a loop of the model, and is not one of the problem.
    #[pyo3(get)]
    is_loop: bool,
    /// Strict priority level: level 0 comes first.
    #[pyo3(get)]
    level: usize,
    /// True if all its rows with a positive weight are within tolerance.
    #[pyo3(get)]
    reached: bool,
    /// Errors of its rows by quantity.
    #[pyo3(get)]
    rows: Vec<RowBlockReport>,
    position_error: Option<f64>,
    orientation_error: Option<f64>,
}

impl From<kinopt::ik::TaskReport<'_>> for TaskReport {
    fn from(report: kinopt::ik::TaskReport<'_>) -> Self {
        Self {
            name: report.name.to_owned(),
            frame: report.frame.map(str::to_owned),
            role: report.role,
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
    /// "goal" or "preference".
    #[getter]
    fn role(&self) -> &'static str {
        names::role(self.role)
    }

    /// Error in metres (for rigs, the rig's unit); None if the task does not measure it.
    #[getter]
    fn position_error(&self) -> Option<f64> {
        self.position_error
    }

    /// Error in radians; None if the task does not measure it.
    #[getter]
    fn orientation_error(&self) -> Option<f64> {
        self.orientation_error
    }

    /// Error in rows of a quantity, in its unit: "metres", "radians", "pixels", "joint units", "joint units per second"
    /// or "ratio"; None if the task has no such rows. Another name raises `UnknownNameError`.
    fn error(&self, quantity: &str) -> PyResult<Option<f64>> {
        let quantity = names::quantity(quantity).or_raise()?;
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
            self.role(),
            errors.join(", ")
        )
    }
}

/// Error of a task's rows of one quantity, before weighting.
#[pyclass(frozen, module = "kinopt")]
#[derive(Clone)]
pub(crate) struct RowBlockReport {
    quantity: Quantity,
    /// Euclidean norm of the rows, in the unit of `quantity`, independent of their weight.
    #[pyo3(get)]
    error: f64,
    /// True if the error is within the task's tolerance. Rows of weight 0 never count as missed.
    #[pyo3(get)]
    reached: bool,
}

impl From<&kinopt::ik::RowBlockReport> for RowBlockReport {
    fn from(rows: &kinopt::ik::RowBlockReport) -> Self {
        Self {
            quantity: rows.quantity,
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
    /// Quantity of the rows: "metres", "radians", "pixels", "joint units", "joint units per second" or "ratio".
    #[getter]
    fn quantity(&self) -> String {
        self.quantity.to_string()
    }

    fn __repr__(&self) -> String {
        format!("RowBlockReport({})", self.text())
    }
}

/// Active limit of a solution: the joint is at the limit, and the cost would decrease beyond it.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct ActiveLimit {
    /// Name of the joint.
    #[pyo3(get)]
    joint: String,
    side: Side,
    kind: BoundKind,
    /// The limit, radians or metres.
    #[pyo3(get)]
    value: f64,
    /// True if the limit is an angle.
    #[pyo3(get)]
    is_angle: bool,
    /// Slope of the cost beyond the limit, per radian or metre.
    #[pyo3(get)]
    push: f64,
}

impl From<kinopt::ik::ActiveLimit<'_>> for ActiveLimit {
    fn from(limit: kinopt::ik::ActiveLimit<'_>) -> Self {
        Self {
            joint: limit.joint.to_owned(),
            side: limit.side,
            kind: limit.kind,
            value: limit.value,
            is_angle: limit.is_angle,
            push: limit.push,
        }
    }
}

#[pymethods]
impl ActiveLimit {
    /// "lower" or "upper".
    #[getter]
    fn side(&self) -> &'static str {
        names::side(self.side)
    }

    /// "limit" for a joint limit, "move" for a `max_move` of the query.
    #[getter]
    fn kind(&self) -> &'static str {
        names::bound_kind(self.kind)
    }

    fn __repr__(&self) -> String {
        let unit = if self.is_angle { "rad" } else { "m" };
        format!(
            "ActiveLimit({:?}, {} {} {} {unit})",
            self.joint,
            self.side(),
            self.kind(),
            self.value
        )
    }
}
