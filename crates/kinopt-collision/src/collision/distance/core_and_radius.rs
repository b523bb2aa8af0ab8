//! Convex bodies as a core and a radius: a sphere is a point, a capsule a segment.

use crate::collision::bounding_box::BoundingBox;
use crate::collision::shape::{ConvexHull, ShapeKind};
use kinopt_kinematics::spatial::{Placement, Vector3};

/// A convex body without its radius, in the frame of its shape.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Core<'a> {
    /// A single point.
    Point(Vector3<f64>),
    /// A segment along z, with half its length.
    Segment(f64),
    Triangle([Vector3<f64>; 3]),
    /// A box, with half its lengths.
    Box(Vector3<f64>),
    Cylinder {
        radius: f64,
        half: f64,
    },
    Hull(&'a ConvexHull),
}

impl<'a> Core<'a> {
    /// Core and radius of a convex bounded shape; `None` for other shapes.
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

    /// Support point: a point that is farthest along a direction.
    pub(crate) fn support(&self, along: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Point(point) => *point,
            Self::Segment(half) => Vector3::new(0.0, 0.0, half.copysign(along.z)),
            Self::Triangle(corners) => farthest(corners, along),
            Self::Box(half) => Vector3::new(
                half.x.copysign(along.x),
                half.y.copysign(along.y),
                half.z.copysign(along.z),
            ),
            Self::Cylinder { radius, half } => {
                let across = (along.x * along.x + along.y * along.y).sqrt();
                // Along the axis all points of the disc are equally far.
                let scale = if across > 0.0 { radius / across } else { 0.0 };
                Vector3::new(along.x * scale, along.y * scale, half.copysign(along.z))
            }
            Self::Hull(hull) => hull.farthest(along),
        }
    }

    /// Support point up to rounding. Faster than [`support`](Self::support) for large hulls.
    pub(super) fn approximate_support(&self, along: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Hull(hull) => hull.climbed(along),
            other => other.support(along),
        }
    }

    /// True if [`approximate_support`](Self::approximate_support) and [`support`](Self::support) may differ.
    fn is_climbed(&self) -> bool {
        matches!(self, Self::Hull(hull) if hull.is_climbed())
    }

    /// Upper bound of the distance of its points from its origin, metres.
    fn reach(&self) -> f64 {
        let farthest = |points: &[Vector3<f64>]| {
            let lengths = points.iter().map(|p| p.norm_squared());
            lengths.fold(0.0, f64::max).sqrt()
        };
        match self {
            Self::Point(point) => point.norm(),
            Self::Segment(half) => *half,
            Self::Triangle(corners) => farthest(corners),
            Self::Box(half) => half.norm(),
            Self::Cylinder { radius, half } => radius + half,
            Self::Hull(hull) => hull.reach(),
        }
    }

    /// The axis-aligned bounding box.
    pub(crate) fn bounds(&self) -> BoundingBox {
        let points = Vector3::UNITS
            .into_iter()
            .flat_map(|axis| [self.support(axis), self.support(-axis)]);
        BoundingBox::around(points)
    }

    /// An outward unit normal at a point on the surface of a box or cylinder; +x for other cores.
    pub(crate) fn outward(&self, p: Vector3<f64>) -> Vector3<f64> {
        let side = |axis: usize| {
            let sign = 1_f64.copysign(p.to_array()[axis]);
            Vector3::UNITS[axis] * sign
        };
        match self {
            Self::Box(half) => {
                let inside = [half.x - p.x.abs(), half.y - p.y.abs(), half.z - p.z.abs()];
                side((1..3).fold(0, |nearest, i| {
                    if inside[i] < inside[nearest] {
                        i
                    } else {
                        nearest
                    }
                }))
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

    /// A point inside.
    pub(crate) fn middle(&self) -> Vector3<f64> {
        let mean = |points: &[Vector3<f64>]| {
            let sum = points.iter().fold(Vector3::zero(), |sum, &p| sum + p);
            sum * (points.len() as f64).recip()
        };
        match self {
            Self::Point(point) => *point,
            Self::Triangle(corners) => mean(corners),
            Self::Hull(hull) => hull.middle(),
            _ => Vector3::zero(),
        }
    }
}

fn farthest(points: &[Vector3<f64>], along: Vector3<f64>) -> Vector3<f64> {
    let mut best = (f64::NEG_INFINITY, points[0]);
    for &point in points {
        let projection = along.dot(point);
        if projection > best.0 {
            best = (projection, point);
        }
    }
    best.1
}

/// Two cores, with the pose of B in the frame of A.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pair<'a> {
    pub(crate) a: Core<'a>,
    pub(crate) b: Core<'a>,
    pub(crate) a_from_b: Placement<f64>,
}

/// A vertex of the Minkowski difference A − B, with its points on A and B in the frame of A.
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
    /// The vertex of A − B that is farthest along a direction.
    pub(crate) fn support(&self, along: Vector3<f64>) -> Corner {
        let back = self.a_from_b.rotation.transpose_mul(-along);
        Corner {
            on_a: self.a.support(along),
            on_b: self.a_from_b.apply(self.b.support(back)),
        }
    }

    /// As [`support`](Self::support) up to rounding. Faster for large hulls.
    pub(super) fn approximate_support(&self, along: Vector3<f64>) -> Corner {
        let back = self.a_from_b.rotation.transpose_mul(-along);
        Corner {
            on_a: self.a.approximate_support(along),
            on_b: self.a_from_b.apply(self.b.approximate_support(back)),
        }
    }

    /// True if [`approximate_support`](Self::approximate_support) and [`support`](Self::support) may differ.
    pub(super) fn is_climbed(&self) -> bool {
        self.a.is_climbed() || self.b.is_climbed()
    }

    /// Width of the gap between both along a unit direction from A to B, metres; negative if they overlap along it.
    pub(crate) fn gap_along(&self, normal: Vector3<f64>) -> f64 {
        -self.support(normal).difference().dot(normal)
    }

    /// Vector from an interior point of B to an interior point of A.
    pub(crate) fn middle(&self) -> Vector3<f64> {
        self.a.middle() - self.a_from_b.apply(self.b.middle())
    }

    /// Sum of the sizes of both and the distance of their origins, metres: the scale of rounding errors.
    pub(crate) fn scale(&self) -> f64 {
        self.a.reach() + self.b.reach() + self.a_from_b.translation.norm()
    }
}

/// Signed distance of two cores in the frame of A.
///
/// `normal` is a unit vector. It points from A to B if they are apart. If they overlap, it is the direction of the
/// shortest translation of B that separates them, and `distance` is negative.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Gap {
    pub(crate) distance: f64,
    pub(crate) on_a: Vector3<f64>,
    pub(crate) on_b: Vector3<f64>,
    pub(crate) normal: Vector3<f64>,
}

impl Gap {
    /// The gap with A and B swapped, in the frame that `b_from_a` maps to.
    pub(crate) fn flipped(&self, b_from_a: &Placement<f64>) -> Self {
        Self {
            distance: self.distance,
            on_a: b_from_a.apply(self.on_b),
            on_b: b_from_a.apply(self.on_a),
            normal: b_from_a.rotation * -self.normal,
        }
    }
}
