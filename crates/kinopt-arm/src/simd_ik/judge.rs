//! Errors of the returned configuration, by forward kinematics at that configuration.

use super::axis_residual;
use super::evaluation::Errors;
use super::lane::LaneScalar;
use super::links::Links;
use super::prepared::Prepared;
use super::settings::Settings;
use kinopt_kinematics::scalar::Scalar;
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3, resolved};

/// Checks a final configuration in the solver's units against the tolerances.
///
/// Returns true if it is within them, and its errors in metres and radians.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn judge<V: LaneScalar, const N: usize>(
    prepared: &Prepared,
    goal_from_first: &Placement<f64>,
    q: &[f64],
) -> (bool, Errors) {
    let links = &prepared.links;
    let mut errors = errors::<V, N>(links, &prepared.settings, goal_from_first, q);
    errors.position *= links.metres_per_length;
    // NaN arises from overflow, far from the goal.
    if errors.position.is_nan() {
        errors.position = f64::INFINITY;
    }
    let options = &prepared.options;
    // Rounding is small, and only decides errors near a tolerance.
    let is_clear = errors.position <= 0.5 * options.position_tolerance
        && errors.orientation <= 0.5 * options.orientation_tolerance;
    if prepared.needs_resolution || !is_clear {
        let (metres, radians) = links.resolution(q.iter().map(|q| q.abs()));
        errors.position = resolved(errors.position, metres, options.position_tolerance);
        errors.orientation = resolved(errors.orientation, radians, options.orientation_tolerance);
    }
    let reached = errors.position <= options.position_tolerance
        && errors.orientation <= options.orientation_tolerance;
    (reached, errors)
}

/// Position error in lengths of the solver and orientation error in radians at `q`.
#[cfg_attr(not(debug_assertions), inline(always))]
fn errors<V: LaneScalar, const N: usize>(
    links: &Links,
    settings: &Settings,
    goal_from_first: &Placement<f64>,
    q: &[f64],
) -> Errors {
    // Sines and cosines of four joints at a time.
    let mut sin_cos = [(0.0, 1.0); N];
    for ((out, q), links) in sin_cos
        .chunks_mut(4)
        .zip(q.chunks(4))
        .zip(links.links.chunks(4))
    {
        let mut angle = V::Four::zero();
        for (i, (q, link)) in q.iter().zip(links).enumerate() {
            let turn = if link.kind.turns() { *q } else { 0.0 };
            angle.set_lane(i, turn + link.offset);
        }
        let (sin, cos) = angle.sin_cos();
        for (i, out) in out.iter_mut().enumerate() {
            *out = (sin.lane(i), cos.lane(i));
        }
    }
    let c = V::One::constant;
    let mut r = Matrix3::<V::One>::constant(goal_from_first.rotation);
    let mut p = Vector3::<V::One>::constant(goal_from_first.translation);
    for ((link, &q), &(sin, cos)) in links.links.iter().zip(q).zip(&sin_cos) {
        if link.kind.slides() {
            p = r.z.mul_add(c(q), p);
        }
        r = r.rotated_about_z((c(sin), c(cos)));
        p =
            r.x.mul_add(c(link.along_x), r.y.mul_add(c(link.along_y), p));
        r = r.rotated_about_x((c(link.twist.0), c(link.twist.1)));
    }
    if settings.weighted {
        r = r * Matrix3::constant(links.last_from_tip);
        return axis_residual::errors(p, &r, settings);
    }
    let skew = Vector3::new(r.y.z - r.z.y, r.z.x - r.x.z, r.x.y - r.y.x);
    let sin = 0.5 * skew.norm().lane(0);
    let cos = 0.5 * ((r.x.x + r.y.y + r.z.z).lane(0) - 1.0);
    let orientation = if cos > 0.0 && sin < 1e-3 {
        // Series of the arc sine; the next term is below 1e-22.
        let s = sin * sin;
        sin * (1.0 + s * (1.0 / 6.0 + s * (3.0 / 40.0)))
    } else {
        elementary::atan2(sin, cos)
    };
    Errors {
        position: p.norm().lane(0),
        orientation,
    }
}
