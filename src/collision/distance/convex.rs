//! Two convex bodies: cores and the radii around them.

use super::core::{Core, Gap, Pair};
use super::{epa, gjk, round};
use crate::collision::shape::{Nearest, nearest_on_cuboid, nearest_on_cylinder};
use crate::spatial::Vector3;

/// How far they are apart; `None` where that is told to be more than `within`.
pub(crate) fn gap(pair: &Pair<'_>, radius_a: f64, radius_b: f64, within: f64) -> Option<Gap> {
    let radii = radius_a + radius_b;
    let core = match closed_form(pair) {
        Some(gap) => gap,
        None => searched(pair, within + radii)?,
    };
    Some(Gap {
        distance: core.distance - radii,
        on_a: core.on_a + core.normal * radius_a,
        on_b: core.on_b - core.normal * radius_b,
        normal: core.normal,
    })
}

fn searched(pair: &Pair<'_>, within: f64) -> Option<Gap> {
    let gap = match gjk::distance(pair, within) {
        gjk::Found::Beyond => return None,
        gjk::Found::Apart(gap) => gap,
        gjk::Found::Meeting(at) => epa::depth(pair, at),
    };
    let cylinder = |core: &Core<'_>| matches!(core, Core::Cylinder { .. });
    match cylinder(&pair.a) || cylinder(&pair.b) {
        true => Some(round::refined(pair, gap)),
        false => Some(gap),
    }
}

/// A point and another point, a segment, a box or a cylinder.
fn closed_form(pair: &Pair<'_>) -> Option<Gap> {
    let of_point = |p: Vector3<f64>, core: &Core<'_>| {
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
            Some(of_point(p, core)?.flipped(&pair.a_from_b))
        }
        (core, Core::Point(p)) => of_point(pair.a_from_b.apply(*p), core),
        _ => None,
    }
}

/// The gap of a core and a point in its coordinates. Where the point is on the surface or on a segment,
/// the core tells the way out.
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
