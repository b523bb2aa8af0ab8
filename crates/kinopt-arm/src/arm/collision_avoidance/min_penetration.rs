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
    let mut best = match &checks.contacts {
        Some(contacts) => contacts.first().map_or(f64::INFINITY, |pair| pair.distance),
        None => check_solution(arm, avoidance, workspace, checks)?,
    };
    for rank in 0..workspace.ranking.len().min(MAX_EXACT_CHECKS) {
        if avoidance.is_late(query) {
            break;
        }
        let index = workspace.ranking[rank].1;
        let distance = avoidance.min_distance(arm, checks, workspace.attempt_end(index))?;
        if distance > best {
            best = distance;
            checks.contacts = checks.trial_contacts.take();
            workspace.move_to_attempt_end(index);
        }
    }
    Ok(best)
}

/// Checks all pairs at the workspace's x, unless time is over. Returns the distance of the worst pair, metres.
pub(super) fn check_solution(
    arm: &Arm,
    avoidance: &CollisionAvoidance,
    workspace: &ArmWorkspace,
    checks: &mut CollisionWorkspace,
) -> Result<f64, QueryError> {
    let distance = avoidance.min_distance(arm, checks, &workspace.x)?;
    checks.contacts = checks.trial_contacts.take();
    Ok(distance)
}
