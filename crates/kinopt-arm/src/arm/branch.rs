//! Branch of a path follower or servo: null-space motion, and the side of a stretched arm.

use super::arm::Arm;
use super::null_space::Factor;
use super::redundancy::{NullSpaceStep, STEP_FRACTION, nominal_posture_from};
use super::singularity_branch::SingularityBranch;
use super::workspace::ArmWorkspace;

/// Factor per step on the null-space motion while a target stays unreached.
///
/// The motion ends if it only approaches the nominal posture, so that the arm comes to rest at the closest pose.
const UNREACHED_DECAY: f64 = 0.9;
/// Remaining fraction at which that motion counts as ended.
const MIN_REMAINING_FRACTION: f64 = 1e-3;
/// Offset of a step's start to the side of a stretched arm, radians; constant, as a growing one makes the arm swing.
const SIDE_OFFSET: f64 = 2e-3;
/// Fraction of a measured stiffness that is kept from step to step.
const STIFFNESS_DECAY: f64 = 0.9;

/// State that a path follower or servo carries from one step to the next.
#[derive(Clone, Debug)]
pub(super) struct Branch {
    /// Nominal posture of the null-space motion.
    nominal_posture: Vec<f64>,
    singularity_branch: SingularityBranch,
    /// True if the last step did not reach its target.
    is_unreached: bool,
    /// True if a step has failed since the arm was last at its nominal posture.
    is_off_posture: bool,
    /// True if the target is that of the last step.
    target_rests: bool,
    /// Remaining fraction of the null-space motion while a target stays unreached, 0 to 1.
    remaining: f64,
    /// Last step of the null-space motion, radians per joint.
    last_motion: Vec<f64>,
    /// Slope at the start of that step, radians per joint.
    last_slope: Vec<f64>,
    /// Stiffness along that step, measured by the change of the slope. Stiffer null spaces take shorter steps.
    stiffness: f64,
}

impl Branch {
    /// Branch of an arm that begins at `start`.
    pub(super) fn begin(arm: &Arm, start: &[f64]) -> Self {
        Self {
            nominal_posture: nominal_posture_from(arm, start),
            singularity_branch: SingularityBranch::unknown(start),
            is_unreached: false,
            is_off_posture: false,
            target_rests: false,
            remaining: 1.0,
            last_motion: vec![0.0; start.len()],
            last_slope: vec![0.0; start.len()],
            stiffness: 0.0,
        }
    }

    /// Sets the nominal posture to that of an arm that begins at `start`.
    pub(super) fn set_nominal_posture(&mut self, arm: &Arm, start: &[f64]) {
        self.nominal_posture = nominal_posture_from(arm, start);
    }

    /// True if the arm is near a singularity, where branches meet.
    #[must_use]
    pub(super) fn near_singularity(&self) -> bool {
        self.is_unreached || self.singularity_branch.is_known()
    }

    /// True if the arm is stretched and its side is known.
    #[must_use]
    pub(super) fn is_stretched(&self) -> bool {
        self.singularity_branch.is_known()
    }

    /// True if a target has stayed unreached until the null-space motion ended.
    #[must_use]
    pub(super) fn has_come_to_rest(&self) -> bool {
        self.is_unreached && self.remaining < MIN_REMAINING_FRACTION
    }

    /// Returns true if a step includes null-space motion: towards a new target, or back after a failed step.
    pub(super) fn uses_null_space(&self, arm: &Arm) -> bool {
        arm.has_null_space() && (!self.target_rests || self.is_off_posture)
    }

    /// Records whether the next step's target is the last one's.
    pub(super) fn take_target(&mut self, target_rests: bool) {
        self.target_rests = target_rests;
        self.remaining = match target_rests && self.is_unreached {
            true => UNREACHED_DECAY * self.remaining,
            false => 1.0,
        };
    }

    /// Moves the workspace's x to the start of a step: in the null space, and slightly to the side of a stretched arm.
    ///
    /// The null-space motion is at most `max_joint_motion` radians per joint.
    pub(super) fn begin_step(
        &mut self,
        arm: &Arm,
        workspace: &mut ArmWorkspace,
        max_joint_motion: f64,
    ) {
        if arm.has_null_space() {
            self.move_to_nominal_posture(arm, workspace, max_joint_motion, STEP_FRACTION);
        }
        if !self.target_rests {
            self.singularity_branch
                .offset_to_side(workspace, SIDE_OFFSET);
        }
    }

    /// Moves the workspace's x to the side of a stretched arm by `offset` radians.
    ///
    /// It moves only if the last step missed a target that moves.
    pub(super) fn offset_to_side(&self, workspace: &mut ArmWorkspace, offset: f64) {
        if self.is_unreached && !self.target_rests {
            self.singularity_branch.offset_to_side(workspace, offset);
        }
    }

    /// Moves the workspace's x in the null space and returns the largest motion of a joint, radians.
    ///
    /// The motion is at most `max_joint_motion` radians per joint and `fraction` of the distance to the minimum.
    pub(super) fn move_to_nominal_posture(
        &mut self,
        arm: &Arm,
        workspace: &mut ArmWorkspace,
        max_joint_motion: f64,
        fraction: f64,
    ) -> f64 {
        let x = std::mem::take(&mut workspace.x);
        workspace.compute_twists(arm, &x);
        self.compute_null_space_step(arm, workspace, &x, max_joint_motion, fraction, None);
        workspace.x = x;
        workspace.apply_projected();
        let motion = workspace.projected.iter();
        motion.fold(0.0_f64, |max_motion, joint_motion| {
            max_motion.max(joint_motion.abs())
        })
    }

    /// Writes the null-space motion from x towards the nominal posture to the workspace's `projected`, radians per
    /// joint.
    ///
    /// The workspace must hold the Jacobian at x; `factor` is its factorisation, if known.
    pub(super) fn compute_null_space_step(
        &mut self,
        arm: &Arm,
        workspace: &mut ArmWorkspace,
        x: &[f64],
        max_joint_motion: f64,
        fraction: f64,
        factor: Option<&Factor>,
    ) {
        let step = NullSpaceStep {
            nominal_posture: &self.nominal_posture,
            stretched: Some(&self.singularity_branch)
                .filter(|branch| self.is_unreached && branch.is_known()),
            fraction: self.remaining * fraction,
            max_joint_motion,
            last_motion: &self.last_motion,
            last_slope: &self.last_slope,
            stiffness: STIFFNESS_DECAY * self.stiffness,
            factor,
        };
        let (moves, stiffness) = workspace.compute_null_space_step(arm, x, &step);
        self.is_off_posture &= moves;
        self.stiffness = stiffness;
        self.last_slope.copy_from_slice(&workspace.slope);
        self.last_motion.copy_from_slice(&workspace.projected);
    }

    /// Ends a step at the workspace's x.
    pub(super) fn end_step(&mut self, arm: &Arm, workspace: &mut ArmWorkspace, reached: bool) {
        if reached {
            self.singularity_branch.record(arm, &workspace.x);
        }
        self.singularity_branch
            .update(arm, workspace, &self.nominal_posture, !reached);
        self.is_unreached = !reached;
        self.is_off_posture |= self.is_unreached;
    }

    /// Ends a step at q, which reaches its target.
    pub(super) fn end_step_at(&mut self, arm: &Arm, q: &[f64]) {
        self.singularity_branch.record(arm, q);
        self.is_unreached = false;
    }

    /// Restarts at q after a jump.
    pub(super) fn jump_to(&mut self, q: &[f64], reached: bool) {
        self.singularity_branch.begin(q);
        self.is_unreached = !reached;
    }
}
