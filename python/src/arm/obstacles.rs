//! Arms that avoid collisions.

use kinopt::collision::Checker;
use pyo3::prelude::*;

use crate::error::OrRaise;
use crate::world::World;

/// Returns the arm with collision avoidance of a checker, if there is one. `held` is a configuration of the whole model
/// with the values of joints outside the arm; default neutral.
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

/// Returns the arm with another world.
pub(super) fn moved(
    arm: &kinopt::Arm,
    world: &Bound<'_, World>,
    margin: Option<f64>,
) -> PyResult<kinopt::Arm> {
    let inner = arm.with_world(&world.get().snapshot(), margin).or_raise()?;
    Ok(inner)
}
