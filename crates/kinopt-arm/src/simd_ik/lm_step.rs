//! One lock-step iteration of Levenberg-Marquardt on all lanes.
//!
//! Kinematics is in the goal frame, where the tip should reach the identity. Let p be the tip's position and s = sin
//! θ · n half the skew part of its rotation R (angle θ about n). The cost is `½(|p|² + w² · 2(1 − cos θ))`; its
//! gradient is exactly `Jᵀ(p, w² s)` for the spatial Jacobian J. The column of a revolute joint with axis z_i through
//! p_i is `(p_i × z_i, z_i)`, which depends on no later joint.

use super::axis_residual;
use super::evaluation::WeightedResidual;
use super::group::LaneGroup;
use super::jacobian;
use super::lane::LaneScalar;
use super::ldlt;
use super::links::Links;
use super::pose;
use super::settings::Settings;
use kinopt_kinematics::spatial::{Matrix3, Vector3};

/// Ratio of costs at which the error has halved.
const HALVED_COST_RATIO: f64 = 0.25;
/// Factor on the damping after a step that halved the error.
const DAMPING_FACTOR_WHEN_HALVED: f64 = 0.5;
/// Factor on the damping after any other accepted step.
const DAMPING_FACTOR_WHEN_ACCEPTED: f64 = 0.8;
/// Factor on the damping after a rejected step.
const DAMPING_FACTOR_WHEN_REJECTED: f64 = 4.0;
/// Smallest λ, lengths of the solver squared; keeps the dual system regular at the goal.
const MIN_LAMBDA: f64 = 1e-14;
/// Fraction of a rejected step that is tried next.
const REJECTED_STEP_FRACTION: f64 = 0.25;
/// Twice the cost below which the goal is near, lengths of the solver squared.
///
/// Convergence to a singular goal is slow but certain there, so iterations count less towards a stall.
const NEAR_TWICE_COST: f64 = 1e-6;
/// Largest step that may end a continuation: sum of all joint displacements, radians and lengths of the solver.
///
/// The linear model of a step errs by at most half the step's square.
const MAX_LAST_STEP: f64 = 0.02;
/// Weight of an iteration near the goal in the count towards a stall.
const NEAR_ITERATION_WEIGHT: f64 = 0.1;

/// Bit masks of the lanes whose attempt may end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EndMasks {
    /// The evaluated point is within the tolerances.
    pub(crate) reached: u32,
    /// The error has not halved within the stall limit.
    pub(crate) stalled: u32,
    /// The point after this step should be within the tolerances.
    pub(crate) closing: u32,
}

impl EndMasks {
    /// Masks before the first step: no lanes.
    pub(crate) fn none() -> Self {
        Self {
            reached: 0,
            stalled: 0,
            closing: 0,
        }
    }
}

/// Evaluates the point of every lane, adapts its damping, and moves it to its next point.
///
/// `JOINTS` is the number of joints if all are revolute, or 0 for any chain. `AXES` is true if the goal is not the full
/// pose.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn step<V: LaneScalar, const N: usize, const JOINTS: usize, const AXES: bool>(
    group: &mut LaneGroup<V, N>,
    links: &Links,
    settings: &Settings,
) -> EndMasks {
    let residual = weigh::<V, N, JOINTS, AXES>(group, links, settings);
    let tp = settings.position_tolerance * settings.position_tolerance;
    let to = settings.orientation_tolerance * settings.orientation_tolerance;
    let reached = residual.position.less_than(V::constant(tp))
        & residual.orientation.less_than(V::constant(to));
    let twice_cost = residual.twice_cost;
    let accept = twice_cost.less_than(group.accepted_twice_cost) | reached;
    adapt_damping(group, twice_cost, accept);
    let stalled = count_since_progress(group, twice_cost, settings);
    zero_blocked_columns::<V, N, JOINTS>(group, links, &residual);
    let y = solve_dual::<V, N, JOINTS, AXES>(group, &residual, settings);
    advance_points::<V, N, JOINTS>(group, links, accept, y);
    let closing = accept
        & match settings.is_continuation {
            true => is_predicted_to_reach::<V, N, JOINTS>(group, residual.twist, tp, to),
            false => twice_cost.less_than(V::constant(settings.closing_twice_cost)),
        };
    EndMasks {
        reached: V::mask_bits(reached),
        stalled: V::mask_bits(stalled),
        closing: V::mask_bits(closing),
    }
}

/// Computes the residual at every lane's point, and the columns of its derivative.
#[cfg_attr(not(debug_assertions), inline(always))]
fn weigh<V: LaneScalar, const N: usize, const JOINTS: usize, const AXES: bool>(
    group: &mut LaneGroup<V, N>,
    links: &Links,
    settings: &Settings,
) -> WeightedResidual<V> {
    let n = group.joints::<JOINTS>();
    let mut evaluation = jacobian::evaluate::<V, N, JOINTS>(group, links);
    if AXES {
        evaluation.rotation = evaluation.rotation * Matrix3::constant(links.last_from_tip);
        axis_residual::weigh(
            &evaluation,
            &mut group.linear[..n],
            &mut group.angular[..n],
            settings,
        )
    } else {
        pose::weigh(
            &evaluation,
            settings.length_per_radian * settings.length_per_radian,
        )
    }
}

/// Lowers the damping after an accepted step, most if the error halved, and raises it after a rejected one.
#[cfg_attr(not(debug_assertions), inline(always))]
fn adapt_damping<V: LaneScalar, const N: usize>(
    group: &mut LaneGroup<V, N>,
    twice_cost: V,
    accept: V::Mask,
) {
    let c = V::constant;
    let halved = twice_cost.less_than(group.accepted_twice_cost * c(HALVED_COST_RATIO));
    let factor = V::select(
        halved,
        c(DAMPING_FACTOR_WHEN_HALVED),
        c(DAMPING_FACTOR_WHEN_ACCEPTED),
    );
    group.damping *= V::select(accept, factor, c(DAMPING_FACTOR_WHEN_REJECTED));
    group.accepted_twice_cost = V::select(accept, twice_cost, group.accepted_twice_cost);
}

/// Counts iterations since the error last halved. Returns the mask of the stalled lanes.
#[cfg_attr(not(debug_assertions), inline(always))]
fn count_since_progress<V: LaneScalar, const N: usize>(
    group: &mut LaneGroup<V, N>,
    twice_cost: V,
    settings: &Settings,
) -> V::Mask {
    let c = V::constant;
    let progress = twice_cost.less_than(group.progress_twice_cost * c(HALVED_COST_RATIO));
    group.progress_twice_cost = V::select(progress, twice_cost, group.progress_twice_cost);
    let iteration = V::select(
        twice_cost.less_than(c(NEAR_TWICE_COST)),
        c(NEAR_ITERATION_WEIGHT),
        V::one(),
    );
    group.since_progress = V::select(progress, V::zero(), group.since_progress + iteration);
    // Half an iteration below the limit, so that rounding of tenths does not decide.
    c(settings.stall_limit - 0.5).less_than(group.since_progress)
}

/// Zeroes the columns of joints at a bound whose descent direction points outward (Bertsekas 1982).
#[cfg_attr(not(debug_assertions), inline(always))]
fn zero_blocked_columns<V: LaneScalar, const N: usize, const JOINTS: usize>(
    group: &mut LaneGroup<V, N>,
    links: &Links,
    residual: &WeightedResidual<V>,
) {
    let c = V::constant;
    for i in 0..group.joints::<JOINTS>() {
        let (l, a) = (group.linear[i], group.angular[i]);
        let gradient = l.dot(residual.gradient.0) + a.dot(residual.gradient.1);
        let q = group.q[i];
        let (lower, upper) = (c(links.links[i].lower), c(links.links[i].upper));
        let at_lower = !lower.less_than(q) & V::zero().less_than(gradient);
        let at_upper = !q.less_than(upper) & gradient.less_than(V::zero());
        // A product: a select of the old value would compile to a slow masked store.
        let free = V::select(at_lower | at_upper, V::zero(), V::one());
        group.linear[i] = l * free;
        group.angular[i] = a * free;
    }
}

/// Solves `(J Jᵀ + λ D) y = −e` for y, by linear and angular half; the step is Δ = Jᵀ y.
///
/// The twist to cancel, to second order, is e = (p + ½ p × s, s). D is diag(1, 1, 1, w⁻², w⁻², w⁻²), or I for weighted
/// goals, whose rows include their weights. The step minimises `½ (J Δ + e)ᵀ D⁻¹ (J Δ + e) + ½ λ |Δ|²`. Its normal
/// equations have a row per joint. The dual equations have six rows and the same solution, as
/// `(Jᵀ D⁻¹ J + λ I)⁻¹ Jᵀ D⁻¹ = Jᵀ (J Jᵀ + λ D)⁻¹`. λ is the damping times twice the cost (cf. Sugihara 2011,
/// "Solvability-unconcerned inverse kinematics by the Levenberg-Marquardt method").
#[cfg_attr(not(debug_assertions), inline(always))]
fn solve_dual<V: LaneScalar, const N: usize, const JOINTS: usize, const AXES: bool>(
    group: &mut LaneGroup<V, N>,
    residual: &WeightedResidual<V>,
    settings: &Settings,
) -> (Vector3<V>, Vector3<V>) {
    let c = V::constant;
    jacobian::normal_equations::<V, N, JOINTS>(group);
    let lambda = (group.damping * residual.twice_cost).max(c(MIN_LAMBDA));
    let lambda_turn = if AXES {
        lambda
    } else {
        let weight = settings.length_per_radian * settings.length_per_radian;
        lambda * c(weight.recip())
    };
    let m = &mut group.normal;
    for k in 0..3 {
        m[k][k] += lambda;
        m[k + 3][k + 3] += lambda_turn;
    }
    let (e, s) = residual.twist;
    let [y] = ldlt::solve(group.normal, [[-e.x, -e.y, -e.z, -s.x, -s.y, -s.z]]);
    (
        Vector3::new(y[0], y[1], y[2]),
        Vector3::new(y[3], y[4], y[5]),
    )
}

/// Moves accepted lanes by Δ = Jᵀ y, clamped to the bounds.
///
/// A rejected lane next tries a fraction of its last step from the accepted point, which needs no earlier Jacobian.
#[cfg_attr(not(debug_assertions), inline(always))]
fn advance_points<V: LaneScalar, const N: usize, const JOINTS: usize>(
    group: &mut LaneGroup<V, N>,
    links: &Links,
    accept: V::Mask,
    (y_linear, y_angular): (Vector3<V>, Vector3<V>),
) {
    let c = V::constant;
    for i in 0..group.joints::<JOINTS>() {
        let delta = group.linear[i].dot(y_linear) + group.angular[i].dot(y_angular);
        let link = &links.links[i];
        let q = group.q[i];
        let moved = (q + delta).max(c(link.lower)).min(c(link.upper));
        let accepted = group.accepted[i];
        let shortened = (q - accepted).mul_add(c(REJECTED_STEP_FRACTION), accepted);
        group.accepted[i] = V::select(accept, q, accepted);
        group.q[i] = V::select(accept, moved, shortened);
    }
}

/// Mask of the lanes whose step ends at the goal by its linear model and is short enough for that model.
///
/// The step includes the effect of bounds and damping.
#[cfg_attr(not(debug_assertions), inline(always))]
fn is_predicted_to_reach<V: LaneScalar, const N: usize, const JOINTS: usize>(
    group: &LaneGroup<V, N>,
    (mut p, mut s): (Vector3<V>, Vector3<V>),
    squared_position: f64,
    squared_orientation: f64,
) -> V::Mask {
    let mut total_motion = V::zero();
    for i in 0..group.joints::<JOINTS>() {
        let delta = group.q[i] - group.accepted[i];
        p = group.linear[i].mul_add(delta, p);
        s = group.angular[i].mul_add(delta, s);
        total_motion += delta.abs();
    }
    total_motion.less_than(V::constant(MAX_LAST_STEP))
        & p.norm_squared().less_than(V::constant(squared_position))
        & s.norm_squared().less_than(V::constant(squared_orientation))
}
