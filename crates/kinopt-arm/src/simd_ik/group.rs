//! State of the lanes that run in lock step.

use super::lane::LaneScalar;
use super::settings::Settings;
use kinopt_kinematics::spatial::{Placement, Vector3};

/// State of a group of lanes, advanced by the step.
pub(crate) struct LaneGroup<V, const N: usize> {
    /// Number of joints, at most N.
    joints: usize,
    pub(super) goal_from_first: Placement<V>,
    /// Frame propagated along the chain; reads and writes alternate between the two slots.
    pub(super) frames: [Placement<V>; 2],
    /// Linear half of the Jacobian's columns: velocity of the point at the goal's origin per unit of joint velocity.
    pub(super) linear: [Vector3<V>; N],
    /// Angular half of the Jacobian's columns: axis of each revolute joint, zero for a prismatic one.
    pub(super) angular: [Vector3<V>; N],
    /// Sine and cosine of each revolute joint's angle.
    pub(super) sin_cos: [(V, V); N],
    /// Lower triangle of J Jᵀ.
    pub(super) normal: [[V; 6]; 6],
    /// Point to evaluate next.
    pub(super) q: [V; N],
    /// Best point so far.
    pub(super) accepted: [V; N],
    /// Twice the cost of the best point, lengths of the solver squared.
    pub(super) accepted_twice_cost: V,
    pub(super) damping: V,
    /// Twice the cost at the time the error last halved.
    pub(super) progress_twice_cost: V,
    /// Iterations since the error last halved.
    pub(super) since_progress: V,
}

impl<V: LaneScalar, const N: usize> LaneGroup<V, N> {
    pub(crate) fn new(joints: usize) -> Self {
        let zero = V::zero();
        Self {
            joints,
            goal_from_first: Placement::identity(),
            frames: [Placement::identity(); 2],
            linear: [Vector3::zero(); N],
            angular: [Vector3::zero(); N],
            sin_cos: [(zero, zero); N],
            normal: [[zero; 6]; 6],
            q: [zero; N],
            accepted: [zero; N],
            accepted_twice_cost: zero,
            damping: zero,
            progress_twice_cost: zero,
            since_progress: zero,
        }
    }

    /// Number of joints: `JOINTS` if the kernel is compiled for a fixed number, else the chain's.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn joints<const JOINTS: usize>(&self) -> usize {
        if JOINTS == 0 { self.joints } else { JOINTS }
    }

    /// Sets the goal of `lane` and starts an attempt. `q` must be within the bounds.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn load(
        &mut self,
        lane: usize,
        goal_from_first: &Placement<f64>,
        q: &[f64],
        settings: &Settings,
    ) {
        self.aim(lane, goal_from_first);
        self.begin(lane, q, settings);
    }

    /// Sets the goal of `lane`.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn aim(&mut self, lane: usize, goal_from_first: &Placement<f64>) {
        let set = |to: &mut Vector3<V>, from: Vector3<f64>| {
            to.x.set_lane(lane, from.x);
            to.y.set_lane(lane, from.y);
            to.z.set_lane(lane, from.z);
        };
        let (to, from) = (&mut self.goal_from_first, goal_from_first);
        set(&mut to.rotation.x, from.rotation.x);
        set(&mut to.rotation.y, from.rotation.y);
        set(&mut to.rotation.z, from.rotation.z);
        set(&mut to.translation, from.translation);
    }

    /// Starts an attempt in `lane` at its present goal. `q` must be within the bounds.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(super) fn begin(&mut self, lane: usize, q: &[f64], settings: &Settings) {
        for (i, &value) in q.iter().enumerate().take(self.joints) {
            self.q[i].set_lane(lane, value);
            self.accepted[i].set_lane(lane, value);
        }
        self.accepted_twice_cost.set_lane(lane, f64::INFINITY);
        self.progress_twice_cost.set_lane(lane, f64::INFINITY);
        self.since_progress.set_lane(lane, 0.0);
        self.damping.set_lane(lane, settings.damping);
    }

    /// Best point of `lane` so far, as of the last [`step`](super::lm_step::step).
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn point(&self, lane: usize, q: &mut [f64]) {
        for (i, value) in q.iter_mut().enumerate().take(self.joints) {
            *value = self.accepted[i].lane(lane);
        }
    }

    /// Point of `lane` that the next [`step`](super::lm_step::step) will evaluate.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn next_point(&self, lane: usize, q: &mut [f64]) {
        for (i, value) in q.iter_mut().enumerate().take(self.joints) {
            *value = self.q[i].lane(lane);
        }
    }

    /// Twice the cost at [`point`](Self::point), lengths of the solver squared.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn twice_cost(&self, lane: usize) -> f64 {
        self.accepted_twice_cost.lane(lane)
    }
}
