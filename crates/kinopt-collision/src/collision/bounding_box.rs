//! Axis-aligned bounding boxes.

use kinopt_kinematics::spatial::{Placement, Vector3};

/// An axis-aligned bounding box, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundingBox {
    /// Smallest coordinates; −∞ along an unbounded axis.
    pub min: Vector3<f64>,
    /// Greatest coordinates; ∞ along an unbounded axis.
    pub max: Vector3<f64>,
}

impl BoundingBox {
    /// The empty box.
    pub(crate) const EMPTY: Self = Self {
        min: Vector3 {
            x: f64::INFINITY,
            y: f64::INFINITY,
            z: f64::INFINITY,
        },
        max: Vector3 {
            x: f64::NEG_INFINITY,
            y: f64::NEG_INFINITY,
            z: f64::NEG_INFINITY,
        },
    };

    /// The box around points.
    pub(crate) fn around(points: impl IntoIterator<Item = Vector3<f64>>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with)
    }

    /// The box extended by a point.
    #[inline]
    pub(crate) fn with(self, point: Vector3<f64>) -> Self {
        Self {
            min: component_min(self.min, point),
            max: component_max(self.max, point),
        }
    }

    /// The box around both boxes.
    #[inline]
    pub(crate) fn union(self, other: Self) -> Self {
        Self {
            min: component_min(self.min, other.min),
            max: component_max(self.max, other.max),
        }
    }

    /// The box enlarged by `margin` metres on all sides.
    pub(crate) fn grown(self, margin: f64) -> Self {
        let margin = Vector3::new(margin, margin, margin);
        Self {
            min: self.min - margin,
            max: self.max + margin,
        }
    }

    #[inline]
    pub(crate) fn centre(&self) -> Vector3<f64> {
        (self.min + self.max) * 0.5
    }

    /// Distance from the centre to a corner.
    #[inline]
    pub(crate) fn half_diagonal(&self) -> f64 {
        (self.max - self.min).norm() * 0.5
    }

    /// Squared distance from a point to the box; 0 inside.
    #[inline]
    #[doc(hidden)]
    pub fn squared_distance(&self, point: Vector3<f64>) -> f64 {
        let nearest = component_max(self.min, component_min(self.max, point));
        (point - nearest).norm_squared()
    }

    /// The axis-aligned box around this box transformed by a placement. An unbounded box gives the whole space.
    #[must_use]
    pub fn placed(&self, world_from_shape: &Placement<f64>) -> Self {
        let corner = |i: u8| {
            let pick = |bit, min, max| if i & bit == 0 { min } else { max };
            let x = pick(1, self.min.x, self.max.x);
            let y = pick(2, self.min.y, self.max.y);
            Vector3::new(x, y, pick(4, self.min.z, self.max.z))
        };
        match (self.max - self.min).norm().is_finite() {
            true => Self::around((0..8).map(|i| world_from_shape.apply(corner(i)))),
            false => Self::UNBOUNDED,
        }
    }

    /// The unbounded box.
    pub(super) const UNBOUNDED: Self = Self {
        min: Self::EMPTY.max,
        max: Self::EMPTY.min,
    };
}

#[inline]
fn component_min(a: Vector3<f64>, b: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(a.x.min(b.x), a.y.min(b.y), a.z.min(b.z))
}

#[inline]
fn component_max(a: Vector3<f64>, b: Vector3<f64>) -> Vector3<f64> {
    Vector3::new(a.x.max(b.x), a.y.max(b.y), a.z.max(b.z))
}
