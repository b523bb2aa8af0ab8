//! The distance of convex cores that are apart, by Gilbert, Johnson and Keerthi (1988).

use crate::spatial::Vector3;

use super::core_and_radius::{Corner, Gap, Pair};
use super::simplex::Simplex;

/// Of both, round ones included: flat ones need a dozen.
const ITERATIONS: usize = 200;
/// Of the size of both: what rounding leaves of a distance.
const ROUNDING: f64 = 4e-16;
/// Of the size of both: nearer than this the distance's direction is rounding, and faces tell it better.
const TOUCHING: f64 = 1e-12;

/// Of the size of both: farther beyond what was asked for than going from corner to corner may lose to rounding.
const SURELY: f64 = 1e-9;

/// What became of a search.
pub(super) enum Found {
    /// Apart, by as much.
    Apart(Gap),
    /// Farther apart than was asked for.
    Beyond,
    /// Touching or overlapping, here.
    Meeting(Corner),
}

/// The distance of two cores, or that it is more than `most`.
pub(super) fn distance(pair: &Pair<'_>, most: f64) -> Found {
    let scale = pair.scale();
    let toward = pair.middle();
    let toward = if toward.norm_squared() > 0.0 {
        toward
    } else {
        Vector3::UNITS[0]
    };
    let climbed = pair.is_climbed();
    let mut simplex = Simplex::point(pair.support_nearly(-toward));
    let mut apart = f64::INFINITY;
    for _ in 0..ITERATIONS {
        let nearest = simplex.nearest();
        let offset = nearest.difference();
        let length = offset.norm();
        if length <= TOUCHING * scale {
            return Found::Meeting(nearest);
        }
        // Rounding alone is left where it falls no further.
        let stuck = length >= apart;
        apart = length;
        let normal = face_normal(&simplex, offset);
        let mut corner = pair.support_nearly(-normal);
        // No point of A − B is nearer than the plane through the farthest corner against the way.
        let mut least = corner.difference().dot(normal);
        if least > most + SURELY * scale {
            return Found::Beyond;
        }
        let settled = |corner: &Corner, least: f64| {
            stuck || length - least <= ROUNDING * scale || simplex.corners().contains(corner)
        };
        if climbed && (least > most || settled(&corner, least)) {
            corner = pair.support(-normal);
            least = corner.difference().dot(normal);
        }
        if least > most {
            return Found::Beyond;
        }
        if settled(&corner, least) {
            return Found::Apart(Gap {
                distance: length,
                on_a: nearest.on_a,
                on_b: nearest.on_b,
                normal: -normal,
            });
        }
        simplex = simplex.with(corner);
        if simplex.corners().len() == 4 {
            return Found::Meeting(simplex.nearest());
        }
    }
    let nearest = simplex.nearest();
    let offset = nearest.difference();
    Found::Apart(Gap {
        distance: offset.norm(),
        on_a: nearest.on_a,
        on_b: nearest.on_b,
        normal: -face_normal(&simplex, offset),
    })
}

/// The unit direction of `offset`; where a triangle is nearest its own normal, which does not lose digits with the
/// distance.
fn face_normal(simplex: &Simplex, offset: Vector3<f64>) -> Vector3<f64> {
    let direction = offset * offset.norm().recip();
    if let [a, b, c] = simplex.corners() {
        let sides = [b, c].map(|corner| corner.difference() - a.difference());
        let normal = sides[0].cross(sides[1]);
        let area = normal.norm();
        // Of slivers, as round bodies make, the offset tells more.
        if area > 1e-4 * sides[0].norm() * sides[1].norm() {
            let normal = normal * area.recip();
            let normal = if normal.dot(direction) < 0.0 {
                -normal
            } else {
                normal
            };
            if normal.dot(direction) > 0.9 {
                return normal;
            }
        }
    }
    direction
}
