//! Convex bodies as cores with a radius around them: a sphere is a point, a capsule a segment.

use crate::collision::bounding_box::BoundingBox;
use crate::collision::shape::{ConvexHull, ShapeKind};
use crate::spatial::{Placement, Vector3};

/// A convex body without its radius, in its own coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Core<'a> {
    /// One place.
    Point(Vector3<f64>),
    /// Along z, this far to either side.
    Segment(f64),
    Triangle([Vector3<f64>; 3]),
    /// From the middle to the sides.
    Box(Vector3<f64>),
    Cylinder {
        radius: f64,
        half: f64,
    },
    Hull(&'a ConvexHull),
}

impl<'a> Core<'a> {
    /// Of a shape that is convex and bounded, with the radius around it.
    pub(crate) fn of(kind: &'a ShapeKind) -> Option<(Self, f64)> {
        Some(match kind {
            ShapeKind::Sphere { radius } => (Self::Point(Vector3::zero()), *radius),
            ShapeKind::Capsule { radius, length } => (Self::Segment(0.5 * length), *radius),
            ShapeKind::Cylinder { radius, length } => {
                let half = 0.5 * length;
                let radius = *radius;
                (Self::Cylinder { radius, half }, 0.0)
            }
            ShapeKind::Cuboid { size } => (Self::Box(Vector3::from(*size) * 0.5), 0.0),
            ShapeKind::Convex(hull) => (Self::Hull(hull), 0.0),
            _ => return None,
        })
    }

    /// A point of it that is farthest along a direction.
    pub(crate) fn support(&self, along: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Point(at) => *at,
            Self::Segment(half) => Vector3::new(0.0, 0.0, half.copysign(along.z)),
            Self::Triangle(corners) => farthest(corners, along),
            Self::Box(half) => Vector3::new(
                half.x.copysign(along.x),
                half.y.copysign(along.y),
                half.z.copysign(along.z),
            ),
            Self::Cylinder { radius, half } => {
                let across = (along.x * along.x + along.y * along.y).sqrt();
                // Straight along the axis any point of the disc is as far.
                let scale = if across > 0.0 { radius / across } else { 0.0 };
                Vector3::new(along.x * scale, along.y * scale, half.copysign(along.z))
            }
            Self::Hull(hull) => hull.farthest(along),
        }
    }

    /// The same, or by rounding nearly so, which of a hull of many corners is found much sooner.
    pub(super) fn support_nearly(&self, along: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Hull(hull) => hull.climbed(along),
            other => other.support(along),
        }
    }

    /// Whether that may differ.
    fn is_climbed(&self) -> bool {
        matches!(self, Self::Hull(hull) if hull.is_climbed())
    }

    /// How far its points are from its origin at most.
    fn reach(&self) -> f64 {
        let farthest = |points: &[Vector3<f64>]| {
            let lengths = points.iter().map(|p| p.norm_squared());
            lengths.fold(0.0, f64::max).sqrt()
        };
        match self {
            Self::Point(at) => at.norm(),
            Self::Segment(half) => *half,
            Self::Triangle(corners) => farthest(corners),
            Self::Box(half) => half.norm(),
            Self::Cylinder { radius, half } => radius + half,
            Self::Hull(hull) => hull.reach(),
        }
    }

    /// The box around it.
    pub(crate) fn bounds(&self) -> BoundingBox {
        let points = Vector3::UNITS
            .into_iter()
            .flat_map(|axis| [self.support(axis), self.support(-axis)]);
        BoundingBox::around(points)
    }

    /// A way out at a place on the surface of a box or cylinder, on a segment or at a point.
    pub(crate) fn outward(&self, p: Vector3<f64>) -> Vector3<f64> {
        let side = |axis: usize| {
            let sign = 1_f64.copysign(p.to_array()[axis]);
            Vector3::UNITS[axis] * sign
        };
        match self {
            Self::Box(half) => {
                let inside = [half.x - p.x.abs(), half.y - p.y.abs(), half.z - p.z.abs()];
                side((1..3).fold(
                    0,
                    |least, i| if inside[i] < inside[least] { i } else { least },
                ))
            }
            Self::Cylinder { radius, half } => {
                let across = (p.x * p.x + p.y * p.y).sqrt();
                match half - p.z.abs() < radius - across || across == 0.0 {
                    true => side(2),
                    false => Vector3::new(p.x / across, p.y / across, 0.0),
                }
            }
            _ => Vector3::UNITS[0],
        }
    }

    /// Some point within.
    pub(crate) fn middle(&self) -> Vector3<f64> {
        let mean = |points: &[Vector3<f64>]| {
            let sum = points.iter().fold(Vector3::zero(), |sum, &p| sum + p);
            sum * (points.len() as f64).recip()
        };
        match self {
            Self::Point(at) => *at,
            Self::Triangle(corners) => mean(corners),
            Self::Hull(hull) => hull.middle(),
            _ => Vector3::zero(),
        }
    }
}

fn farthest(points: &[Vector3<f64>], along: Vector3<f64>) -> Vector3<f64> {
    let mut best = (f64::NEG_INFINITY, points[0]);
    for &point in points {
        let far = along.dot(point);
        if far > best.0 {
            best = (far, point);
        }
    }
    best.1
}

/// Two cores in the coordinates of the first.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<'a> {
    pub(crate) a: Core<'a>,
    pub(crate) b: Core<'a>,
    pub(crate) a_from_b: Placement<f64>,
}

/// A corner of the difference A − B: the points of both that make it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    pub(crate) on_a: Vector3<f64>,
    pub(crate) on_b: Vector3<f64>,
}

impl Corner {
    #[inline]
    pub(crate) fn difference(&self) -> Vector3<f64> {
        self.on_a - self.on_b
    }
}

impl Pair<'_> {
    /// The corner of A − B that is farthest along a direction.
    pub(crate) fn support(&self, along: Vector3<f64>) -> Corner {
        let back = self.a_from_b.rotation.transpose_mul(-along);
        Corner {
            on_a: self.a.support(along),
            on_b: self.a_from_b.apply(self.b.support(back)),
        }
    }

    /// The same, or by rounding nearly so, which of hulls of many corners is found much sooner.
    pub(super) fn support_nearly(&self, along: Vector3<f64>) -> Corner {
        let back = self.a_from_b.rotation.transpose_mul(-along);
        Corner {
            on_a: self.a.support_nearly(along),
            on_b: self.a_from_b.apply(self.b.support_nearly(back)),
        }
    }

    /// Whether that may differ.
    pub(super) fn is_climbed(&self) -> bool {
        self.a.is_climbed() || self.b.is_climbed()
    }

    /// How much room there is between both along a unit direction from A to B; less than none where they overlap
    /// along it.
    pub(crate) fn gap_along(&self, normal: Vector3<f64>) -> f64 {
        -self.support(normal).difference().dot(normal)
    }

    /// From a point within B to one within A.
    pub(crate) fn middle(&self) -> Vector3<f64> {
        self.a.middle() - self.a_from_b.apply(self.b.middle())
    }

    /// How large both are and how far from each other: what rounding is measured by.
    pub(crate) fn scale(&self) -> f64 {
        self.a.reach() + self.b.reach() + self.a_from_b.translation.norm()
    }
}

/// How far two cores are apart, in the coordinates of the first: `normal` is of unit length and points from A to B
/// where they are apart, and where they overlap the way by which B leaves soonest. `distance` is negative then.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gap {
    pub(crate) distance: f64,
    pub(crate) on_a: Vector3<f64>,
    pub(crate) on_b: Vector3<f64>,
    pub(crate) normal: Vector3<f64>,
}

impl Gap {
    /// The same told of B first, in the coordinates that `b_from_a` leads to.
    pub(crate) fn flipped(&self, b_from_a: &Placement<f64>) -> Self {
        Self {
            distance: self.distance,
            on_a: b_from_a.apply(self.on_b),
            on_b: b_from_a.apply(self.on_a),
            normal: b_from_a.rotation * -self.normal,
        }
    }
}
