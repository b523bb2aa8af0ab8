//! What an arm knows of the branch that it follows: where its freedom leads, and its side where it is stretched out.

use super::arm::Arm;
use super::elbow_side::Bend;
use super::null_space::Factor;
use super::redundancy::{Easing, SHARE};
use super::workspace::ArmWorkspace;

/// What is left of the motion to ease each time that a target stays out of reach: where that motion lowers
/// nothing but the distance from ease, it is over by then; else the nearest place is kept.
const LEFT_AT_REST: f64 = 0.9;
/// What is left of it when it is over.
const OVER: f64 = 1e-3;
/// Share of a measured stiffness that is kept from step to step.
const STIFFNESS_KEPT: f64 = 0.9;

/// What a follower and a servo carry from one step to the next.
#[derive(Clone, Debug)]
pub(super) struct Branch {
    /// The posture that the freedom left is spent on.
    ease: Vec<f64>,
    bend: Bend,
    /// Whether the last step missed its target, and whether one did since the arm was at ease.
    missed: bool,
    strayed: bool,
    /// Whether the target is the last one's.
    rests: bool,
    /// How much of the motion to ease is left where a target stays out of reach, 0 to 1.
    left: f64,
    /// Last step of the null-space motion, the slope there, and the stiffness along it that its change showed: the step is
    /// the shorter the stiffer the null space is, so that it does not overshoot.
    last: Vec<f64>,
    slope: Vec<f64>,
    stiffness: f64,
}

impl Branch {
    /// The branch of an arm that begins at `start`.
    pub(super) fn begin(arm: &Arm, start: &[f64]) -> Self {
        Self {
            ease: arm.ease_from(start),
            bend: Bend::unknown(start),
            missed: false,
            strayed: false,
            rests: false,
            left: 1.0,
            last: vec![0.0; start.len()],
            slope: vec![0.0; start.len()],
            stiffness: 0.0,
        }
    }

    /// Spends the freedom on what an arm would that began at `start`.
    pub(super) fn set_ease(&mut self, arm: &Arm, start: &[f64]) {
        self.ease = arm.ease_from(start);
    }

    getters! {
        /// Whether the arm is where branches meet, and goes with care.
        pub(super) fn asks_for_care(&self) -> bool = self.missed || self.bend.is_known();
        /// Whether the arm is stretched out and knows its side.
        pub(super) fn is_stretched(&self) -> bool = self.bend.is_known();
        /// Whether a target has stayed out of reach for so long that the motion to ease is over.
        pub(super) fn rests_long(&self) -> bool = self.missed && self.left < OVER;
    }

    /// Whether a step spends freedom: one to another target, and those that lead back after a miss.
    pub(super) fn spends_freedom(&self, arm: &Arm) -> bool {
        arm.has_freedom() && (!self.rests || self.strayed)
    }

    /// Notes whether the next step's target is the last one's.
    pub(super) fn take_target(&mut self, rests: bool) {
        self.rests = rests;
        self.left = match rests && self.missed {
            true => LEFT_AT_REST * self.left,
            false => 1.0,
        };
    }

    /// Moves the workspace's x to where a follower's step begins: on in the null space by at most `longest` radians a joint, and a
    /// little to the side of a stretched arm.
    pub(super) fn lead(&mut self, arm: &Arm, workspace: &mut ArmWorkspace, longest: f64) {
        if arm.has_freedom() {
            self.lead_to_ease(arm, workspace, longest, SHARE);
        }
        if !self.rests {
            self.bend.lean(workspace);
        }
    }

    /// Moves the workspace's x on in the null space, by at most `longest` radians a joint and this share of the distance to the lowest
    /// point; the largest motion of a joint, radians.
    pub(super) fn lead_to_ease(
        &mut self,
        arm: &Arm,
        workspace: &mut ArmWorkspace,
        longest: f64,
        share: f64,
    ) -> f64 {
        let x = std::mem::take(&mut workspace.x);
        workspace.take_twists(arm, &x);
        self.aim_at_ease(arm, workspace, &x, longest, share, None);
        workspace.x = x;
        workspace.go_by_projected();
        let moved = workspace.projected.iter();
        moved.fold(0.0_f64, |most, by| most.max(by.abs()))
    }

    /// Writes into the workspace's `projected` the motion to ease from x, radians a joint. The Jacobian at x is
    /// there, and perhaps factored.
    pub(super) fn aim_at_ease(
        &mut self,
        arm: &Arm,
        workspace: &mut ArmWorkspace,
        x: &[f64],
        longest: f64,
        share: f64,
        free: Option<&Factor>,
    ) {
        let how = Easing {
            ease: &self.ease,
            stretched: Some(&self.bend).filter(|bend| self.missed && bend.is_known()),
            share: self.left * share,
            longest,
            last: &self.last,
            last_slope: &self.slope,
            stiffness: STIFFNESS_KEPT * self.stiffness,
            free,
        };
        let (moves, stiffness) = workspace.aim_at_ease(arm, x, &how);
        self.strayed &= moves;
        self.stiffness = stiffness;
        self.slope.copy_from_slice(&workspace.slope);
        self.last.copy_from_slice(&workspace.projected);
    }

    /// Takes the workspace's x as a step's end.
    pub(super) fn arrive(&mut self, arm: &Arm, workspace: &mut ArmWorkspace, reached: bool) {
        if reached {
            self.bend.note(arm, &workspace.x);
        }
        self.bend.carry_on(arm, workspace, &self.ease, !reached);
        self.missed = !reached;
        self.strayed |= self.missed;
    }

    /// Takes q, which reaches its target, as a step's end.
    pub(super) fn arrive_at(&mut self, arm: &Arm, q: &[f64]) {
        self.bend.note(arm, q);
        self.missed = false;
    }

    /// Goes on from q, to which the arm has jumped.
    pub(super) fn jump_to(&mut self, q: &[f64], reached: bool) {
        self.bend.begin(q);
        self.missed = !reached;
    }
}
