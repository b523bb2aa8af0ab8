//! Argument checks of the SIMD solver.

use super::chain::is_rigid;
use super::options::{LaneError, PoseOutcome};
use kinopt_kinematics::spatial::Placement;

/// Checks the slice lengths and the queries of a batch, for a chain of `joints` joints.
pub(crate) fn batch(
    joints: usize,
    targets: &[Placement<f64>],
    starts: &[f64],
    q: &[f64],
    outcomes: &[PoseOutcome],
) -> Result<(), LaneError> {
    length("starts", starts.len(), joints * targets.len())?;
    length("q", q.len(), joints * targets.len())?;
    length("outcomes", outcomes.len(), targets.len())?;
    for (index, (target, start)) in targets.iter().zip(starts.chunks_exact(joints)).enumerate() {
        query(index, target, start)?;
    }
    Ok(())
}

/// Returns an error unless a slice has the expected length.
pub(crate) fn length(what: &'static str, given: usize, expected: usize) -> Result<(), LaneError> {
    if given == expected {
        Ok(())
    } else {
        Err(LaneError::Length {
            what,
            found: given,
            expected,
        })
    }
}

/// Checks that the start is finite and the target rigid.
pub(crate) fn query(index: usize, target: &Placement<f64>, start: &[f64]) -> Result<(), LaneError> {
    if !start.iter().all(|value| value.is_finite()) {
        return Err(LaneError::Start(index));
    }
    if !is_rigid(target) {
        return Err(LaneError::Target(index));
    }
    Ok(())
}
