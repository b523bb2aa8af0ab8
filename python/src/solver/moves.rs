//! Limits of joint displacement from the start of a search.

use kinopt::ik::MoveLimits;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays;
use crate::error::{OrRaise, invalid};
use crate::has_model::model_of;
use crate::problem::{CompiledProblem, Problem};

/// Reads radians for all joints, one number for each of a configuration, or a dict by joint.
pub(super) fn move_limits(
    (problem, compiled): (&Problem, &CompiledProblem),
    max_move: &Bound<'_, PyAny>,
    start: &[f64],
) -> PyResult<MoveLimits> {
    let py = max_move.py();
    if let Ok(radians) = max_move.extract::<f64>() {
        return MoveLimits::by_angle(&compiled.inner, radians, start).or_raise();
    }
    let Ok(by_joint) = max_move.cast::<PyDict>() else {
        let max_moves = arrays::vector(max_move, "max_move")?.to_vec();
        return MoveLimits::new(&compiled.inner, &max_moves, start).or_raise();
    };
    let holder = problem.model(py);
    let model = model_of(holder.bind(py))?;
    let mut max_moves = vec![f64::INFINITY; model.configuration_len()];
    for (name, value) in by_joint.iter() {
        let (name, value): (String, f64) = (name.extract()?, value.extract()?);
        let joint = model.joint(&name).or_raise()?;
        let Some(first) = model.coordinate(joint) else {
            return Err(invalid(format!("max_move: joint `{name}` does not move")));
        };
        let count = model.joints()[joint.index()].kind.coordinates();
        max_moves[first..first + count].fill(value);
    }
    MoveLimits::new(&compiled.inner, &max_moves, start).or_raise()
}
