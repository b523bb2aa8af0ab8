//! The parts of a solution: what became of each task, and what stood in the way.

use kinopt::ik::{BodyKind, BoundKind, Side};
use kinopt::task::{Quantity, Role};
use pyo3::prelude::*;

use super::quantity;
use crate::pickling;

/// How many times a search looked at the problem.
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

/// Two things that are nearer to each other than they should be, or that end a way. Its text says what each of them is.
#[pyclass(frozen, eq, module = "kinopt")]
#[derive(Clone, PartialEq)]
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

    /// What the first is: "link" or "obstacle".
    #[getter]
    fn first_kind(&self) -> &'static str {
        self.0.first_kind.name()
    }

    /// What the second is: "link" or "obstacle".
    #[getter]
    fn second_kind(&self) -> &'static str {
        self.0.second_kind.name()
    }

    /// How far they are apart, metres; negative where one is in the other.
    #[getter]
    fn distance(&self) -> f64 {
        self.0.distance
    }

    /// How deep one is in the other, metres; 0 where they are apart.
    #[getter]
    fn depth(&self) -> f64 {
        self.0.depth()
    }

    /// Whether they are met on the way to a place, not at it: the step of a path or of a drag, or a part of it, was not made, as it is
    /// not surely free. `distance` is then that where the way ends, and may be up to a micrometre more than the margin.
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

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        let own = &slf.get().0;
        let names = (own.first.clone(), own.second.clone());
        let links = [own.first_kind, own.second_kind].map(|kind| kind == BodyKind::Link);
        pickling::by_rebuild::<Self>(slf.py(), (names, links, own.distance, own.on_the_way))
    }

    #[staticmethod]
    fn _rebuild(
        names: (String, String),
        links: [bool; 2],
        distance: f64,
        on_the_way: bool,
    ) -> Self {
        let [first, second] = links.map(|is_link| match is_link {
            true => BodyKind::Link,
            false => BodyKind::Obstacle,
        });
        let pair = kinopt::ik::Collision::new(&names.0, &names.1, distance).between(first, second);
        Self(if on_the_way {
            pair.met_on_the_way()
        } else {
            pair
        })
    }
}

/// How one task came out.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct TaskReport {
    /// The task's name.
    #[pyo3(get)]
    name: String,
    /// The first frame it looks at; None where it looks at none.
    #[pyo3(get)]
    frame: Option<String>,
    role: Role,
    /// Whether it closes a loop of the model: nobody gave it.
    #[pyo3(get)]
    is_loop: bool,
    /// Its strict level: tasks of level 0 come first.
    #[pyo3(get)]
    level: usize,
    /// Whether all its rows that have a weight are within tolerance.
    #[pyo3(get)]
    reached: bool,
    /// Its errors, quantity by quantity.
    #[pyo3(get)]
    rows: Vec<RowsReport>,
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
            rows: report.rows.iter().map(RowsReport::from).collect(),
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
        match self.role {
            Role::Preference => "preference",
            _ => "goal",
        }
    }

    /// The error in metres (a rig's own unit for rigs); None where the task measures none.
    #[getter]
    fn position_error(&self) -> Option<f64> {
        self.position_error
    }

    /// The error in radians; None where the task measures none.
    #[getter]
    fn orientation_error(&self) -> Option<f64> {
        self.orientation_error
    }

    /// The error in rows of a quantity, in its unit: "metres", "radians", "pixels", "joint units", "joint
    /// units per second" or "ratio"; None where the task has no such rows. Another name raises
    /// `UnknownNameError`.
    fn error(&self, quantity: &str) -> PyResult<Option<f64>> {
        let quantity = self::quantity(quantity)?;
        let errors = self.rows.iter().filter(|rows| rows.quantity == quantity);
        Ok(errors.map(|rows| rows.error).reduce(f64::hypot))
    }

    fn __repr__(&self) -> String {
        let errors: Vec<String> = self.rows.iter().map(RowsReport::text).collect();
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

/// The error of a task's rows of one quantity, before weighting.
#[pyclass(frozen, module = "kinopt")]
#[derive(Clone)]
pub(crate) struct RowsReport {
    quantity: Quantity,
    /// Euclidean norm of the rows, in the unit of `quantity`, whatever their weight.
    #[pyo3(get)]
    error: f64,
    /// Whether the error is within the task's tolerance. Rows of weight 0 are not asked for: they never
    /// count as missed.
    #[pyo3(get)]
    reached: bool,
}

impl From<&kinopt::ik::RowsReport> for RowsReport {
    fn from(rows: &kinopt::ik::RowsReport) -> Self {
        Self {
            quantity: rows.quantity,
            error: rows.error,
            reached: rows.reached,
        }
    }
}

impl RowsReport {
    fn text(&self) -> String {
        format!("{:.3e} {}", self.error, self.quantity)
    }
}

#[pymethods]
impl RowsReport {
    /// What the rows measure: "metres", "radians", "pixels", "joint units", "joint units per second" or
    /// "ratio".
    #[getter]
    fn quantity(&self) -> String {
        self.quantity.to_string()
    }

    fn __repr__(&self) -> String {
        format!("RowsReport({})", self.text())
    }
}

/// A limit that holds a solution back: the joint stands on it and the cost would fall beyond it.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct ActiveLimit {
    /// The joint's name.
    #[pyo3(get)]
    joint: String,
    side: Side,
    kind: BoundKind,
    /// The limit, radians or metres.
    #[pyo3(get)]
    value: f64,
    /// Whether the limit is an angle.
    #[pyo3(get)]
    is_angle: bool,
    /// How fast the cost would fall beyond it, per radian or metre.
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
        match self.side {
            Side::Lower => "lower",
            Side::Upper => "upper",
        }
    }

    /// "limit" for the joint's own, "move" for how far the question lets it move from the start.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.kind {
            BoundKind::Move => "move",
            _ => "limit",
        }
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
