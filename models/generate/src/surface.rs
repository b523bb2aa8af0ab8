//! Solid as a smooth union of simple parts, by a signed distance that is negative inside.
//!
//! Formulas of the parts and of the smooth minimum: I. Quilez, "Distance functions" and "Smooth minimum"
//! (iquilezles.org/articles). Stretched parts are scaled so that no distance is overestimated. The polygoniser skips
//! empty space by this distance.

use glam::{DMat3, DVec2, DVec3};

/// Shape of a part in its own coordinates, metres.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Shape {
    /// Convex hull of a sphere of radius `r0` at the origin and one of `r1` at (length, 0, 0). Stretched by `wide`
    /// along y and `thick` along z.
    RoundCone {
        length: f64,
        r0: f64,
        r1: f64,
        wide: f64,
        thick: f64,
    },
    /// Half axes along x, y, z.
    Ellipsoid(DVec3),
    /// Half sizes, with edges rounded by `bevel`.
    Block { half: DVec3, bevel: f64 },
    /// Cylinder about the x axis, from −`half` to `half`.
    Cylinder { radius: f64, half: f64, bevel: f64 },
}

/// Placed shape, and the bone that it moves with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub(crate) bone: usize,
    pub(crate) shape: Shape,
    /// Position of the shape's origin. `axes` has the directions of the shape's axes.
    pub(crate) origin: DVec3,
    pub(crate) axes: DMat3,
    /// Radius of the fillet towards earlier parts, metres.
    pub(crate) fillet: f64,
    /// Edge length of the mesh on the part, metres.
    pub(crate) edge: f64,
    /// Distance over which the skin weights blend with those of neighbouring parts, metres.
    pub(crate) softness: f64,
}

impl Shape {
    fn distance(self, p: DVec3) -> f64 {
        match self {
            Self::RoundCone {
                length,
                r0,
                r1,
                wide,
                thick,
            } => {
                let across = DVec2::new(p.y / wide, p.z / thick).length();
                round_cone(DVec2::new(p.x, across), length, r0, r1) * wide.min(thick).min(1.0)
            }
            Self::Ellipsoid(half) => ((p / half).length() - 1.0) * half.min_element(),
            Self::Block { half, bevel } => {
                let q = p.abs() - half + DVec3::splat(bevel);
                q.max(DVec3::ZERO).length() + q.max_element().min(0.0) - bevel
            }
            Self::Cylinder {
                radius,
                half,
                bevel,
            } => {
                let q = DVec2::new(DVec2::new(p.y, p.z).length() - radius, p.x.abs() - half);
                let q = q + DVec2::splat(bevel);
                q.max(DVec2::ZERO).length() + q.max_element().min(0.0) - bevel
            }
        }
    }
}

/// Signed distance; `q` has the coordinates along the axis and away from it.
fn round_cone(q: DVec2, length: f64, r0: f64, r1: f64) -> f64 {
    if length <= (r0 - r1).abs() {
        let (centre, radius) = if r0 > r1 { (0.0, r0) } else { (length, r1) };
        return (q - DVec2::new(centre, 0.0)).length() - radius;
    }
    let sin = (r0 - r1) / length;
    let cos = (1.0 - sin * sin).sqrt();
    let along = q.x * cos - q.y * sin;
    if along < 0.0 {
        q.length() - r0
    } else if along > cos * length {
        (q - DVec2::new(length, 0.0)).length() - r1
    } else {
        q.dot(DVec2::new(sin, cos)) - r0
    }
}

impl Part {
    pub(crate) fn distance(&self, p: DVec3) -> f64 {
        self.shape
            .distance(self.axes.transpose() * (p - self.origin))
    }
}

/// Union of parts, grouped by limb.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surface {
    /// Parts of each limb, and the fillet radius towards earlier limbs, metres.
    pub(crate) limbs: Vec<(Vec<Part>, f64)>,
}

impl Surface {
    pub(crate) fn distance(&self, p: DVec3) -> f64 {
        let limb = |parts: &[Part]| {
            let each = parts.iter().map(|part| (part.distance(p), part.fillet));
            each.reduce(join)
                .map_or(f64::INFINITY, |(distance, _)| distance)
        };
        let limbs = self
            .limbs
            .iter()
            .map(|(parts, fillet)| (limb(parts), *fillet));
        limbs
            .reduce(join)
            .map_or(f64::INFINITY, |(distance, _)| distance)
    }

    /// Unit gradient of the distance, by central differences.
    pub(crate) fn normal(&self, p: DVec3) -> DVec3 {
        const STEP: f64 = 1e-4;
        let slope = |axis| self.distance(p + axis * STEP) - self.distance(p - axis * STEP);
        DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).normalize_or_zero()
    }

    /// Point of the surface near `p`.
    pub(crate) fn project(&self, mut p: DVec3) -> DVec3 {
        for _ in 0..4 {
            p -= self.normal(p) * self.distance(p);
        }
        p
    }

    /// Part with the smallest signed distance to `p`.
    pub(crate) fn part_at(&self, p: DVec3) -> Option<&Part> {
        let parts = self.limbs.iter().flat_map(|(parts, _)| parts);
        parts.min_by(|a, b| a.distance(p).total_cmp(&b.distance(p)))
    }
}

/// Quadratic smooth minimum with the fillet of the second argument.
fn join((a, keep): (f64, f64), (b, fillet): (f64, f64)) -> (f64, f64) {
    let overlap = (fillet - (a - b).abs()).max(0.0);
    let rounding = if fillet > 0.0 {
        overlap * overlap / (4.0 * fillet)
    } else {
        0.0
    };
    (a.min(b) - rounding, keep)
}
