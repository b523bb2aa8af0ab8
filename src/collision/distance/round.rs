//! The last digits of distances of cylinders.
//!
//! The signed distance of convex bodies is the most that any direction's gap is: −h_B(−n) − h_A(n), with the support
//! functions h. Searches through corners approach a round one's direction by halves only, so it is solved for here:
//! a rim is a circle, a side is the axis with the radius, and of what has corners those at hand and the lines between
//! them. Where two such features are stationary gives a direction; the one with the widest gap is taken, which can
//! only be nearer to the truth.

use crate::spatial::{Placement, Vector3};

use super::core::{Core, Gap, Pair};

/// Corners within this share of the size are at hand.
const AT_HAND: f64 = 1e-4;
/// And this near a place is the one that was found.
const NEAR: f64 = 1e-3;
const NEWTON: usize = 12;
/// Of the size: gaps that differ by less are alike.
const ROUNDING: f64 = 1e-15;
/// A direction this near to straight is straight onto a face.
const FACE: f64 = 1e-9;

/// What of a body may touch.
#[derive(Clone, Copy)]
enum Feature {
    Point(Vector3<f64>),
    /// A place and a unit direction.
    Line(Vector3<f64>, Vector3<f64>),
    /// Its centre, two unit directions across each other in its plane, and the radius.
    Circle(Vector3<f64>, [Vector3<f64>; 2], f64),
}

/// Directions that are tried, and where A is touched if that is known.
type Candidate = (Vector3<f64>, Option<Vector3<f64>>);

/// The gap with the digits that its search left.
pub(super) fn refined(pair: &Pair<'_>, found: Gap) -> Gap {
    let scale = pair.scale();
    let a = features(&pair.a, &Placement::identity(), found.normal, scale);
    let b = features(&pair.b, &pair.a_from_b, -found.normal, scale);
    let flat = a.1.into_iter().chain(b.1).map(|normal| (normal, None));
    let mut candidates: Vec<Candidate> = flat.collect();
    for &on_a in &a.0 {
        for &on_b in &b.0 {
            candidates.extend(stationary(on_a, on_b, &found));
        }
    }
    // Last, as directions that are solved for have more digits where gaps are alike.
    candidates.push((found.normal, None));
    let mut best = Gap {
        distance: f64::NEG_INFINITY,
        ..found
    };
    for (normal, on_a) in candidates {
        let turned = normal.dot(found.normal) < 0.0;
        let normal = if turned { -normal } else { normal };
        let gap = pair.gap_along(normal);
        // Alike but for rounding, the earlier one stays.
        if gap > best.distance + ROUNDING * scale {
            // Another part of a face is another place; of a side the place is on the axis.
            let off = |p: Vector3<f64>| across(p - found.on_a, normal).norm();
            let near = on_a.filter(|&p| off(p) <= NEAR * scale);
            best = Gap {
                distance: gap,
                on_a: near.unwrap_or(found.on_a),
                normal,
                ..found
            };
        }
    }
    placed(pair, best)
}

/// With the places moved onto the parts of both that are farthest along the normal: first the one with less room.
fn placed(pair: &Pair<'_>, gap: Gap) -> Gap {
    let Gap {
        distance,
        on_a,
        normal,
        ..
    } = gap;
    let way = normal * distance;
    let onto_a = |p| touched(&pair.a, &Placement::identity(), normal, p);
    let onto_b = |p| touched(&pair.b, &pair.a_from_b, -normal, p);
    let (room_a, room_b) = (onto_a(on_a).0, onto_b(on_a + way).0);
    // What has more room has the last word: it does not leave the other's part any more.
    let on_a = match room_a <= room_b {
        true => onto_b(onto_a(on_a).1 + way).1 - way,
        false => onto_a(onto_b(on_a + way).1 - way).1,
    };
    Gap {
        on_a,
        on_b: on_a + way,
        ..gap
    }
}

/// The place of a core's farthest part along a direction that is next to another, and in how many directions that
/// part extends.
fn touched(
    core: &Core<'_>,
    at: &Placement<f64>,
    along: Vector3<f64>,
    near: Vector3<f64>,
) -> (usize, Vector3<f64>) {
    let Core::Cylinder { radius, half } = core else {
        // Corners, sides or faces: across them the place is as found.
        let top = at
            .apply(core.support(at.rotation.transpose_mul(along)))
            .dot(along);
        return (2, near + along * (top - near.dot(along)));
    };
    let inward = at.rotation.transpose_mul(along);
    let place = at.inverse().apply(near);
    let side = inward.x.mul_add(inward.x, inward.y * inward.y).sqrt();
    if side < FACE {
        let far = place.x.mul_add(place.x, place.y * place.y).sqrt();
        let scale = if far > *radius { radius / far } else { 1.0 };
        let on_end = Vector3::new(place.x * scale, place.y * scale, half.copysign(inward.z));
        return (2, at.apply(on_end));
    }
    let scale = radius / side;
    let z = match inward.z.abs() < FACE {
        true => place.z.clamp(-half, *half),
        false => half.copysign(inward.z),
    };
    let room = usize::from(inward.z.abs() < FACE);
    (
        room,
        at.apply(Vector3::new(inward.x * scale, inward.y * scale, z)),
    )
}

/// The features of a core that may touch along a direction, and the normals of its flat faces there.
fn features(
    core: &Core<'_>,
    at: &Placement<f64>,
    along: Vector3<f64>,
    scale: f64,
) -> (Vec<Feature>, Vec<Vector3<f64>>) {
    let corners: Vec<Vector3<f64>> = match core {
        Core::Cylinder { radius, half } => {
            let axis = at.rotation.z;
            let end = at.translation + axis * half.copysign(along.dot(axis));
            let rim = Feature::Circle(end, [at.rotation.x, at.rotation.y], *radius);
            return (vec![rim, Feature::Line(at.translation, axis)], vec![axis]);
        }
        Core::Point(p) => vec![*p],
        Core::Segment(half) => [-half, *half].map(|z| Vector3::new(0.0, 0.0, z)).to_vec(),
        Core::Triangle(corners) => corners.to_vec(),
        Core::Box(half) => (0..8_u8)
            .map(|i| {
                let side = |bit: u8, half: f64| if i & bit == 0 { half } else { -half };
                Vector3::new(side(1, half.x), side(2, half.y), side(4, half.z))
            })
            .collect(),
        Core::Hull(vertices) => vertices.to_vec(),
    };
    let mut corners: Vec<_> = corners.into_iter().map(|p| at.apply(p)).collect();
    corners.sort_by(|p, q| q.dot(along).total_cmp(&p.dot(along)));
    let least = corners[0].dot(along) - AT_HAND * scale;
    // More are no corners of one face; what they are of is round to the eye.
    corners.truncate(
        corners
            .iter()
            .take_while(|p| p.dot(along) >= least)
            .count()
            .min(6),
    );
    let mut found: Vec<_> = corners.iter().map(|&p| Feature::Point(p)).collect();
    let mut normals = Vec::new();
    for (i, &p) in corners.iter().enumerate() {
        for (j, &q) in corners.iter().enumerate().skip(i + 1) {
            let Some(direction) = unit(q - p) else {
                continue;
            };
            found.push(Feature::Line(p, direction));
            let third = corners.iter().skip(j + 1);
            normals.extend(third.filter_map(|&r| unit(direction.cross(r - p))));
        }
    }
    (found, normals)
}

/// The direction in which two features are nearest to each other, or farthest in each other, next to the one found.
fn stationary(a: Feature, b: Feature, found: &Gap) -> Option<Candidate> {
    match (a, b) {
        (Feature::Point(p), Feature::Point(q)) => Some((unit(q - p)?, Some(p))),
        (Feature::Point(p), Feature::Line(q, v)) => Some((beside(p, q, v, found)?, Some(p))),
        (Feature::Line(p, u), Feature::Point(q)) => {
            Some((beside(p, q, u, found)?, Some(foot(p, u, q))))
        }
        (Feature::Line(p, u), Feature::Line(q, v)) => {
            let common = u.cross(v);
            if common.norm() > 1e-9 {
                let along = (q - p).cross(v).dot(common) / common.norm_squared();
                return Some((unit(common)?, Some(p + u * along)));
            }
            Some((beside(p, q, u, found)?, None))
        }
        (Feature::Circle(..), Feature::Circle(..)) => circles(a, b, found),
        (Feature::Circle(..), _) => circle(a, b, found.normal).map(|(n, on)| (n, Some(on))),
        (Feature::Point(p), Feature::Circle(..)) => {
            circle(b, a, -found.normal).map(|(normal, _)| (normal, Some(p)))
        }
        (Feature::Line(p, u), Feature::Circle(..)) => {
            circle(b, a, -found.normal).map(|(normal, on_b)| (normal, Some(foot(p, u, on_b))))
        }
    }
}

/// The direction between two lines along `u` through two places; of one line the way that was found, or any.
fn beside(p: Vector3<f64>, q: Vector3<f64>, u: Vector3<f64>, found: &Gap) -> Option<Vector3<f64>> {
    // Twice, as what is left of a long offset is rounding along the line, too.
    let square = |v: Vector3<f64>| {
        let once = unit(across(v, u))?;
        let twice = across(once, u);
        if twice.norm() > 0.9 {
            unit(twice)
        } else {
            None
        }
    };
    square(q - p).or_else(|| square(found.normal))
}

/// The place of a line next to another.
fn foot(p: Vector3<f64>, along: Vector3<f64>, q: Vector3<f64>) -> Vector3<f64> {
    p + along * (q - p).dot(along)
}

/// A circle and a line or a place: by Newton's method on the angle, the line's part of the offset left out.
fn circle(
    round: Feature,
    flat: Feature,
    along: Vector3<f64>,
) -> Option<(Vector3<f64>, Vector3<f64>)> {
    let (place, line) = match flat {
        Feature::Line(place, line) => (place, Some(line)),
        Feature::Point(place) => (place, None),
        Feature::Circle(..) => return None,
    };
    let free = |v: Vector3<f64>| line.map_or(v, |line| across(v, line));
    let mut on = OnCircle::toward(round, along)?;
    for _ in 0..NEWTON {
        let offset = free(on.place() - place);
        let (turn, bend) = (on.tangent(), on.bend());
        let slope = offset.dot(turn);
        let curvature = free(turn).norm_squared() + offset.dot(bend);
        if curvature == 0.0 {
            break;
        }
        on.turn((-slope / curvature).clamp(-0.3, 0.3));
    }
    let offset = free(on.place() - place);
    let normal =
        crossing(on.tangent(), line.unwrap_or_else(Vector3::zero)).or_else(|| unit(offset))?;
    Some((normal, on.place()))
}

/// Two circles: by Newton's method on both angles.
fn circles(a: Feature, b: Feature, found: &Gap) -> Option<Candidate> {
    let mut on_a = OnCircle::toward(a, found.normal)?;
    let mut on_b = OnCircle::toward(b, -found.normal)?;
    for _ in 0..NEWTON {
        let offset = on_a.place() - on_b.place();
        let (turn_a, turn_b) = (on_a.tangent(), on_b.tangent());
        let slope = [offset.dot(turn_a), -offset.dot(turn_b)];
        let own_a = turn_a.norm_squared() + offset.dot(on_a.bend());
        let own_b = turn_b.norm_squared() - offset.dot(on_b.bend());
        let both = -turn_a.dot(turn_b);
        let determinant = own_a * own_b - both * both;
        if determinant == 0.0 {
            break;
        }
        let step_a = (both * slope[1] - own_b * slope[0]) / determinant;
        let step_b = (both * slope[0] - own_a * slope[1]) / determinant;
        on_a.turn(step_a.clamp(-0.3, 0.3));
        on_b.turn(step_b.clamp(-0.3, 0.3));
    }
    let offset = on_b.place() - on_a.place();
    let normal = crossing(on_a.tangent(), on_b.tangent()).or_else(|| unit(offset))?;
    Some((normal, Some(on_a.place())))
}

/// The unit direction across two that cross each other well, which does not lose digits with the distance.
fn crossing(u: Vector3<f64>, v: Vector3<f64>) -> Option<Vector3<f64>> {
    let common = u.cross(v);
    let fine = common.norm() > 0.1 * u.norm() * v.norm() && common.norm() > 0.0;
    if fine { unit(common) } else { None }
}

/// A place on a circle by cosine and sine.
#[derive(Clone, Copy)]
struct OnCircle {
    centre: Vector3<f64>,
    axes: [Vector3<f64>; 2],
    radius: f64,
    cos: f64,
    sin: f64,
}

impl OnCircle {
    /// The place that is farthest along a direction.
    fn toward(circle: Feature, along: Vector3<f64>) -> Option<Self> {
        let Feature::Circle(centre, axes, radius) = circle else {
            return None;
        };
        let [x, y] = axes.map(|axis| axis.dot(along));
        let length = x.mul_add(x, y * y).sqrt();
        let (cos, sin) = if length > 0.0 {
            (x / length, y / length)
        } else {
            (1.0, 0.0)
        };
        Some(Self {
            centre,
            axes,
            radius,
            cos,
            sin,
        })
    }

    fn place(&self) -> Vector3<f64> {
        self.centre - self.bend()
    }

    /// The place's derivative by the angle.
    fn tangent(&self) -> Vector3<f64> {
        let [x, y] = self.axes;
        (y * self.cos - x * self.sin) * self.radius
    }

    /// Its second derivative.
    fn bend(&self) -> Vector3<f64> {
        let [x, y] = self.axes;
        (x * self.cos + y * self.sin) * -self.radius
    }

    /// By a small angle, to third order and back onto the circle: near enough for steps that become nothing.
    fn turn(&mut self, by: f64) {
        let (cos, sin) = (1.0 - 0.5 * by * by, by - by * by * by / 6.0);
        let (x, y) = (
            self.cos * cos - self.sin * sin,
            self.sin * cos + self.cos * sin,
        );
        let scale = x.mul_add(x, y * y).sqrt().recip();
        (self.cos, self.sin) = (x * scale, y * scale);
    }
}

/// What is left of a vector without its part along a unit direction.
fn across(v: Vector3<f64>, along: Vector3<f64>) -> Vector3<f64> {
    v - along * v.dot(along)
}

fn unit(v: Vector3<f64>) -> Option<Vector3<f64>> {
    let length = v.norm();
    (length > 0.0).then(|| v * length.recip())
}
