//! Residual of goals with free axes or dead bands.
//!
//! The orientation residual is twice the vector part of the relative quaternion, 2 sin(θ/2) n. Its components vanish
//! together only for rotations about the free axes. The sine of the whole angle, as in the full pose, would also vanish
//! at θ = π.
//!
//! Derivatives are exact. With tip position p and quaternion (w, v), a twist (u, ω) changes p by u + ω × p and 2v by w
//! ω + ω × v. The quaternion's sign does not matter: residual and derivative change sign together, and bands are
//! symmetric.

use super::evaluation::{Errors, Evaluation, WeightedResidual};
use super::lane::LaneScalar;
use super::settings::Settings;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::spatial::{Matrix3, Quaternion, Vector3};
use kinopt_solver::task::angle_of;

/// Weights the residual, and replaces the Jacobian's columns by those of the residual's derivative.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn weigh<V: LaneScalar>(
    evaluation: &Evaluation<V>,
    linear: &mut [Vector3<V>],
    angular: &mut [Vector3<V>],
    settings: &Settings,
) -> WeightedResidual<V> {
    let axes = &settings.axes;
    let p = evaluation.position;
    let quaternion = Quaternion::from_matrix(&evaluation.rotation);
    let (w, v) = (quaternion.w, quaternion.v);
    let turn = v * V::constant(2.0);
    let (p_out, p_gate) = band(p, axes.position_half_widths);
    let (r_out, r_gate) = band(turn, axes.orientation_half_widths);
    let length = settings.length_per_radian;
    let p_weight = product(Vector3::constant(axes.position_weights.into()), p_gate);
    let r_weight = product(
        Vector3::constant(axes.orientation_weights.into()) * V::constant(length),
        r_gate,
    );
    for (linear, angular) in linear.iter_mut().zip(angular) {
        let (m, z) = (*linear, *angular);
        *linear = product(m + z.cross(p), p_weight);
        *angular = product(z * w + z.cross(v), r_weight);
    }
    let p_residual = product(p_out, p_weight);
    let r_residual = product(r_out, r_weight);
    WeightedResidual {
        twice_cost: p_residual.norm_squared() + r_residual.norm_squared(),
        position: weighted_components(p_out, axes.position_weights).norm_squared(),
        orientation: weighted_components(r_out, axes.orientation_weights).norm_squared(),
        gradient: (p_residual, r_residual),
        twist: (p_residual, r_residual),
    }
}

/// Position and orientation error over the components with a weight, beyond their dead bands.
pub(crate) fn errors<S: LaneScalar>(
    position: Vector3<S>,
    rotation: &Matrix3<S>,
    settings: &Settings,
) -> Errors {
    let axes = &settings.axes;
    let turn = Quaternion::from_matrix(rotation).v * S::constant(2.0);
    let (p, _) = band(position, axes.position_half_widths);
    let (r, _) = band(turn, axes.orientation_half_widths);
    let chord = weighted_components(r, axes.orientation_weights)
        .norm()
        .lane(0);
    Errors {
        position: weighted_components(p, axes.position_weights).norm().lane(0),
        orientation: angle_of(chord),
    }
}

/// Part of `r` outside ±half width, and a gate per component: 1 outside, 0 inside.
#[cfg_attr(not(debug_assertions), inline(always))]
fn band<S: Scalar>(r: Vector3<S>, half_widths: [f64; 3]) -> (Vector3<S>, Vector3<S>) {
    let clip = |r: S, h: f64| {
        let h = S::constant(h);
        let out = r - r.max(-h).min(h);
        let inside = !(h.less_than(r.abs())) & S::zero().less_than(h);
        (
            S::select(inside, S::zero(), out),
            S::select(inside, S::zero(), S::one()),
        )
    };
    let (x, y, z) = (
        clip(r.x, half_widths[0]),
        clip(r.y, half_widths[1]),
        clip(r.z, half_widths[2]),
    );
    (Vector3::new(x.0, y.0, z.0), Vector3::new(x.1, y.1, z.1))
}

#[cfg_attr(not(debug_assertions), inline(always))]
fn product<S: Scalar>(a: Vector3<S>, b: Vector3<S>) -> Vector3<S> {
    Vector3::new(a.x * b.x, a.y * b.y, a.z * b.z)
}

/// Components whose weight is not zero; zero for the rest.
#[cfg_attr(not(debug_assertions), inline(always))]
fn weighted_components<S: Scalar>(v: Vector3<S>, weights: [f64; 3]) -> Vector3<S> {
    let gate = |v: S, w: f64| if w > 0.0 { v } else { S::zero() };
    Vector3::new(
        gate(v.x, weights[0]),
        gate(v.y, weights[1]),
        gate(v.z, weights[2]),
    )
}
