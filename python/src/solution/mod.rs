//! What came out of a solve.

mod reports;

use kinopt::task::Quantity;
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

use crate::arrays;
use crate::error::OrRaise;
use crate::pickling;
pub(crate) use reports::{ActiveLimit, Collision, Counts, RowsReport, TaskReport};

/// The result of a solve, reached or not: the best configuration found and the truth about it.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Solution {
    inner: kinopt::Solution,
    /// Made when it is first read, and then the same array every time.
    q: PyOnceLock<Py<PyArray1<f64>>>,
}

impl From<kinopt::Solution> for Solution {
    fn from(inner: kinopt::Solution) -> Self {
        Self {
            inner,
            q: PyOnceLock::new(),
        }
    }
}

#[pymethods]
impl Solution {
    /// The configuration, shape (nq,), radians and metres, within all limits to the bit.
    ///
    /// Always the same array, which cannot be written to: take a copy to change it.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let array = self.q.get_or_try_init(py, || {
            let array = arrays::list(py, &self.inner.q);
            arrays::freeze(&array)?;
            PyResult::Ok(array.unbind())
        })?;
        Ok(array.bind(py).clone())
    }

    /// Whether every goal is within its tolerances at `q`, and nothing touches (`collisions`).
    #[getter]
    fn reached(&self) -> bool {
        self.inner.reached
    }

    /// The largest error of any goal in metres (a rig's own unit for rigs); None where no goal measures
    /// any.
    #[getter]
    fn position_error(&self) -> Option<f64> {
        self.inner.position_error()
    }

    /// The largest error of any goal in radians; None where no goal measures any.
    #[getter]
    fn orientation_error(&self) -> Option<f64> {
        self.inner.orientation_error()
    }

    /// Which test ended the attempt that is returned, or what ended the whole search early: "reached",
    /// "stationary", "small_step", "stalled", "iteration_limit", "time_limit", "cannot_continue",
    /// "cancelled" or "non_finite".
    #[getter]
    fn termination(&self) -> &'static str {
        self.inner.termination.name()
    }

    /// Half the sum of the squared weighted residuals at `q`, of goals and preferences.
    #[getter]
    fn cost(&self) -> f64 {
        self.inner.cost
    }

    /// How steep the cost still is along the steepest free variable at `q`; None where the goals were
    /// reached first.
    #[getter]
    fn projected_gradient(&self) -> Option<f64> {
        self.inner.projected_gradient
    }

    /// Steps of all attempts together.
    #[getter]
    fn iterations(&self) -> usize {
        self.inner.iterations
    }

    /// Attempts made, the caller's start included.
    #[getter]
    fn attempts(&self) -> usize {
        self.inner.attempts
    }

    /// How many of the attempts stopped as near as this solution; 0 where it is reached, where it was cut
    /// short, or where attempts are not compared. Many that agree are no proof that a target is out of
    /// reach, but most often it is.
    #[getter]
    fn agreeing(&self) -> usize {
        self.inner.agreeing
    }

    /// Evaluations of all attempts together.
    #[getter]
    fn counts(&self) -> Counts {
        self.inner.counts.into()
    }

    /// How every task came out, in the order in which the tasks were given, then the model's loops.
    #[getter]
    fn tasks(&self) -> Vec<TaskReport> {
        self.inner.tasks().map(TaskReport::from).collect()
    }

    /// The limits that hold the solution back; empty when it is reached.
    #[getter]
    fn active_limits(&self) -> Vec<ActiveLimit> {
        self.inner.active_limits().map(ActiveLimit::from).collect()
    }

    /// What is in the way: the pairs that are nearer to each other at `q` than the margin asked for, the deepest first; or where there are
    /// none and the step to a better place is not surely free, the pair that it would come to (`on_the_way`). A solution that is
    /// reached has none; none are known where no world was given.
    #[getter]
    fn collisions(&self) -> Vec<Collision> {
        let pairs = self.inner.collisions().iter().cloned();
        pairs.map(Collision::from).collect()
    }

    /// Whether every goal is within its tolerances at `q`, though something may be touched.
    #[getter]
    fn goals_reached(&self) -> bool {
        self.inner.goals_reached()
    }

    /// Whether every loop of the model is closed at `q`, to 1e-9 m and rad; True where it has none. A solution that
    /// is reached has closed them all.
    #[getter]
    fn loops_closed(&self) -> bool {
        self.inner.loops_closed()
    }

    /// The loops that are open at `q`: tuples of the name, the gap in metres, and the angle in radians, 0 for a
    /// "connect".
    #[getter]
    fn open_loops(&self) -> Vec<(&str, f64, f64)> {
        let open = self.inner.open_loops();
        open.map(|open| (open.name, open.gap, open.angle)).collect()
    }

    /// Whether a missed goal is certainly out of reach: its place is farther from where the chain begins
    /// than the chain is long. False where that is not known.
    #[getter]
    fn is_out_of_reach(&self) -> bool {
        self.inner.is_out_of_reach()
    }

    /// Names of the preferences that keep a missed goal from coming nearer, the strongest first. Only
    /// where preferences are "traded" off against goals can there be any.
    #[getter]
    fn pulling_preferences(&self) -> Vec<&str> {
        self.inner.pulling_preferences().collect()
    }

    /// Says which task missed by how much, which limits hold it, and why the search ended.
    fn explain(&self) -> String {
        self.inner.explain()
    }

    #[classmethod]
    fn _rebuild(_class: &Bound<'_, PyType>, text: &str) -> PyResult<Self> {
        let inner: kinopt::Solution = serde_json::from_str(text).or_raise()?;
        Ok(Self::from(inner))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        pickling::by_json::<Self>(py, &self.inner)
    }

    /// `bool(solution)` is `solution.reached`.
    fn __bool__(&self) -> bool {
        self.inner.reached
    }

    fn __repr__(&self) -> String {
        let Self { inner, .. } = self;
        let mut text = match inner.reached {
            true => "Solution(reached".to_owned(),
            false => format!("Solution(not reached, {}", inner.termination),
        };
        let errors = [
            (inner.position_error(), "position_error"),
            (inner.orientation_error(), "orientation_error"),
        ];
        for (error, name) in errors {
            if let Some(error) = error {
                text += &format!(", {name}={error:.3e}");
            }
        }
        text + &format!(", q={})", arrays::few(&inner.q))
    }
}

/// The quantities that errors, weights and tolerances are in, under the names that the library's messages
/// have for them.
const QUANTITIES: [Quantity; 8] = [
    Quantity::Metres,
    Quantity::Radians,
    Quantity::Pixels,
    Quantity::JointUnits,
    Quantity::JointUnitsPerSecond,
    Quantity::MetresPerSecond,
    Quantity::RadiansPerSecond,
    Quantity::Ratio,
];

/// A quantity by its name.
pub(crate) fn quantity(name: &str) -> PyResult<Quantity> {
    let known = QUANTITIES.into_iter().find(|q| q.to_string() == name);
    let names = QUANTITIES.map(|quantity| quantity.to_string());
    let names = names.iter().map(String::as_str);
    known
        .ok_or_else(|| kinopt::model::UnknownName::new("quantity", name, names))
        .or_raise()
}
