//! One lock-step iteration of Levenberg-Marquardt on every lane at once.
//!
//! All kinematics is written in the goal's frame, where the tip should come to the identity. With
//! `p` the tip's position there and `s = sin θ · n` half the skew part of its rotation R (angle θ
//! about n), the cost is `½(|p|² + w² · 2(1 − cos θ))`; its gradient is exactly `Jᵀ(p, w² s)`, with
//! no arc function, for J the spatial Jacobian: column `(p_i × z_i, z_i)` of a turning joint with
//! axis z_i through p_i, the velocity of the point at the goal's origin. That column needs nothing
//! from the joints after it. A step solves the dual system `(J Jᵀ + λ D) y = −e`, Δ = Jᵀ y, with
//! e = (p + ½ p × s, s), the twist to the goal to second order.
//!
//! A joint on its bound that the gradient pushes outward is left out of the step (Bertsekas 1982);
//! the rest is clamped. A point that does not lower the cost is not accepted: the next one lies a
//! quarter of the way from the last accepted point to it, which needs no old Jacobian.

use super::axes;
use super::chain::JointKind;
use super::goal::AxisGoal;
use super::lane::LaneScalar;
use super::ldlt;
use super::links::Links;
use super::pose;
use crate::spatial::{Matrix3, Placement, Vector3};

/// What the iteration is told about the task, the same for all lanes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Settings {
    /// Position counts as reached below this, metres.
    pub(crate) position_tolerance: f64,
    /// Orientation counts as reached below this, radians.
    pub(crate) orientation_tolerance: f64,
    /// Metres that weigh as much as one radian.
    pub(crate) metres_per_radian: f64,
    /// λ = damping · cost at the start of an attempt.
    pub(crate) damping: f64,
    /// Weights and dead bands of the six components, for the weighted kernel.
    pub(crate) axes: AxisGoal,
    /// Twice the cost below which one more step should reach.
    pub(crate) closing_cost: f64,
    /// An attempt whose error has not halved in this many iterations is given up.
    pub(crate) stall_limit: f64,
}

/// The state of one group of lanes.
pub(crate) struct Group<V, const N: usize> {
    /// Number of joints, at most N; N itself in the kernels made for one size.
    joints: usize,
    goal_from_first: Placement<V>,
    /// The frame that travels along the chain, from one place to the other and back.
    frames: [Placement<V>; 2],
    /// Jacobian columns: velocity of the point at the goal's origin per unit of each joint's
    /// velocity, and the axis of each turning joint.
    linear: [Vector3<V>; N],
    angular: [Vector3<V>; N],
    /// Sine and cosine of each turning joint's angle.
    sin_cos: [(V, V); N],
    /// J Jᵀ, lower triangle.
    normal: [[V; 6]; 6],
    /// The point to evaluate next.
    q: [V; N],
    /// The best point so far, and twice its cost.
    accepted: [V; N],
    accepted_cost: V,
    damping: V,
    /// Cost at the last real progress, and iterations since.
    reference_cost: V,
    stalled: V,
}

/// Which lanes ended, bit by bit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ended {
    /// The evaluated point is within the tolerances.
    pub(crate) reached: u32,
    /// No progress.
    pub(crate) stalled: u32,
    /// So close that the point after this step should be within the tolerances.
    pub(crate) closing: u32,
}

/// Where the tip stands and how it moves.
pub(crate) struct Evaluation<V> {
    pub(crate) position: Vector3<V>,
    pub(crate) rotation: Matrix3<V>,
}

/// Runs the body for each joint, written out where their number is known.
macro_rules! each_joint {
    ($n:expr, $i:ident, $body:block) => {
        if EXACT {
            each_joint!(@ $i, $body, 0 1 2 3 4 5 6)
        } else {
            for $i in 0..$n $body
        }
    };
    (@ $i:ident, $body:block, $($k:literal)*) => {{
        $(if $k < N { let $i = $k; $body })*
    }};
}

impl<V: LaneScalar, const N: usize> Group<V, N> {
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
            accepted_cost: zero,
            damping: zero,
            reference_cost: zero,
            stalled: zero,
        }
    }

    /// Starts an attempt in `lane`. The values of `q` lie within the bounds.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn load(
        &mut self,
        lane: usize,
        goal_from_first: &Placement<f64>,
        q: &[f64],
        settings: &Settings,
    ) {
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
        for (i, &value) in q.iter().enumerate().take(self.joints) {
            self.q[i].set_lane(lane, value);
            self.accepted[i].set_lane(lane, value);
        }
        self.accepted_cost.set_lane(lane, f64::INFINITY);
        self.reference_cost.set_lane(lane, f64::INFINITY);
        self.stalled.set_lane(lane, 0.0);
        self.damping.set_lane(lane, settings.damping);
    }

    /// The point of `lane` that the last [`step`](Self::step) found reached.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn point(&self, lane: usize, q: &mut [f64]) {
        for (i, value) in q.iter_mut().enumerate().take(self.joints) {
            *value = self.accepted[i].lane(lane);
        }
    }

    /// The point of `lane` that the next [`step`](Self::step) will evaluate.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn next_point(&self, lane: usize, q: &mut [f64]) {
        for (i, value) in q.iter_mut().enumerate().take(self.joints) {
            *value = self.q[i].lane(lane);
        }
    }

    /// Twice the cost at [`point`](Self::point).
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn cost(&self, lane: usize) -> f64 {
        self.accepted_cost.lane(lane)
    }

    /// Evaluates every lane's point, judges it, and moves every lane that has not ended.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn step<const EXACT: bool, const AXES: bool>(
        &mut self,
        links: &Links,
        settings: &Settings,
    ) -> Ended {
        let n = if EXACT { N } else { self.joints };
        let c = V::constant;
        let weight = settings.metres_per_radian * settings.metres_per_radian;
        let mut at = self.evaluate::<EXACT>(links);
        let tp = settings.position_tolerance * settings.position_tolerance;
        let to = settings.orientation_tolerance * settings.orientation_tolerance;
        let weighed = if AXES {
            at.rotation = at.rotation * Matrix3::constant(links.last_from_tip);
            axes::weigh(&at, &mut self.linear[..n], &mut self.angular[..n], settings)
        } else {
            pose::weigh(&at, weight)
        };
        let cost = weighed.cost;
        let reached = weighed.position.less_than(c(tp)) & weighed.orientation.less_than(c(to));
        let accept = cost.less_than(self.accepted_cost) | reached;

        // Damping: halved on a step that takes the cost below a quarter, a little less on other
        // descents, times four on a rejection.
        let fast = cost.less_than(self.accepted_cost * c(0.25));
        let factor = V::select(fast, c(0.5), c(0.8));
        self.damping *= V::select(accept, factor, c(4.0));
        self.accepted_cost = V::select(accept, cost, self.accepted_cost);
        let progress = cost.less_than(self.reference_cost * c(0.25));
        self.reference_cost = V::select(progress, cost, self.reference_cost);
        // Near the goal convergence may be slow but sure (a singular goal): more patience.
        self.stalled = V::select(
            progress,
            V::zero(),
            self.stalled + V::select(cost.less_than(c(1e-6)), c(0.1), V::one()),
        );
        let stalled = c(settings.stall_limit - 0.5).less_than(self.stalled);

        let ended = Ended {
            reached: V::mask_bits(reached),
            stalled: V::mask_bits(stalled),
            closing: V::mask_bits(cost.less_than(c(settings.closing_cost)) & accept),
        };

        // The damped normal equations over the free joints.
        for i in 0..n {
            let (l, a) = (self.linear[i], self.angular[i]);
            let gradient = l.dot(weighed.gradient.0) + a.dot(weighed.gradient.1);
            let q = self.q[i];
            let (lower, upper) = (c(links.links[i].lower), c(links.links[i].upper));
            let at_lower = !lower.less_than(q) & V::zero().less_than(gradient);
            let at_upper = !q.less_than(upper) & gradient.less_than(V::zero());
            // A product, as a select of the old value would become a masked store, which is slow.
            let free = V::select(at_lower | at_upper, V::zero(), V::one());
            self.linear[i] = l * free;
            self.angular[i] = a * free;
        }
        self.normal_equations::<EXACT>(n);
        let m = &mut self.normal;
        let lambda = (self.damping * cost).max(c(1e-14));
        // In the weighted kernel the rows carry their weights already.
        let lambda_turn = if AXES {
            lambda
        } else {
            lambda * c(weight.recip())
        };
        for k in 0..3 {
            m[k][k] += lambda;
            m[k + 3][k + 3] += lambda_turn;
        }
        let (e, s) = weighed.twist;
        let y = ldlt::solve(self.normal, [-e.x, -e.y, -e.z, -s.x, -s.y, -s.z]);
        let y_linear = Vector3::new(y[0], y[1], y[2]);
        let y_angular = Vector3::new(y[3], y[4], y[5]);
        for i in 0..n {
            let delta = self.linear[i].dot(y_linear) + self.angular[i].dot(y_angular);
            let link = &links.links[i];
            let q = self.q[i];
            let moved = (q + delta).max(c(link.lower)).min(c(link.upper));
            let old = self.accepted[i];
            let back = (q - old).mul_add(c(0.25), old);
            self.accepted[i] = V::select(accept, q, old);
            self.q[i] = V::select(accept, moved, back);
        }
        ended
    }

    /// J Jᵀ, in three blocks whose sums fit the registers.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn normal_equations<const EXACT: bool>(&mut self, n: usize) {
        macro_rules! block {
            ($left:ident, $right:ident, $row:literal, $column:literal, $($r:literal $k:literal),*) => {{
                let mut sum = [[V::zero(); 3]; 3];
                each_joint!(n, i, {
                    let (left, right) = (self.$left[i].to_array(), self.$right[i].to_array());
                    $(sum[$r][$k] = left[$r].mul_add(right[$k], sum[$r][$k]);)*
                });
                $(self.normal[$row + $r][$column + $k] = sum[$r][$k];)*
            }};
        }
        block!(linear, linear, 0, 0, 0 0, 1 0, 1 1, 2 0, 2 1, 2 2);
        block!(angular, linear, 3, 0, 0 0, 0 1, 0 2, 1 0, 1 1, 1 2, 2 0, 2 1, 2 2);
        block!(angular, angular, 3, 3, 0 0, 1 0, 1 1, 2 0, 2 1, 2 2);
    }

    /// Forward kinematics and the Jacobian's columns in the goal's frame.
    #[cfg_attr(not(debug_assertions), inline(always))]
    fn evaluate<const EXACT: bool>(&mut self, links: &Links) -> Evaluation<V> {
        let n = if EXACT { N } else { self.joints };
        let c = V::constant;
        for i in 0..n {
            let link = &links.links[i];
            self.sin_cos[i] = if EXACT || link.kind == JointKind::Revolute {
                (self.q[i] + c(link.offset)).sin_cos()
            } else {
                (c(link.offset_sin_cos.0), c(link.offset_sin_cos.1))
            };
        }
        self.frames[0] = self.goal_from_first;
        for i in 0..n {
            let link = &links.links[i];
            let Placement {
                rotation: mut r,
                translation: mut p,
            } = self.frames[link.from & 1];
            if EXACT || link.kind == JointKind::Revolute {
                self.angular[i] = r.z;
                self.linear[i] = p.cross(r.z);
            } else {
                self.linear[i] = r.z;
                self.angular[i] = Vector3::zero();
                p = r.z.mul_add(self.q[i], p);
            }
            let sin_cos = self.sin_cos[i];
            r = r.rotated_about_z(sin_cos);
            p =
                r.x.mul_add(c(link.along_x), r.y.mul_add(c(link.along_y), p));
            r = r.rotated_about_x((c(link.twist.0), c(link.twist.1)));
            self.frames[link.to & 1] = Placement::new(r, p);
        }
        let Placement {
            rotation: r,
            translation: p,
        } = self.frames[links.links[n - 1].to & 1];
        Evaluation {
            position: p,
            rotation: r,
        }
    }
}

/// What the residual says about a point.
pub(crate) struct Weighed<V> {
    /// Twice the cost.
    pub(crate) cost: V,
    /// Squared position error, square metres.
    pub(crate) position: V,
    /// Squared orientation error, square radians.
    pub(crate) orientation: V,
    /// The cost's gradient by the columns' two halves.
    pub(crate) gradient: (Vector3<V>, Vector3<V>),
    /// What the step should undo.
    pub(crate) twist: (Vector3<V>, Vector3<V>),
}
