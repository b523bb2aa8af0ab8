//! Signed distance of two convex bodies, given as cores with radii.

use super::core_and_radius::{Core, Corner, Gap, Pair};
use super::{cylinder_refinement, epa, gjk};
use crate::collision::shape::{Nearest, nearest_on_cuboid, nearest_on_cylinder};
use kinopt_kinematics::spatial::Vector3;

/// Tolerance between the upper bound of a distance and the lower bound along the normal, relative to the pair's scale.
const BOUND_TOLERANCE: f64 = 1e-13;

/// The signed distance. `None` if the search finds that it is more than `max_distance`.
pub(crate) fn gap(pair: &Pair<'_>, radius_a: f64, radius_b: f64, max_distance: f64) -> Option<Gap> {
    let radii = radius_a + radius_b;
    let core = match closed_form(pair) {
        Some(gap) => gap,
        None => iterative(pair, max_distance + radii)?,
    };
    Some(Gap {
        distance: core.distance - radii,
        on_a: core.on_a + core.normal * radius_a,
        on_b: core.on_b - core.normal * radius_b,
        normal: core.normal,
    })
}

fn iterative(pair: &Pair<'_>, max_distance: f64) -> Option<Gap> {
    let cylinder = |core: &Core<'_>| matches!(core, Core::Cylinder { .. });
    let has_cylinder = cylinder(&pair.a) || cylinder(&pair.b);
    let refined = |gap: Gap| match has_cylinder {
        true => cylinder_refinement::refined(pair, gap),
        false => gap,
    };
    let separated = match gjk::distance(pair, max_distance) {
        gjk::GjkResult::Beyond => return None,
        gjk::GjkResult::Contact(contact) => return Some(refined(epa::depth(pair, contact))),
        gjk::GjkResult::Apart(gap) => gap,
    };
    let gap = refined(separated);
    // The distance is at most that of the two points, and at least the gap along any direction. If the bounds differ,
    // the cores nearly touch and GJK lost the direction, so EPA is tried too.
    if separated.distance - pair.gap_along(gap.normal) <= BOUND_TOLERANCE * pair.scale() {
        return Some(gap);
    }
    let contact = Corner {
        on_a: separated.on_a,
        on_b: separated.on_b,
    };
    let by_epa = refined(epa::depth(pair, contact));
    let widths = [gap, by_epa].map(|gap| pair.gap_along(gap.normal));
    Some(match widths[1] > widths[0] {
        true => by_epa,
        false => Gap {
            distance: widths[0],
            on_b: gap.on_a + gap.normal * widths[0],
            ..gap
        },
    })
}

/// Gap of a point and a point, segment, box or cylinder; `None` for other cores.
fn closed_form(pair: &Pair<'_>) -> Option<Gap> {
    let point_gap = |p: Vector3<f64>, core: &Core<'_>| {
        let (distance, on_core) = match core {
            Core::Point(q) => ((p - *q).norm(), *q),
            Core::Segment(half) => {
                let foot = Vector3::new(0.0, 0.0, p.z.clamp(-half, *half));
                ((p - foot).norm(), foot)
            }
            Core::Box(half) => nearest_on_cuboid(p, *half),
            Core::Cylinder { radius, half } => nearest_on_cylinder(p, *radius, *half),
            _ => return None,
        };
        Some(from_point(p, core, (distance, on_core)))
    };
    match (&pair.a, &pair.b) {
        (Core::Point(p), core) => {
            let p = pair.a_from_b.inverse().apply(*p);
            Some(point_gap(p, core)?.flipped(&pair.a_from_b))
        }
        (core, Core::Point(p)) => point_gap(pair.a_from_b.apply(*p), core),
        _ => None,
    }
}

/// The gap of a core and a point in the core's frame.
///
/// If the point is on the surface or on a segment, the core defines the normal.
fn from_point(p: Vector3<f64>, core: &Core<'_>, (distance, on_a): Nearest) -> Gap {
    let offset = (p - on_a) * distance.signum();
    let length = offset.norm();
    let normal = match length > 0.0 {
        true => offset * length.recip(),
        false => core.outward(p),
    };
    Gap {
        distance,
        on_a,
        on_b: p,
        normal,
    }
}
