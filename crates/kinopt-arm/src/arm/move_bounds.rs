//! Joint bounds of one query: the limits, or narrower for bounded motions.

use super::arm::Arm;
use super::workspace::ArmWorkspace;
use kinopt_solver::search::within;

/// Sets the workspace's bounds and its start, clamped to the limits.
pub(super) fn bound_moves(arm: &Arm, workspace: &mut ArmWorkspace, start: &[f64]) {
    set_start(arm, workspace, start);
    match &arm.options.max_move {
        Some(max_move) => {
            narrow(arm, workspace, |i| max_move[i]);
            if let Some(simd_solver) = &arm.simd_solver {
                workspace
                    .bounded_simd_solver
                    .get_or_insert_with(|| simd_solver.without_atlas())
                    .set_bounds(&workspace.question.lower, &workspace.question.upper);
            }
        }
        None => narrow(arm, workspace, |_| f64::INFINITY),
    }
}

/// Sets the workspace's bounds to the limits; the start stays.
pub(super) fn bound_by_limits(arm: &Arm, workspace: &mut ArmWorkspace) {
    let (question, map) = (&mut workspace.question, &arm.serial.map);
    question.lower.copy_from_slice(map.lower());
    question.upper.copy_from_slice(map.upper());
}

/// Sets bounds and start as [`bound_moves`] does, for a step of at most `radians` per joint.
///
/// Prismatic joints count by the metres that weigh as much.
pub(super) fn bound_step(arm: &Arm, workspace: &mut ArmWorkspace, start: &[f64], radians: f64) {
    bound_moves(arm, workspace, start);
    let max_move = arm.options.max_move.as_deref();
    let joint_max_move = |i: usize| max_move.map_or(f64::INFINITY, |max_move| max_move[i]);
    narrow(arm, workspace, |i| {
        (radians / arm.scale[i]).min(joint_max_move(i))
    });
}

fn set_start(arm: &Arm, workspace: &mut ArmWorkspace, start: &[f64]) {
    let map = &arm.serial.map;
    for (i, value) in workspace.start.iter_mut().enumerate() {
        *value = start[i].max(map.lower()[i]).min(map.upper()[i]);
    }
}

/// Sets the query's bounds to `max_move` from the workspace's start, per joint, within the limits.
fn narrow(arm: &Arm, workspace: &mut ArmWorkspace, max_move: impl Fn(usize) -> f64) {
    let map = &arm.serial.map;
    for i in 0..arm.joint_count() {
        let (start, max_move) = (workspace.start[i], max_move(i));
        workspace.question.lower[i] = map.lower()[i].max(within(start, -max_move));
        workspace.question.upper[i] = map.upper()[i].min(within(start, max_move));
    }
}
