//! Branch side of a stretched arm.
//!
//! The closest pose to a target out of reach is singular. Two branches meet there, such as elbow up and elbow down, and
//! q does not show the arm's branch. [`SingularityBranch`] therefore stores the direction back to it. Along it the tool is
//! stationary to first order, and moves away from the target to second order (r · ∂²r > 0). While the target is not
//! reached, the direction is carried along, and each step begins slightly on that side.

use nalgebra::Vector6;

use super::arm::Arm;
use super::workspace::ArmWorkspace;

/// Tool motion below which a carried direction counts as null space, as a fraction of the longest Jacobian column.
const BLUNT: f64 = 0.05;
/// Tool motion below which a corrected direction counts as null space, as a fraction of the longest Jacobian column.
const SHARP: f64 = 0.01;
/// Smallest fraction of a direction that must be in the null space.
const LEAST_SHARE: f64 = 0.5;
/// Smallest growth of the error along a new direction, as a fraction of the error times the longest column.
const LEAST_BEND: f64 = 0.02;
/// Step of a central difference, radians.
const PROBE: f64 = 1e-3;
/// Number of corrections of a new direction; a carried one takes one.
const ROUNDS: usize = 3;
/// Joint motion after which a configuration is recorded, radians.
const STRIDE: f64 = 0.1;

/// Direction in joint space back to the arm's branch, radians (prismatic joints by the metres that weigh as much).
///
/// Its length is 1 while the target is not reached, and shrinks as the arm leaves the singularity.
#[derive(Clone, Debug)]
pub(super) struct SingularityBranch {
    way: Vec<f64>,
    known: bool,
    /// Configuration recorded last.
    lately: Vec<f64>,
    /// Configuration recorded before that, a stride of one joint away.
    earlier: Vec<f64>,
}

impl SingularityBranch {
    pub(super) fn unknown(start: &[f64]) -> Self {
        Self {
            way: vec![0.0; start.len()],
            known: false,
            lately: start.to_vec(),
            earlier: start.to_vec(),
        }
    }

    pub(super) fn is_known(&self) -> bool {
        self.known
    }

    /// Restarts at a configuration after a jump.
    pub(super) fn begin(&mut self, q: &[f64]) {
        self.known = false;
        self.lately.copy_from_slice(q);
        self.earlier.copy_from_slice(q);
    }

    /// Records a configuration that reached its target, if a joint has moved far enough.
    pub(super) fn note(&mut self, arm: &Arm, q: &[f64]) {
        if arm.longest_move(&self.lately, q).1 > STRIDE {
            std::mem::swap(&mut self.earlier, &mut self.lately);
            self.lately.copy_from_slice(q);
        }
    }

    /// Removes the component along this direction from a motion, radians.
    pub(super) fn take_from(&self, motion: &mut [f64]) {
        let along: f64 = motion.iter().zip(&self.way).map(|(a, b)| a * b).sum();
        for (by, way) in motion.iter_mut().zip(&self.way) {
            *by -= along * way;
        }
    }

    /// Moves the workspace's x to this side by `offset` radians, within the bounds.
    pub(super) fn lean(&self, workspace: &mut ArmWorkspace, offset: f64) {
        if self.known {
            for (projected, way) in workspace.projected.iter_mut().zip(&self.way) {
                *projected = offset * way;
            }
            workspace.go_by_projected();
        }
    }

    /// Carries the direction to the workspace's x, or finds it there from an earlier configuration.
    ///
    /// It is found when a target is not reached, and lost when it is no longer in the null space.
    pub(super) fn carry_on(
        &mut self,
        arm: &Arm,
        workspace: &mut ArmWorkspace,
        ease: &[f64],
        missed: bool,
    ) {
        if !(self.known || missed) {
            return;
        }
        let x = std::mem::take(&mut workspace.x);
        let residual = Vector6::from(workspace.linearise(&x));
        if !self.known {
            let before = match arm.has_freedom() {
                true => ease,
                false => &self.earlier,
            };
            for (i, way) in self.way.iter_mut().enumerate() {
                *way = (before[i] - x[i]) * arm.scale[i];
            }
            normalise(&mut self.way);
        }
        let carried = self.known;
        self.known = self.turn_into_null(workspace, &x, BLUNT);
        if self.known && missed {
            let rounds = if carried { 1 } else { ROUNDS };
            let mut bend = 0.0;
            for _ in 0..rounds {
                bend = self.turn_where_it_bends(workspace, &x, &residual);
            }
            self.known = carried || bend > LEAST_BEND;
            // At a stretched configuration the carried side is the arm's. Null-space motion may lead far from the
            // nominal posture there.
            if arm.has_freedom() && !(carried && bend > LEAST_BEND) {
                self.turn_to(arm, &x, ease);
            }
        }
        workspace.x = x;
    }

    /// Points the direction to the side of the nominal posture, for a redundant arm.
    fn turn_to(&mut self, arm: &Arm, x: &[f64], ease: &[f64]) {
        let ways = self.way.iter().zip(ease).zip(x).zip(&arm.scale);
        let along: f64 = ways
            .map(|(((way, ease), x), scale)| way * (ease - x) * scale)
            .sum();
        for way in &mut self.way {
            *way *= 1.0_f64.copysign(along);
        }
    }

    /// Projects the direction into the null space at x. Returns true if most of it remains.
    ///
    /// The workspace must hold the Jacobian at x. Little remains of joints that limits hold, as no free joint
    /// compensates for them.
    fn turn_into_null(&mut self, workspace: &mut ArmWorkspace, x: &[f64], blunt: f64) -> bool {
        let blunt = blunt * workspace.longest_column();
        workspace.project_to_null(x, &self.way, blunt);
        self.way.copy_from_slice(&workspace.projected);
        length(&self.way) > LEAST_SHARE
    }

    /// Corrects the direction within the null space towards growth of the error, by a step of the power method on r ·
    /// ∂²r.
    ///
    /// Returns the growth along the previous direction, as a fraction of the error times the longest column. Without
    /// growth the direction stays.
    fn turn_where_it_bends(
        &mut self,
        workspace: &mut ArmWorkspace,
        x: &[f64],
        residual: &Vector6<f64>,
    ) -> f64 {
        let scale = residual.norm() * workspace.longest_column();
        let mut bend = std::mem::take(&mut workspace.wanted);
        let mut trial = std::mem::take(&mut workspace.trial);
        bend.fill(0.0);
        // The Jacobian at x is needed again: swap it out.
        std::mem::swap(&mut workspace.jacobian, &mut workspace.aside);
        for side in [PROBE, -PROBE] {
            for (i, trial) in trial.iter_mut().enumerate() {
                *trial = x[i] + side * self.way[i] / workspace.scale[i];
            }
            workspace.differentiate_beside(&trial);
            for (i, bend) in bend.iter_mut().enumerate() {
                *bend += workspace.column(i).dot(residual) / (2.0 * side);
            }
        }
        std::mem::swap(&mut workspace.jacobian, &mut workspace.aside);
        let along: f64 = self.way.iter().zip(&bend).map(|(a, b)| a * b).sum();
        let square = self.way.iter().map(|by| by * by).sum::<f64>();
        let bends = along / (square * scale);
        if bends > 0.0 {
            normalise(&mut bend);
            std::mem::swap(&mut self.way, &mut bend);
            self.turn_into_null(workspace, x, SHARP);
            normalise(&mut self.way);
        }
        workspace.wanted = bend;
        workspace.trial = trial;
        bends
    }
}

/// Scales a direction to length 1; zero stays.
fn normalise(way: &mut [f64]) {
    let length = length(way);
    if length > 0.0 {
        for by in way {
            *by /= length;
        }
    }
}

fn length(way: &[f64]) -> f64 {
    way.iter().map(|by| by * by).sum::<f64>().sqrt()
}
