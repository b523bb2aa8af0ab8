//! Arms that keep clear of a world.

use kinopt::collision::Checker;
use pyo3::prelude::*;

use crate::error::OrRaise;
use crate::world::World;

/// The arm kept clear of what a checker has, if there is one; `held` is where the joints stand that are not the arm's, a
/// configuration of the whole model, or the neutral one.
pub(super) fn keep_clear(
    arm: kinopt::Arm,
    checker: Option<&Checker>,
    held: Option<Vec<f64>>,
) -> PyResult<kinopt::Arm> {
    let Some(checker) = checker else {
        return Ok(arm);
    };
    let rest = held.unwrap_or_else(|| checker.model().model().neutral());
    arm.with_checker(checker, &rest).or_raise()
}

/// The same arm in another world.
pub(super) fn moved(
    arm: &kinopt::Arm,
    world: &Bound<'_, World>,
    margin: Option<f64>,
) -> PyResult<kinopt::Arm> {
    let moved = arm.with_world(&world.get().snapshot(), margin).or_raise()?;
    Ok(moved)
}
