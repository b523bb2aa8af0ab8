//! Stationary distance between pairs of features: corners, lines and circles.

use super::core_and_radius::Gap;
use kinopt_kinematics::spatial::Vector3;

/// Iterations of Newton's method.
const NEWTON_STEPS: usize = 12;

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

/// The direction along which the distance of two features is stationary, near the direction of `estimate`.
pub(super) fn stationary(a: Feature, b: Feature, estimate: &Gap) -> Option<Candidate> {
    match (a, b) {
        (Feature::Point(p), Feature::Point(q)) => Some((unit(q - p)?, Some(p))),
        (Feature::Point(p), Feature::Line(q, v)) => {
            Some((between_parallels(p, q, v, estimate)?, Some(p)))
        }
        (Feature::Line(p, u), Feature::Point(q)) => {
            Some((between_parallels(p, q, u, estimate)?, Some(foot(p, u, q))))
        }
        (Feature::Line(p, u), Feature::Line(q, v)) => {
            let common = u.cross(v);
            if common.norm() > 1e-9 {
                let along = (q - p).cross(v).dot(common) / common.norm_squared();
                return Some((unit(common)?, Some(p + u * along)));
            }
            Some((between_parallels(p, q, u, estimate)?, None))
        }
        (Feature::Circle(..), Feature::Circle(..)) => circles(a, b, estimate),
        (Feature::Circle(..), _) => circle(a, b, estimate.normal).map(|(n, on)| (n, Some(on))),
        (Feature::Point(p), Feature::Circle(..)) => {
            circle(b, a, -estimate.normal).map(|(normal, _)| (normal, Some(p)))
        }
        (Feature::Line(p, u), Feature::Circle(..)) => {
            circle(b, a, -estimate.normal).map(|(normal, on_b)| (normal, Some(foot(p, u, on_b))))
        }
    }
}

/// The direction between two parallel lines along `u` through two points.
///
/// If the lines coincide, it is the direction of `estimate`. `None` if that is along `u`.
fn between_parallels(
    p: Vector3<f64>,
    q: Vector3<f64>,
    u: Vector3<f64>,
    estimate: &Gap,
) -> Option<Vector3<f64>> {
    // Projected twice: the first projection of a long offset leaves rounding along the line.
    let perpendicular = |v: Vector3<f64>| {
        let projected = unit(across(v, u))?;
        let projected_twice = across(projected, u);
        if projected_twice.norm() > 0.9 {
            unit(projected_twice)
        } else {
            None
        }
    };
    perpendicular(q - p).or_else(|| perpendicular(estimate.normal))
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
    let (point, line) = match flat {
        Feature::Line(point, line) => (point, Some(line)),
        Feature::Point(point) => (point, None),
        Feature::Circle(..) => return None,
    };
    let free = |v: Vector3<f64>| line.map_or(v, |line| across(v, line));
    let mut circle_point = CirclePoint::toward(round, along)?;
    for _ in 0..NEWTON_STEPS {
        let offset = free(circle_point.position() - point);
        let (tangent, second_derivative) =
            (circle_point.tangent(), circle_point.second_derivative());
        let slope = offset.dot(tangent);
        let curvature = free(tangent).norm_squared() + offset.dot(second_derivative);
        if curvature == 0.0 {
            break;
        }
        circle_point.rotate((-slope / curvature).clamp(-0.3, 0.3));
    }
    let offset = free(circle_point.position() - point);
    let normal = crossing(circle_point.tangent(), line.unwrap_or_else(Vector3::zero))
        .or_else(|| unit(offset))?;
    Some((normal, circle_point.position()))
}

/// Two circles, by Newton's method on both angles.
fn circles(a: Feature, b: Feature, estimate: &Gap) -> Option<Candidate> {
    let mut on_a = CirclePoint::toward(a, estimate.normal)?;
    let mut on_b = CirclePoint::toward(b, -estimate.normal)?;
    for _ in 0..NEWTON_STEPS {
        let offset = on_a.position() - on_b.position();
        let (tangent_a, tangent_b) = (on_a.tangent(), on_b.tangent());
        let slope = [offset.dot(tangent_a), -offset.dot(tangent_b)];
        let diagonal_a = tangent_a.norm_squared() + offset.dot(on_a.second_derivative());
        let diagonal_b = tangent_b.norm_squared() - offset.dot(on_b.second_derivative());
        let off_diagonal = -tangent_a.dot(tangent_b);
        let determinant = diagonal_a * diagonal_b - off_diagonal * off_diagonal;
        if determinant == 0.0 {
            break;
        }
        let step_a = (off_diagonal * slope[1] - diagonal_b * slope[0]) / determinant;
        let step_b = (off_diagonal * slope[0] - diagonal_a * slope[1]) / determinant;
        on_a.rotate(step_a.clamp(-0.3, 0.3));
        on_b.rotate(step_b.clamp(-0.3, 0.3));
    }
    let offset = on_b.position() - on_a.position();
    let normal = crossing(on_a.tangent(), on_b.tangent()).or_else(|| unit(offset))?;
    Some((normal, Some(on_a.position())))
}

/// Unit vector perpendicular to two vectors at a large angle. It keeps its accuracy at small distances.
fn crossing(u: Vector3<f64>, v: Vector3<f64>) -> Option<Vector3<f64>> {
    let common = u.cross(v);
    let is_accurate = common.norm() > 0.1 * u.norm() * v.norm() && common.norm() > 0.0;
    if is_accurate { unit(common) } else { None }
}

/// A point on a circle, given by cosine and sine.
#[derive(Clone, Copy)]
struct CirclePoint {
    centre: Vector3<f64>,
    axes: [Vector3<f64>; 2],
    radius: f64,
    cos: f64,
    sin: f64,
}

impl CirclePoint {
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

    fn position(&self) -> Vector3<f64> {
        self.centre - self.second_derivative()
    }

    /// Derivative of the point by the angle.
    fn tangent(&self) -> Vector3<f64> {
        let [x, y] = self.axes;
        (y * self.cos - x * self.sin) * self.radius
    }

    /// Second derivative of the point by the angle.
    fn second_derivative(&self) -> Vector3<f64> {
        let [x, y] = self.axes;
        (x * self.cos + y * self.sin) * -self.radius
    }

    /// Rotates by a small angle, to third order, and normalises. The error vanishes with the Newton step.
    fn rotate(&mut self, angle: f64) {
        let (cos, sin) = (
            1.0 - 0.5 * angle * angle,
            angle - angle * angle * angle / 6.0,
        );
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
