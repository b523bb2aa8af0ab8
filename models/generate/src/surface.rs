//! A solid as a smooth union of simple parts: a signed distance, negative inside.
//!
//! Formulas of the parts and of the smooth minimum: I. Quilez, "Distance functions" and "Smooth
//! minimum" (iquilezles.org/articles). Stretched parts are scaled so that no distance is
//! overestimated; the polygoniser skips empty space by it.

use glam::{DMat3, DVec2, DVec3};

/// What a part looks like in its own coordinates.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Shape {
    /// A sphere of radius `r0` at the origin, one of `r1` at (length, 0, 0) and what is between;
    /// stretched across by `wide` along y and `thick` along z.
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
    /// About the x axis, from −`half` to `half`.
    Cylinder { radius: f64, half: f64, bevel: f64 },
}

/// A shape in its place, and the bone that it moves with.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    pub(crate) bone: usize,
    pub(crate) shape: Shape,
    /// Where the shape's origin is and how its axes lie.
    pub(crate) origin: DVec3,
    pub(crate) axes: DMat3,
    /// Radius of the fillet towards the parts before it, in metres.
    pub(crate) fillet: f64,
    /// The length of the mesh's edges on it, in metres.
    pub(crate) edge: f64,
    /// How far its skin weights blend into its neighbours', in metres.
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

/// `q`: along the axis, and away from it.
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

/// The union of parts, limb by limb.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surface {
    /// The parts of each limb, and the fillet with which the limb joins the limbs before it.
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

    /// The unit direction in which the distance grows fastest, by central differences.
    pub(crate) fn normal(&self, p: DVec3) -> DVec3 {
        const STEP: f64 = 1e-4;
        let slope = |axis| self.distance(p + axis * STEP) - self.distance(p - axis * STEP);
        DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).normalize_or_zero()
    }

    /// A point of the surface near `p`.
    pub(crate) fn project(&self, mut p: DVec3) -> DVec3 {
        for _ in 0..4 {
            p -= self.normal(p) * self.distance(p);
        }
        p
    }

    /// The part that `p` is nearest to or deepest in.
    pub(crate) fn part_at(&self, p: DVec3) -> Option<&Part> {
        let parts = self.limbs.iter().flat_map(|(parts, _)| parts);
        parts.min_by(|a, b| a.distance(p).total_cmp(&b.distance(p)))
    }
}

/// The quadratic smooth minimum with the second one's fillet.
fn join((a, keep): (f64, f64), (b, fillet): (f64, f64)) -> (f64, f64) {
    let near = (fillet - (a - b).abs()).max(0.0);
    let rounding = if fillet > 0.0 {
        near * near / (4.0 * fillet)
    } else {
        0.0
    };
    (a.min(b) - rounding, keep)
}
