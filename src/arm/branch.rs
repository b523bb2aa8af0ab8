//! Branch of a path follower or servo: null-space motion, and the side of a stretched arm.

use super::arm::Arm;
use super::null_space::Factor;
use super::redundancy::{NominalPosture, SHARE};
use super::singularity_branch::SingularityBranch;
use super::workspace::ArmWorkspace;

/// Factor per step on the null-space motion while a target stays unreached.
///
/// The motion ends if it only approaches the nominal posture, so that the arm comes to rest at the closest pose.
const LEFT_AT_REST: f64 = 0.9;
/// Remaining fraction at which that motion counts as ended.
const OVER: f64 = 1e-3;
/// Offset of a step's start to the side of a stretched arm, radians; constant, as a growing one makes the arm swing.
const LEANING: f64 = 2e-3;
/// Fraction of a measured stiffness that is kept from step to step.
const STIFFNESS_KEPT: f64 = 0.9;

/// State that a path follower or servo carries from one step to the next.
#[derive(Clone, Debug)]
pub(super) struct Branch {
    /// Nominal posture of the null-space motion.
    ease: Vec<f64>,
    bend: SingularityBranch,
    /// True if the last step did not reach its target.
    missed: bool,
    /// True if a step has failed since the arm was last at its nominal posture.
    strayed: bool,
    /// True if the target is that of the last step.
    rests: bool,
    /// Remaining fraction of the null-space motion while a target stays unreached, 0 to 1.
    left: f64,
    /// Last step of the null-space motion, radians per joint.
    last: Vec<f64>,
    /// Slope at the start of that step, radians per joint.
    slope: Vec<f64>,
    /// Stiffness along that step, measured by the change of the slope. Stiffer null spaces take shorter steps.
    stiffness: f64,
}

impl Branch {
    /// Branch of an arm that begins at `start`.
    pub(super) fn begin(arm: &Arm, start: &[f64]) -> Self {
        Self {
            ease: arm.nominal_posture_from(start),
            bend: SingularityBranch::unknown(start),
            missed: false,
            strayed: false,
            rests: false,
            left: 1.0,
            last: vec![0.0; start.len()],
            slope: vec![0.0; start.len()],
            stiffness: 0.0,
        }
    }

    /// Sets the nominal posture to that of an arm that begins at `start`.
    pub(super) fn set_ease(&mut self, arm: &Arm, start: &[f64]) {
        self.ease = arm.nominal_posture_from(start);
    }

    getters! {
        /// True if the arm is near a singularity, where branches meet.
        pub(super) fn near_singularity(&self) -> bool = self.missed || self.bend.is_known();
        /// True if the arm is stretched and its side is known.
        pub(super) fn is_stretched(&self) -> bool = self.bend.is_known();
        /// True if a target has stayed unreached until the null-space motion ended.
        pub(super) fn rests_long(&self) -> bool = self.missed && self.left < OVER;
    }

    /// Returns true if a step includes null-space motion: towards a new target, or back after a failed step.
    pub(super) fn spends_freedom(&self, arm: &Arm) -> bool {
        arm.has_freedom() && (!self.rests || self.strayed)
    }

    /// Records whether the next step's target is the last one's.
    pub(super) fn take_target(&mut self, rests: bool) {
        self.rests = rests;
        self.left = match rests && self.missed {
            true => LEFT_AT_REST * self.left,
            false => 1.0,
        };
    }

    /// Moves the workspace's x to the start of a step: in the null space, and slightly to the side of a stretched arm.
    ///
    /// The null-space motion is at most `longest` radians per joint.
    pub(super) fn lead(&mut self, arm: &Arm, workspace: &mut ArmWorkspace, longest: f64) {
        if arm.has_freedom() {
            self.lead_to_ease(arm, workspace, longest, SHARE);
        }
        if !self.rests {
            self.bend.lean(workspace, LEANING);
        }
    }

    /// Moves the workspace's x to the side of a stretched arm by `offset` radians.
    ///
    /// It moves only if the last step missed a target that moves.
    pub(super) fn lean(&self, workspace: &mut ArmWorkspace, offset: f64) {
        if self.missed && !self.rests {
            self.bend.lean(workspace, offset);
        }
    }

    /// Moves the workspace's x in the null space and returns the largest motion of a joint, radians.
    ///
    /// The motion is at most `longest` radians per joint and `share` of the distance to the minimum.
    pub(super) fn lead_to_ease(
        &mut self,
        arm: &Arm,
        workspace: &mut ArmWorkspace,
        longest: f64,
        share: f64,
    ) -> f64 {
        let x = std::mem::take(&mut workspace.x);
        workspace.take_twists(arm, &x);
        self.aim_at_nominal_posture(arm, workspace, &x, longest, share, None);
        workspace.x = x;
        workspace.go_by_projected();
        let moved = workspace.projected.iter();
        moved.fold(0.0_f64, |most, by| most.max(by.abs()))
    }

    /// Writes the null-space motion from x towards the nominal posture to the workspace's `projected`, radians per
    /// joint.
    ///
    /// The workspace must hold the Jacobian at x; `free` is its factorisation, if known.
    pub(super) fn aim_at_nominal_posture(
        &mut self,
        arm: &Arm,
        workspace: &mut ArmWorkspace,
        x: &[f64],
        longest: f64,
        share: f64,
        free: Option<&Factor>,
    ) {
        let how = NominalPosture {
            ease: &self.ease,
            stretched: Some(&self.bend).filter(|bend| self.missed && bend.is_known()),
            share: self.left * share,
            longest,
            last: &self.last,
            last_slope: &self.slope,
            stiffness: STIFFNESS_KEPT * self.stiffness,
            free,
        };
        let (moves, stiffness) = workspace.aim_at_nominal_posture(arm, x, &how);
        self.strayed &= moves;
        self.stiffness = stiffness;
        self.slope.copy_from_slice(&workspace.slope);
        self.last.copy_from_slice(&workspace.projected);
    }

    /// Ends a step at the workspace's x.
    pub(super) fn arrive(&mut self, arm: &Arm, workspace: &mut ArmWorkspace, reached: bool) {
        if reached {
            self.bend.note(arm, &workspace.x);
        }
        self.bend.carry_on(arm, workspace, &self.ease, !reached);
        self.missed = !reached;
        self.strayed |= self.missed;
    }

    /// Ends a step at q, which reaches its target.
    pub(super) fn arrive_at(&mut self, arm: &Arm, q: &[f64]) {
        self.bend.note(arm, q);
        self.missed = false;
    }

    /// Restarts at q after a jump.
    pub(super) fn jump_to(&mut self, q: &[f64], reached: bool) {
        self.bend.begin(q);
        self.missed = !reached;
    }
}
