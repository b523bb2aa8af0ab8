//! Height of obstacles along a line.

use super::{Obstacle, World};
use crate::collision::distance::separation_within;
use crate::collision::shape::{Shape, ShapeKind};
use kinopt_kinematics::bisection::bisect;
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3};

/// Radius of the probe line, relative to the height of all obstacles.
const RELATIVE_LINE_RADIUS: f64 = 1e-9;
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
        let fixed_obstacles = || {
            self.obstacles()
                .filter(|obstacle| obstacle.attached.is_none())
        };
        let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
        for obstacle in fixed_obstacles() {
            if let Some([low, high]) = heights(obstacle, foot, up) {
                (lowest, highest) = (lowest.min(low), highest.max(high));
            }
        }
        let range = (highest - lowest).max(highest.abs()).max(lowest.abs());
        if !(range > 0.0 && range.is_finite()) {
            return None;
        }
        // Bisects the lowest end of a collision-free line from above.
        let rotation = rotation_with_z(up);
        let is_free = |from: f64, to: f64| {
            let Ok(line) = Shape::capsule(
                RELATIVE_LINE_RADIUS * range,
                (to - from).max(RELATIVE_LINE_RADIUS * range),
            ) else {
                return false;
            };
            let placement = Placement::new(rotation, foot + up * (0.5 * (from + to)));
            !fixed_obstacles().any(|obstacle| {
                let (shape, obstacle_placement) = (&obstacle.shape, &obstacle.placement);
                separation_within(&line, &placement, shape, obstacle_placement, 0.0).is_some()
            })
        };
        let (bottom, top) = (lowest - range, highest + range);
        if is_free(bottom, top) || !is_free(highest + 0.5 * range, top) {
            return None;
        }
        let highest_free = highest + 0.5 * range;
        Some(bisect(highest_free, bottom, HALVINGS, |from| {
            is_free(from, top)
        }))
    }
}

/// Bounds of an obstacle's height. For a half-space, both are the height at which the line meets it.
fn heights(obstacle: &Obstacle, foot: Vector3<f64>, up: Vector3<f64>) -> Option<[f64; 2]> {
    let placement = &obstacle.placement;
    if let ShapeKind::HalfSpace = obstacle.shape.kind() {
        let normal = placement.rotation * Vector3::UNITS[2];
        let height = (placement.translation - foot).dot(normal) / normal.dot(up);
        return height.is_finite().then_some([height; 2]);
    }
    let ball = obstacle.shape.bounding_sphere();
    let centre_height = placement.apply(ball.centre).dot(up);
    Some([centre_height - ball.radius, centre_height + ball.radius])
}

/// A rotation whose z axis is `up`.
fn rotation_with_z(up: Vector3<f64>) -> Matrix3<f64> {
    let [x, y, _] = Vector3::UNITS;
    let across = if up.x.abs() < 0.9 { x } else { y };
    let second = up.cross(across);
    let second = second * (1.0 / second.norm());
    Matrix3::from_columns(second.cross(up), second, up)
}
