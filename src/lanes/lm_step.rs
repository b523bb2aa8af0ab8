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

use super::axis_residual;
use super::group::Group;
use super::jacobian;
use super::lane::LaneScalar;
use super::ldlt;
use super::links::Links;
use super::pose;
use super::settings::Settings;
use crate::spatial::{Matrix3, Vector3};

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

impl Ended {
    /// Before the first step.
    pub(crate) fn none() -> Self {
        Self {
            reached: 0,
            stalled: 0,
            closing: 0,
        }
    }
}

/// Evaluates every lane's point, judges it, and moves every lane that has not ended. `JOINTS` is the
/// number of joints if all turn, or 0 for any chain; `AXES` says that the goal is not the full pose.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn step<V: LaneScalar, const N: usize, const JOINTS: usize, const AXES: bool>(
    group: &mut Group<V, N>,
    links: &Links,
    settings: &Settings,
) -> Ended {
    let n = group.joints::<JOINTS>();
    let c = V::constant;
    let weight = settings.length_per_radian * settings.length_per_radian;
    let mut at = jacobian::evaluate::<V, N, JOINTS>(group, links);
    let tp = settings.position_tolerance * settings.position_tolerance;
    let to = settings.orientation_tolerance * settings.orientation_tolerance;
    let weighed = if AXES {
        at.rotation = at.rotation * Matrix3::constant(links.last_from_tip);
        axis_residual::weigh(
            &at,
            &mut group.linear[..n],
            &mut group.angular[..n],
            settings,
        )
    } else {
        pose::weigh(&at, weight)
    };
    let cost = weighed.cost;
    let reached = weighed.position.less_than(c(tp)) & weighed.orientation.less_than(c(to));
    let accept = cost.less_than(group.accepted_cost) | reached;

    // Damping: halved on a step that takes the cost below a quarter, a little less on other
    // descents, times four on a rejection.
    let fast = cost.less_than(group.accepted_cost * c(0.25));
    let factor = V::select(fast, c(0.5), c(0.8));
    group.damping *= V::select(accept, factor, c(4.0));
    group.accepted_cost = V::select(accept, cost, group.accepted_cost);
    let progress = cost.less_than(group.reference_cost * c(0.25));
    group.reference_cost = V::select(progress, cost, group.reference_cost);
    // Near the goal convergence may be slow but sure (a singular goal): more patience.
    group.stalled = V::select(
        progress,
        V::zero(),
        group.stalled + V::select(cost.less_than(c(1e-6)), c(0.1), V::one()),
    );
    let stalled = c(settings.stall_limit - 0.5).less_than(group.stalled);

    let ended = Ended {
        reached: V::mask_bits(reached),
        stalled: V::mask_bits(stalled),
        closing: V::mask_bits(cost.less_than(c(settings.closing_cost)) & accept),
    };

    // The damped normal equations over the free joints.
    for i in 0..n {
        let (l, a) = (group.linear[i], group.angular[i]);
        let gradient = l.dot(weighed.gradient.0) + a.dot(weighed.gradient.1);
        let q = group.q[i];
        let (lower, upper) = (c(links.links[i].lower), c(links.links[i].upper));
        let at_lower = !lower.less_than(q) & V::zero().less_than(gradient);
        let at_upper = !q.less_than(upper) & gradient.less_than(V::zero());
        // A product, as a select of the old value would become a masked store, which is slow.
        let free = V::select(at_lower | at_upper, V::zero(), V::one());
        group.linear[i] = l * free;
        group.angular[i] = a * free;
    }
    jacobian::normal_equations::<V, N, JOINTS>(group);
    let m = &mut group.normal;
    let lambda = (group.damping * cost).max(c(1e-14));
    // The rows of weighted goals carry their weights already.
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
    let [y] = ldlt::solve(group.normal, [[-e.x, -e.y, -e.z, -s.x, -s.y, -s.z]]);
    let y_linear = Vector3::new(y[0], y[1], y[2]);
    let y_angular = Vector3::new(y[3], y[4], y[5]);
    for i in 0..n {
        let delta = group.linear[i].dot(y_linear) + group.angular[i].dot(y_angular);
        let link = &links.links[i];
        let q = group.q[i];
        let moved = (q + delta).max(c(link.lower)).min(c(link.upper));
        let old = group.accepted[i];
        let back = (q - old).mul_add(c(0.25), old);
        group.accepted[i] = V::select(accept, q, old);
        group.q[i] = V::select(accept, moved, back);
    }
    ended
}
