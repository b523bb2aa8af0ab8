//! Height of obstacles along a line.

use super::{Obstacle, World};
use crate::bisection::bisect;
use crate::collision::distance::separation_within;
use crate::collision::shape::{Shape, ShapeKind};
use crate::spatial::{Matrix3, Placement, Vector3};

/// Radius of the probe line, relative to the height of all obstacles.
const LINE: f64 = 1e-9;
/// Number of bisections of that height: to full precision.
const HALVINGS: usize = 60;

impl World {
    /// Height of the topmost obstacle on the line through `at` along `up`, a unit vector.
    ///
    /// The height is measured along `up` from the world's origin, in metres, to 1e-9 of the height of all obstacles.
    /// `None` if no obstacle is on the line. Attached obstacles are ignored. A line on the edge of an obstacle meets
    /// it.
    #[must_use]
    pub fn height_at(&self, at: Vector3<f64>, up: Vector3<f64>) -> Option<f64> {
        let foot = at - up * at.dot(up);
        let standing = || {
            self.obstacles()
                .filter(|obstacle| obstacle.attached.is_none())
        };
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        for obstacle in standing() {
            if let Some([low, high]) = heights(obstacle, foot, up) {
                (lowest, highest) = (lowest.min(low), highest.max(high));
            }
        }
        let range = (highest - lowest).max(highest.abs()).max(lowest.abs());
        if !(range > 0.0 && range.is_finite()) {
            return None;
        }
        // Bisects the lowest end of a collision-free line from above.
        let turned = turned_to(up);
        let is_free = |from: f64, to: f64| {
            let Ok(line) = Shape::capsule(LINE * range, (to - from).max(LINE * range)) else {
                return false;
            };
            let place = Placement::new(turned, foot + up * (0.5 * (from + to)));
            !standing().any(|obstacle| {
                let (shape, stands) = (&obstacle.shape, &obstacle.placement);
                separation_within(&line, &place, shape, stands, 0.0).is_some()
            })
        };
        let (bottom, above) = (lowest - range, highest + range);
        if is_free(bottom, above) || !is_free(highest + 0.5 * range, above) {
            return None;
        }
        let free = highest + 0.5 * range;
        Some(bisect(free, bottom, HALVINGS, |from| is_free(from, above)))
    }
}

/// Bounds of an obstacle's height. For a half-space, both are the height at which the line meets it.
fn heights(obstacle: &Obstacle, foot: Vector3<f64>, up: Vector3<f64>) -> Option<[f64; 2]> {
    let stands = &obstacle.placement;
    if let ShapeKind::HalfSpace = obstacle.shape.kind() {
        let normal = stands.rotation * Vector3::UNITS[2];
        let height = (stands.translation - foot).dot(normal) / normal.dot(up);
        return height.is_finite().then_some([height; 2]);
    }
    let ball = obstacle.shape.bounding_sphere();
    let middle = stands.apply(ball.centre).dot(up);
    Some([middle - ball.radius, middle + ball.radius])
}

/// A rotation whose z axis is `up`.
fn turned_to(up: Vector3<f64>) -> Matrix3<f64> {
    let [x, y, _] = Vector3::UNITS;
    let across = if up.x.abs() < 0.9 { x } else { y };
    let second = up.cross(across);
    let second = second * (1.0 / second.norm());
    Matrix3::from_columns(second.cross(up), second, up)
}
