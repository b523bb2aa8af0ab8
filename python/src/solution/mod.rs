//! Results of a solve.

mod reports;

use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::PyType;

use crate::arrays;
use crate::coordinates::Coordinates;
use crate::error::OrRaise;
use crate::in_python;
use crate::pickling;
pub(crate) use reports::{ActiveLimit, Collision, Counts, RowBlockReport, TaskReport};

/// The result of a solve, reached or not: the best configuration found, with its errors.
#[pyclass(frozen, module = "kinopt")]
pub(crate) struct Solution {
    inner: kinopt::Solution,
    /// Names, limits and units of the numbers of `q`.
    #[pyo3(get)]
    coordinates: Py<Coordinates>,
    /// Created at the first access, then shared.
    q: PyOnceLock<Py<PyArray1<f64>>>,
}

impl Solution {
    pub(crate) fn new(inner: kinopt::Solution, coordinates: Py<Coordinates>) -> Self {
        Self {
            inner,
            coordinates,
            q: PyOnceLock::new(),
        }
    }
}

#[pymethods]
impl Solution {
    /// The configuration, shape (nq,), radians and metres, exactly within all limits.
    ///
    /// Always the same read-only array: copy it before changing it.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let array = self.q.get_or_try_init(py, || {
            let array = arrays::list(py, &self.inner.q);
            arrays::freeze(&array)?;
            PyResult::Ok(array.unbind())
        })?;
        Ok(array.bind(py).clone())
    }

    /// True if every required task is within its tolerances at `q`, and `q` is collision-free (`collisions`).
    #[getter]
    fn reached(&self) -> bool {
        self.inner.reached
    }

    /// Largest position error of a required task in metres (for rigs, the rig's unit); None if no required task
    /// measures it.
    #[getter]
    fn position_error(&self) -> Option<f64> {
        self.inner.position_error()
    }

    /// Largest orientation error of a required task in radians; None if no required task measures it.
    #[getter]
    fn orientation_error(&self) -> Option<f64> {
        self.inner.orientation_error()
    }

    /// Test that ended the returned attempt, or that ended the whole search early: "reached", "stationary",
    /// "small_step", "stalled", "iteration_limit", "time_limit", "cannot_continue", "cancelled" or "non_finite".
    #[getter]
    fn termination(&self) -> &'static str {
        self.inner.termination.name()
    }

    /// Half the sum of the squared weighted residuals at `q`, of required and soft tasks.
    #[getter]
    fn cost(&self) -> f64 {
        self.inner.cost
    }

    /// Largest slope of the cost along a free variable at `q`; None if the required tasks were reached first.
    #[getter]
    fn projected_gradient(&self) -> Option<f64> {
        self.inner.projected_gradient
    }

    /// Iterations of all attempts together.
    #[getter]
    fn iterations(&self) -> usize {
        self.inner.iterations
    }

    /// Number of attempts, including the one from the given start.
    #[getter]
    fn attempts(&self) -> usize {
        self.inner.attempts
    }

    /// Number of attempts that stopped at an equally low cost. It is 0 if the solution is reached, if the search was
    /// interrupted, or if attempts are not compared. A large number suggests that a target is unreachable, but does not
    /// prove it.
    #[getter]
    fn agreeing(&self) -> usize {
        self.inner.agreeing
    }

    /// Evaluations of all attempts together.
    #[getter]
    fn counts(&self) -> Counts {
        self.inner.counts.into()
    }

    /// Report of each task, in the order of the problem, then of the model's loops.
    #[getter]
    fn tasks(&self) -> Vec<TaskReport> {
        self.inner.tasks().map(TaskReport::from).collect()
    }

    /// Active limits of the solution; empty when it is reached.
    #[getter]
    fn active_limits(&self) -> Vec<ActiveLimit> {
        self.inner.active_limits().map(ActiveLimit::from).collect()
    }

    /// Pairs nearer to each other at `q` than the margin, the deepest first. Without any, if the step to a better
    /// configuration is not proven collision-free, the pair that blocks it (`on_the_way`). Empty for a reached solution
    /// and without a world or margin.
    #[getter]
    fn collisions(&self) -> Vec<Collision> {
        let pairs = self.inner.collisions().iter().cloned();
        pairs.map(Collision::from).collect()
    }

    /// True if every required task is within its tolerances at `q`, even if a pair is in collision.
    #[getter]
    fn goals_reached(&self) -> bool {
        self.inner.goals_reached()
    }

    /// True if every loop of the model is closed at `q`, to 1e-9 m and rad, and for a model without loops. A reached
    /// solution closes all loops.
    #[getter]
    fn loops_closed(&self) -> bool {
        self.inner.loops_closed()
    }

    /// Open loops at `q`: tuples of the name, the closure error in metres, and the angle in radians, 0 for a "connect".
    #[getter]
    fn open_loops(&self) -> Vec<(&str, f64, f64)> {
        let open = self.inner.open_loops();
        open.map(|open| (open.name, open.gap, open.angle)).collect()
    }

    /// True if a missed target is proven unreachable: its distance from the start of the chain exceeds the length of
    /// the chain. False if unknown.
    #[getter]
    fn is_out_of_reach(&self) -> bool {
        self.inner.is_out_of_reach()
    }

    /// Names of the soft tasks that prevent a missed required task from coming nearer, the strongest first. Only
    /// "traded" preferences can do so.
    #[getter]
    fn pulling_preferences(&self) -> Vec<&str> {
        self.inner.pulling_preferences().collect()
    }

    /// Text with the missed tasks and their errors, the active limits, and the reason for the end of the search.
    fn explain(&self) -> String {
        self.inner.explain()
    }

    /// Draws each joint's value within its limits, with active limits marked: a matplotlib `Figure`.
    ///
    /// `figure`: a `Figure` or `SubFigure` to draw into, by default a new one. Raises `ImportError` without matplotlib,
    /// which the extra `plot` installs.
    #[pyo3(signature = (*, figure = None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        figure: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        in_python::call("plot_solution", "kinopt.plots", slf, &[("figure", figure)])
    }

    fn _repr_html_<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyAny>> {
        in_python::call("solution_page", "kinopt.plots.html", slf, &[])
    }

    #[classmethod]
    fn _rebuild(
        _class: &Bound<'_, PyType>,
        text: &str,
        coordinates: Py<Coordinates>,
    ) -> PyResult<Self> {
        let inner: kinopt::Solution = serde_json::from_str(text).or_raise()?;
        Ok(Self::new(inner, coordinates))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let json = serde_json::to_string(&self.inner).or_raise()?;
        pickling::by_rebuild::<Self>(py, (json, self.coordinates.clone_ref(py)))
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
