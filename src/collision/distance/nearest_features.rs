//! Stationary distance between pairs of features: corners, lines and circles.

use super::core_and_radius::Gap;
use crate::spatial::Vector3;

/// Iterations of Newton's method.
const NEWTON: usize = 12;

/// A feature of a body that may be in contact.
#[derive(Clone, Copy)]
pub(super) enum Feature {
    Point(Vector3<f64>),
    /// A point and a unit direction.
    Line(Vector3<f64>, Vector3<f64>),
    /// Centre, two perpendicular unit vectors in the plane, and radius.
    Circle(Vector3<f64>, [Vector3<f64>; 2], f64),
}

/// A direction to try, and the contact point on A if it is known.
pub(super) type Candidate = (Vector3<f64>, Option<Vector3<f64>>);

/// The direction along which the distance of two features is stationary, near the direction of `found`.
pub(super) fn stationary(a: Feature, b: Feature, found: &Gap) -> Option<Candidate> {
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

/// The direction between two parallel lines along `u` through two points.
///
/// If the lines coincide, it is the direction of `found`. `None` if that is along `u`.
fn beside(p: Vector3<f64>, q: Vector3<f64>, u: Vector3<f64>, found: &Gap) -> Option<Vector3<f64>> {
    // Projected twice: the first projection of a long offset leaves rounding along the line.
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

/// The point of a line that is closest to a point `q`.
fn foot(p: Vector3<f64>, along: Vector3<f64>, q: Vector3<f64>) -> Vector3<f64> {
    p + along * (q - p).dot(along)
}

/// A circle and a line or point, by Newton's method on the angle. The offset excludes its part along the line.
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

/// Two circles, by Newton's method on both angles.
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

/// Unit vector perpendicular to two vectors at a large angle. It keeps its accuracy at small distances.
fn crossing(u: Vector3<f64>, v: Vector3<f64>) -> Option<Vector3<f64>> {
    let common = u.cross(v);
    let fine = common.norm() > 0.1 * u.norm() * v.norm() && common.norm() > 0.0;
    if fine { unit(common) } else { None }
}

/// A point on a circle, given by cosine and sine.
#[derive(Clone, Copy)]
struct OnCircle {
    centre: Vector3<f64>,
    axes: [Vector3<f64>; 2],
    radius: f64,
    cos: f64,
    sin: f64,
}

impl OnCircle {
    /// The point that is farthest along a direction.
    fn toward(circle: Feature, along: Vector3<f64>) -> Option<Self> {
        let Feature::Circle(centre, axes, radius) = circle else {
            return None;
        };
        let [x, y] = axes.map(|axis| axis.dot(along));
        let length = (x * x + y * y).sqrt();
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

    /// Derivative of the point by the angle.
    fn tangent(&self) -> Vector3<f64> {
        let [x, y] = self.axes;
        (y * self.cos - x * self.sin) * self.radius
    }

    /// Second derivative of the point by the angle.
    fn bend(&self) -> Vector3<f64> {
        let [x, y] = self.axes;
        (x * self.cos + y * self.sin) * -self.radius
    }

    /// Rotates by a small angle, to third order, and normalises. The error vanishes with the Newton step.
    fn turn(&mut self, by: f64) {
        let (cos, sin) = (1.0 - 0.5 * by * by, by - by * by * by / 6.0);
        let (x, y) = (
            self.cos * cos - self.sin * sin,
            self.sin * cos + self.cos * sin,
        );
        let scale = (x * x + y * y).sqrt().recip();
        (self.cos, self.sin) = (x * scale, y * scale);
    }
}

/// The component of a vector perpendicular to a unit direction.
pub(super) fn across(v: Vector3<f64>, along: Vector3<f64>) -> Vector3<f64> {
    v - along * v.dot(along)
}

pub(super) fn unit(v: Vector3<f64>) -> Option<Vector3<f64>> {
    let length = v.norm();
    (length > 0.0).then(|| v * length.recip())
}
