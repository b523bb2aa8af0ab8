//! Goal sets of several arms.

use pyo3::prelude::*;

use super::Arm;
use super::goal_set::{GoalSetSolution, solve};
use crate::error::invalid;

/// Solves every target for every arm in one call, and ranks the reached ones.
///
/// `arms` may be those of one robot with several tools or goal bounds, or the two arms of a robot; each has its own
/// obstacles. `targets`, shape (N, 4, 4) or as in `Arm.solve_batch`, are tool placements in each arm's base. `starts` has one
/// configuration for each arm; None is `default_start`. `criterion` is "distance" from the start, "manipulability",
/// "clearance", or a function of (arm index, q of shape (K, dof)) that returns K costs. Targets that are easily proven to be out of reach are not
/// searched for. `threads` as in `solve_batch`.
///
/// Raises `InvalidValueError` as `Arm.solve_batch` does, and `UnknownNameError` for an unknown criterion.
#[pyfunction]
#[pyo3(
    signature = (arms, targets, starts = None, *, criterion = None, threads = 1),
    text_signature = "(arms, targets, starts=None, *, criterion='distance', threads=1)"
)]
pub(crate) fn solve_goals(
    py: Python<'_>,
    arms: Vec<PyRef<'_, Arm>>,
    targets: &Bound<'_, PyAny>,
    starts: Option<Vec<Bound<'_, PyAny>>>,
    criterion: Option<&Bound<'_, PyAny>>,
    #[pyo3(from_py_with = crate::arrays::whole_or_none)] threads: Option<usize>,
) -> PyResult<GoalSetSolution> {
    let starts: PyResult<Vec<Vec<f64>>> = match starts {
        None => arms.iter().map(|arm| arm.start(None)).collect(),
        Some(starts) if starts.len() == arms.len() => {
            let pairs = arms.iter().zip(&starts);
            pairs.map(|(arm, start)| arm.start(Some(start))).collect()
        }
        Some(starts) => Err(invalid(format!(
            "{} starts for {} arms: expected one start for each arm",
            starts.len(),
            arms.len()
        ))),
    };
    let arms = arms.iter().map(|arm| arm.inner.as_ref().clone()).collect();
    solve(py, arms, targets, starts?, criterion, threads)
}
