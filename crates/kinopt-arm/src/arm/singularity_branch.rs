//! Branch side of a stretched arm.
//!
//! The closest pose to a target out of reach is singular. Two branches meet there, such as elbow up and elbow down, and
//! q does not show the arm's branch. [`SingularityBranch`] therefore stores the direction back to it. Along it the tool is
//! stationary to first order, and moves away from the target to second order (r · ∂²r > 0). While the target is not
//! reached, the direction is carried along, and each step begins slightly on that side.

use super::distances::largest_joint_move;
use nalgebra::Vector6;

use super::arm::Arm;
use super::workspace::ArmWorkspace;

/// Tool motion below which a carried direction counts as null space, as a fraction of the longest Jacobian column.
const CARRIED_TOLERANCE: f64 = 0.05;
/// Tool motion below which a corrected direction counts as null space, as a fraction of the longest Jacobian column.
const CORRECTED_TOLERANCE: f64 = 0.01;
/// Smallest fraction of a direction that must be in the null space.
const MIN_NULL_SPACE_FRACTION: f64 = 0.5;
/// Smallest growth of the error along a new direction, as a fraction of the error times the longest column.
const MIN_ERROR_GROWTH: f64 = 0.02;
/// Step of a central difference, radians.
const PROBE_STEP: f64 = 1e-3;
/// Number of corrections of a new direction; a carried one takes one.
const CORRECTIONS: usize = 3;
/// Joint motion after which a configuration is recorded, radians.
const RECORDING_DISTANCE: f64 = 0.1;

/// Direction in joint space back to the arm's branch, radians (prismatic joints by the metres that weigh as much).
///
/// Its length is 1 while the target is not reached, and shrinks as the arm leaves the singularity.
#[derive(Clone, Debug)]
pub(super) struct SingularityBranch {
    direction: Vec<f64>,
    known: bool,
    /// Configuration recorded last.
    last_recorded: Vec<f64>,
    /// Configuration recorded before that, a stride of one joint away.
    previous_recorded: Vec<f64>,
}

impl SingularityBranch {
    pub(super) fn unknown(start: &[f64]) -> Self {
        Self {
            direction: vec![0.0; start.len()],
            known: false,
            last_recorded: start.to_vec(),
            previous_recorded: start.to_vec(),
        }
    }

    pub(super) fn is_known(&self) -> bool {
        self.known
    }

    /// Restarts at a configuration after a jump.
    pub(super) fn begin(&mut self, q: &[f64]) {
        self.known = false;
        self.last_recorded.copy_from_slice(q);
        self.previous_recorded.copy_from_slice(q);
    }

    /// Records a configuration that reached its target, if a joint has moved far enough.
    pub(super) fn record(&mut self, arm: &Arm, q: &[f64]) {
        if largest_joint_move(arm, &self.last_recorded, q).1 > RECORDING_DISTANCE {
            std::mem::swap(&mut self.previous_recorded, &mut self.last_recorded);
            self.last_recorded.copy_from_slice(q);
        }
    }

    /// Removes the component along this direction from a motion, radians.
    pub(super) fn remove_from(&self, motion: &mut [f64]) {
        let along: f64 = motion.iter().zip(&self.direction).map(|(a, b)| a * b).sum();
        for (joint_motion, direction) in motion.iter_mut().zip(&self.direction) {
            *joint_motion -= along * direction;
        }
    }

    /// Moves the workspace's x to this side by `offset` radians, within the bounds.
    pub(super) fn offset_to_side(&self, workspace: &mut ArmWorkspace, offset: f64) {
        if self.known {
            for (projected, direction) in workspace.projected.iter_mut().zip(&self.direction) {
                *projected = offset * direction;
            }
            workspace.apply_projected();
        }
    }

    /// Carries the direction to the workspace's x, or finds it there from an earlier configuration.
    ///
    /// It is found when a target is not reached, and lost when it is no longer in the null space.
    pub(super) fn update(
        &mut self,
        arm: &Arm,
        workspace: &mut ArmWorkspace,
        nominal_posture: &[f64],
        is_unreached: bool,
    ) {
        if !(self.known || is_unreached) {
            return;
        }
        let x = std::mem::take(&mut workspace.x);
        let residual = Vector6::from(workspace.linearise(&x));
        if !self.known {
            let reference = match arm.has_null_space() {
                true => nominal_posture,
                false => &self.previous_recorded,
            };
            for (i, direction) in self.direction.iter_mut().enumerate() {
                *direction = (reference[i] - x[i]) * arm.scale[i];
            }
            normalise(&mut self.direction);
        }
        let was_known = self.known;
        self.known = self.project_into_null_space(workspace, &x, CARRIED_TOLERANCE);
        if self.known && is_unreached {
            let corrections = if was_known { 1 } else { CORRECTIONS };
            let mut growth = 0.0;
            for _ in 0..corrections {
                growth = self.correct_by_curvature(workspace, &x, &residual);
            }
            self.known = was_known || growth > MIN_ERROR_GROWTH;
            // At a stretched configuration the carried side is the arm's. Null-space motion may lead far from the
            // nominal posture there.
            if arm.has_null_space() && !(was_known && growth > MIN_ERROR_GROWTH) {
                self.orient_to_posture(arm, &x, nominal_posture);
            }
        }
        workspace.x = x;
    }

    /// Points the direction to the side of the nominal posture, for a redundant arm.
    fn orient_to_posture(&mut self, arm: &Arm, x: &[f64], nominal_posture: &[f64]) {
        let directions = self
            .direction
            .iter()
            .zip(nominal_posture)
            .zip(x)
            .zip(&arm.scale);
        let along: f64 = directions
            .map(|(((direction, nominal_posture), x), scale)| {
                direction * (nominal_posture - x) * scale
            })
            .sum();
        for direction in &mut self.direction {
            *direction *= 1.0_f64.copysign(along);
        }
    }

    /// Projects the direction into the null space at x. Returns true if most of it remains.
    ///
    /// The workspace must hold the Jacobian at x. Little remains of joints that limits hold, as no free joint
    /// compensates for them.
    fn project_into_null_space(
        &mut self,
        workspace: &mut ArmWorkspace,
        x: &[f64],
        tolerance: f64,
    ) -> bool {
        let tolerance = tolerance * workspace.max_column_norm();
        workspace.project_to_null(x, &self.direction, tolerance);
        self.direction.copy_from_slice(&workspace.projected);
        length(&self.direction) > MIN_NULL_SPACE_FRACTION
    }

    /// Corrects the direction within the null space towards growth of the error, by a step of the power method on r ·
    /// ∂²r.
    ///
    /// Returns the growth along the previous direction, as a fraction of the error times the longest column. Without
    /// growth the direction stays.
    fn correct_by_curvature(
        &mut self,
        workspace: &mut ArmWorkspace,
        x: &[f64],
        residual: &Vector6<f64>,
    ) -> f64 {
        let scale = residual.norm() * workspace.max_column_norm();
        let mut curvature = std::mem::take(&mut workspace.scratch_motion);
        let mut trial = std::mem::take(&mut workspace.trial);
        curvature.fill(0.0);
        // The Jacobian at x is needed again: swap it out.
        std::mem::swap(&mut workspace.jacobian, &mut workspace.second_jacobian);
        for probe in [PROBE_STEP, -PROBE_STEP] {
            for (i, trial) in trial.iter_mut().enumerate() {
                *trial = x[i] + probe * self.direction[i] / workspace.scale[i];
            }
            workspace.overwrite_jacobian(&trial);
            for (i, curvature) in curvature.iter_mut().enumerate() {
                *curvature += workspace.column(i).dot(residual) / (2.0 * probe);
            }
        }
        std::mem::swap(&mut workspace.jacobian, &mut workspace.second_jacobian);
        let curvature_along: f64 = self
            .direction
            .iter()
            .zip(&curvature)
            .map(|(a, b)| a * b)
            .sum();
        let squared_length = self
            .direction
            .iter()
            .map(|component| component * component)
            .sum::<f64>();
        let growth = curvature_along / (squared_length * scale);
        if growth > 0.0 {
            normalise(&mut curvature);
            std::mem::swap(&mut self.direction, &mut curvature);
            self.project_into_null_space(workspace, x, CORRECTED_TOLERANCE);
            normalise(&mut self.direction);
        }
        workspace.scratch_motion = curvature;
        workspace.trial = trial;
        growth
    }
}

/// Scales a direction to length 1; zero stays.
fn normalise(direction: &mut [f64]) {
    let length = length(direction);
    if length > 0.0 {
        for component in direction {
            *component /= length;
        }
    }
}

fn length(direction: &[f64]) -> f64 {
    direction
        .iter()
        .map(|component| component * component)
        .sum::<f64>()
        .sqrt()
}
