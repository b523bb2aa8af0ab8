//! Joint axes of a chain at zero joint values, and their products of exponentials.

use super::angle::Angle;
use kinopt_kinematics::spatial::{Matrix3, Placement, Vector3};

/// Axis of a revolute joint in the base frame, at zero joint values.
#[derive(Clone, Copy, Debug)]
pub(super) struct Screw {
    /// Unit direction.
    pub(super) direction: Vector3<f64>,
    /// A point of the axis, in lengths of the arm.
    pub(super) point: Vector3<f64>,
}

impl Screw {
    /// Rotates a direction about the axis.
    pub(super) fn rotate(&self, v: Vector3<f64>, angle: Angle) -> Vector3<f64> {
        let h = self.direction;
        let along = h * h.dot(v);
        along + (v - along) * angle.cos + h.cross(v) * angle.sin
    }

    /// Rotates a point about the axis.
    pub(super) fn move_point(&self, x: Vector3<f64>, angle: Angle) -> Vector3<f64> {
        self.point + self.rotate(x - self.point, angle)
    }

    /// Displacement of a rotation about the axis.
    pub(super) fn displacement(&self, angle: Angle) -> Placement<f64> {
        let rotation = Matrix3::rotation(self.direction, (angle.sin, angle.cos));
        Placement::new(rotation, self.point - rotation * self.point)
    }

    /// The axis after a displacement.
    pub(super) fn displaced(&self, by: &Placement<f64>) -> Self {
        Self {
            direction: by.rotation * self.direction,
            point: by.apply(self.point),
        }
    }

    /// The axis of the same joint of the reversed chain.
    pub(super) fn reversed(&self) -> Self {
        Self {
            direction: -self.direction,
            point: self.point,
        }
    }

    /// The part of `v` across the axis.
    pub(super) fn across(&self, v: Vector3<f64>) -> Vector3<f64> {
        v - self.direction * self.direction.dot(v)
    }

    /// The angle that rotates `from` to `to` about the axis, for directions; `None` if either lies along the axis.
    pub(super) fn angle_between(&self, from: Vector3<f64>, to: Vector3<f64>) -> Option<Angle> {
        let (from, to) = (self.across(from), self.across(to));
        let (cos, sin) = (from.dot(to), self.direction.dot(from.cross(to)));
        let length = (cos * cos + sin * sin).sqrt();
        // Squared lengths: vectors below 1e-7 lie along the axis.
        (length > 1e-14).then(|| Angle {
            cos: cos / length,
            sin: sin / length,
        })
    }
}

/// Relation of two axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Relation {
    Parallel,
    /// With the common point.
    Intersecting(Vector3<f64>),
    Skew,
}

/// Relation of two axes, with directions to `tolerance` radians and distances to `tolerance` lengths.
pub(super) fn relation(a: &Screw, b: &Screw, tolerance: f64) -> Relation {
    let normal = a.direction.cross(b.direction);
    let sin = normal.norm();
    if sin <= tolerance {
        return Relation::Parallel;
    }
    let [on_a, on_b] = common_normal(a, b);
    match (on_a - on_b).norm() <= tolerance {
        true => Relation::Intersecting((on_a + on_b) * 0.5),
        false => Relation::Skew,
    }
}

/// Feet of the common normal of two axes that are not parallel.
pub(super) fn common_normal(a: &Screw, b: &Screw) -> [Vector3<f64>; 2] {
    let (u, v, d) = (a.direction, b.direction, b.point - a.point);
    let cos = u.dot(v);
    let sin_squared = u.cross(v).norm_squared();
    let s = (u.dot(d) - cos * v.dot(d)) / sin_squared;
    let t = (cos * u.dot(d) - v.dot(d)) / sin_squared;
    [a.point + u * s, b.point + v * t]
}

/// The common point of three axes, if they meet to `tolerance`, the distance from the point.
pub(super) fn common_point(axes: &[Screw], tolerance: f64) -> Option<Vector3<f64>> {
    let [a, b, c] = axes else { return None };
    let pairs = [(a, b, c), (b, c, a), (a, c, b)];
    pairs
        .into_iter()
        .find_map(|(a, b, c)| match relation(a, b, tolerance) {
            Relation::Intersecting(point) => {
                let distance = c.across(point - c.point).norm();
                (distance <= tolerance).then_some(point)
            }
            _ => None,
        })
}
