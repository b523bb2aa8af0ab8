//! Solution of least penetration, for queries without a collision-free one.

use super::avoidance::CollisionAvoidance;
use super::checks::MAX_EXACT_CHECKS;
use super::workspace::CollisionWorkspace;
use crate::arm::QueryError;
use crate::arm::arm::Arm;
use crate::arm::query::Query;
use crate::arm::workspace::ArmWorkspace;

/// Moves the workspace's x to the solution found with the least penetration, as far as time allows; x itself
/// included.
///
/// Returns the distance of its worst pair, metres.
pub(super) fn move_to_min_penetration(
    arm: &Arm,
    avoidance: &CollisionAvoidance,
    workspace: &mut ArmWorkspace,
    checks: &mut CollisionWorkspace,
    query: &Query<'_>,
) -> Result<f64, QueryError> {
    let mut best = avoidance.min_distance(arm, checks, &workspace.x)?;
    for rank in 0..workspace.ranking.len().min(MAX_EXACT_CHECKS) {
        if avoidance.is_late(query, 1) {
            break;
        }
        let index = workspace.ranking[rank].1;
        let distance = avoidance.min_distance(arm, checks, workspace.attempt_end(index))?;
        if distance > best {
            best = distance;
            workspace.move_to_attempt_end(index);
        }
    }
    Ok(best)
}
