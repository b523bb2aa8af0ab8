//! Collision checks of many configurations, eight per pass in SIMD lanes.

use super::checks::with_collision_workspace;
use crate::arm::arm::Arm;
use crate::arm::query::Query;
use crate::arm::workspace::ArmWorkspace;
use crate::arm::{PoseOutcome, QueryError};
use crate::simd_spheres::CHECKED;

/// Marks attempts in collision as not reached.
pub(in crate::arm) fn reject_collisions(
    arm: &Arm,
    q: &[f64],
    outcomes: &mut [PoseOutcome],
) -> Result<(), QueryError> {
    for_each_colliding(arm, q, true, |index| outcomes[index].reached = false)
}

/// Visits the indices of the configurations that are not proven free by spheres, nor, if `by_shapes`, by the exact
/// check.
pub(super) fn for_each_colliding(
    arm: &Arm,
    q: &[f64],
    by_shapes: bool,
    mut visit: impl FnMut(usize),
) -> Result<(), QueryError> {
    let Some(avoidance) = &arm.collisions else {
        return Ok(());
    };
    with_collision_workspace(arm, avoidance, |_, checks| {
        let n = arm.joint_count();
        for (group, configurations) in q.chunks(CHECKED * n).enumerate() {
            let by_spheres = avoidance.free_by_spheres(arm, checks, configurations)?;
            for (lane, q) in configurations.chunks_exact(n).enumerate() {
                let is_free = match by_spheres >> lane & 1 != 0 {
                    true => avoidance.are_close_pairs_free(arm, checks, q)?,
                    false => by_shapes && avoidance.is_free_by_shapes(arm, checks, q)?,
                };
                if !is_free {
                    visit(group * CHECKED + lane);
                }
            }
        }
        Ok(())
    })
}

/// Returns true if a configuration is collision-free, and always without a checker; `None` if there is no time for the
/// check.
pub(in crate::arm) fn is_clear(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
    q: &[f64],
) -> Result<Option<bool>, QueryError> {
    let Some(avoidance) = &arm.collisions else {
        return Ok(Some(true));
    };
    if avoidance.is_late(query) {
        return Ok(None);
    }
    let mut stored = workspace.collision_workspace.take();
    let checks = stored.get_or_insert_with(|| avoidance.workspace());
    checks.deadline = query.deadline;
    let is_clear = avoidance.is_clear(arm, checks, q);
    checks.deadline = None;
    workspace.collision_workspace = stored;
    // A check that the deadline cut short proves nothing.
    Ok(Some(is_clear?).filter(|&clear| clear || !query.is_late()))
}

/// Removes solutions in collision from the workspace's order, and those for whose check there is no time.
///
/// Returns true if all were checked.
pub(in crate::arm) fn drop_colliding(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    query: &Query<'_>,
) -> Result<bool, QueryError> {
    let Some(avoidance) = &arm.collisions else {
        return Ok(true);
    };
    let mut stored = workspace.collision_workspace.take();
    let checks = stored.get_or_insert_with(|| avoidance.workspace());
    checks.deadline = query.deadline;
    let mut ranking = std::mem::take(&mut workspace.ranking);
    let mut free = Vec::with_capacity(ranking.len());
    let mut all_checked = true;
    for (distance, index) in ranking.drain(..) {
        if avoidance.is_late(query) {
            all_checked = false;
            break;
        }
        if avoidance.is_clear(arm, checks, workspace.attempt_end(index))? {
            free.push((distance, index));
        }
    }
    all_checked &= !query.is_late();
    checks.deadline = None;
    workspace.ranking = free;
    workspace.collision_workspace = stored;
    Ok(all_checked)
}
