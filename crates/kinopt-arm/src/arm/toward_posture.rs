//! Null-space motion of a solution towards a wanted configuration.
//!
//! Minimises ‖W(q − q_wanted)‖ subject to the pose and the bounds, by successive projection. The pose is linearised at
//! q, and the wanted configuration is projected onto the linearised pose within the bounds. A step towards the
//! projection is corrected to the tolerance by the same projection of itself. The projection is
//! `z(y) = clamp(z_wanted + Jᵀy)` with six multipliers y, found by a semismooth Newton iteration (Li & Li 2011,
//! "Projections onto a box and hyperplanes").

use super::distances::weighted_distance;
use nalgebra::{Matrix6, Vector6};

use super::arm::Arm;
use super::workspace::{ArmWorkspace, Errors};
use kinopt_kinematics::clock::{Instant, is_past};

/// Largest number of steps towards the wanted configuration.
const MAX_STEPS: usize = 40;
/// Largest number of halvings of a step that does not come nearer.
const HALVINGS: usize = 5;
/// Largest number of corrections to the pose after a step.
const CORRECTIONS: usize = 6;
/// Longest step of one joint, radians or metres.
const MAX_JOINT_STEP: f64 = 0.4;
/// Relative approach below which a step is the last.
const MIN_RELATIVE_APPROACH: f64 = 1e-7;

/// Moves the workspace's x, which reaches its target, towards `posture`.
///
/// It stays within the tolerances and the bounds, and never ends farther away.
pub(super) fn move_towards_posture(
    arm: &Arm,
    workspace: &mut ArmWorkspace,
    posture: &[f64],
    deadline: Option<Instant>,
) {
    let mut distance = weighted_distance(arm, &workspace.x, posture);
    for _ in 0..MAX_STEPS {
        if is_past(deadline) {
            return;
        }
        let x = std::mem::take(&mut workspace.x);
        let residual = workspace.linearise(&x);
        workspace.projected.copy_from_slice(posture);
        project(arm, workspace, &x, &residual);
        let direction: &mut Vec<f64> = &mut workspace.gradient;
        for ((direction, x), projected) in direction.iter_mut().zip(&x).zip(&workspace.projected) {
            *direction = projected - x;
        }
        let max_step = direction.iter().fold(0.0_f64, |max_component, component| {
            max_component.max(component.abs())
        });
        let mut fraction = (MAX_JOINT_STEP / max_step).min(1.0);
        let mut nearer_distance = None;
        for _ in 0..HALVINGS {
            for (i, trial) in workspace.trial.iter_mut().enumerate() {
                let moved = x[i] + fraction * workspace.gradient[i];
                *trial = workspace.question.clamp(i, moved);
            }
            if correct(arm, workspace) {
                let new_distance = weighted_distance(arm, &workspace.trial, posture);
                if new_distance < distance {
                    nearer_distance = Some(new_distance);
                    break;
                }
            }
            fraction *= 0.5;
        }
        workspace.x = x;
        let Some(new_distance) = nearer_distance else {
            return;
        };
        workspace.x.copy_from_slice(&workspace.trial);
        let is_worthwhile = new_distance < distance * (1.0 - MIN_RELATIVE_APPROACH);
        distance = new_distance;
        if !is_worthwhile {
            return;
        }
    }
}

/// Corrects the workspace's trial to the pose. Returns true if it reaches the pose.
fn correct(arm: &Arm, workspace: &mut ArmWorkspace) -> bool {
    for _ in 0..CORRECTIONS {
        let trial = std::mem::take(&mut workspace.trial);
        let errors = workspace.judge(&trial);
        if errors.reached {
            workspace.trial = trial;
            return true;
        }
        let residual = workspace.linearise(&trial);
        workspace.projected.copy_from_slice(&trial);
        project(arm, workspace, &trial, &residual);
        workspace.trial = trial;
        let ArmWorkspace {
            trial, projected, ..
        } = workspace;
        trial.copy_from_slice(projected);
    }
    let trial = std::mem::take(&mut workspace.trial);
    let Errors { reached, .. } = workspace.judge(&trial);
    workspace.trial = trial;
    reached
}

/// Projects the workspace's `projected` onto the bounds and the pose linearised at x.
///
/// `residual` is the residual at x; the workspace must hold the Jacobian.
fn project(arm: &Arm, workspace: &mut ArmWorkspace, x: &[f64], residual: &[f64; 6]) {
    let weights = &arm.options.weights;
    let n = x.len();
    let mut y = Vector6::<f64>::zeros();
    let unprojected = &mut workspace.scratch_motion;
    workspace.projected.clone_into(unprojected);
    let column = |i: usize| -> Vector6<f64> { workspace.jacobian.fixed_view::<6, 1>(0, i).into() };
    for _ in 0..12 {
        let mut pose_residual = Vector6::from(*residual);
        let mut normal = Matrix6::<f64>::zeros();
        for i in 0..n {
            let column = column(i);
            // In z = w q the column is J/w; in q the step of the multiplier is J y / w².
            let inverse = 1.0 / (weights[i] * weights[i]);
            let unclamped = unprojected[i] + column.dot(&y) * inverse;
            let clamped = workspace.question.clamp(i, unclamped);
            workspace.projected[i] = clamped;
            pose_residual += column * (clamped - x[i]);
            if clamped == unclamped {
                normal += column * column.transpose() * inverse;
            }
        }
        let scale = normal.trace();
        if scale.is_nan() || scale <= 0.0 || pose_residual.norm() <= 1e-14 * (1.0 + scale.sqrt()) {
            return;
        }
        for k in 0..6 {
            normal[(k, k)] += 1e-12 * scale;
        }
        let Some(factor) = normal.cholesky() else {
            return;
        };
        y -= factor.solve(&pose_residual);
    }
}
