//! Residual of the full pose.

use super::evaluation::{Evaluation, WeightedResidual};
use super::lane::LaneScalar;
use kinopt_kinematics::spatial::Vector3;

/// Computes the residual of the full pose; `weight` is the squared length of the solver per radian.
#[cfg_attr(not(debug_assertions), inline(always))]
pub(crate) fn weigh<V: LaneScalar>(evaluation: &Evaluation<V>, weight: f64) -> WeightedResidual<V> {
    let c = V::constant;
    let (p, r) = (evaluation.position, &evaluation.rotation);
    let half = c(0.5);
    let s = Vector3::new(
        (r.y.z - r.z.y) * half,
        (r.z.x - r.x.z) * half,
        (r.x.y - r.y.x) * half,
    );
    let cos = (r.x.x + r.y.y + r.z.z - V::one()) * half;
    let (pp, ss) = (p.norm_squared(), s.norm_squared());
    // A series of 2(1 − cos θ) in sin² θ for small θ, where the difference would cancel.
    let series = ss.mul_add(c(5.0 / 64.0), c(1.0 / 8.0));
    let series = ss.mul_add(ss.mul_add(series, c(0.25)), V::one()) * ss;
    let near = ss.less_than(c(1e-3)) & V::zero().less_than(cos);
    let turned = V::select(near, series, (V::one() - cos) * c(2.0));
    WeightedResidual {
        twice_cost: turned.mul_add(c(weight), pp),
        position: pp,
        orientation: turned,
        gradient: (p, s * c(weight)),
        twist: (p + p.cross(s) * half, s),
    }
}
