//! Approximate convex decomposition of meshes.
//!
//! The box whose hull is farthest from its surface is cut in two, along the plane with the least volume in the two
//! hulls. The extreme points of the solid in a box lie on the solid's surface or are corners of the box inside the
//! solid. Therefore the hull of those points contains that part of the solid. The method is a simple relative of Mamou
//! & Ghorbel 2009 ("A simple and efficient approach for 3D mesh approximate convex decomposition") and Wei et al. 2022.

use crate::collision::mesh_file::MeshFile;
use crate::collision::{BoundingBox, ConvexHull, Shape, ShapeError, ShapeKind};
use kinopt_kinematics::spatial::Vector3;

/// Depth of the surface below its hull, relative to the mesh's diagonal, that ends the cuts.
const MAX_RELATIVE_HOLLOW: f64 = 0.01;
/// Number of candidate planes along each axis.
const PLANES_PER_AXIS: usize = 7;

/// The part of a mesh in a box.
struct Piece {
    cell: BoundingBox,
    /// Polygons of the surface in the box.
    polygons: Vec<Vec<Vector3<f64>>>,
    /// Corners of boxes inside the solid.
    corners: Vec<Vector3<f64>>,
    shape: Shape,
    /// Largest depth of the surface below the hull, metres.
    hollow: f64,
}

/// Hulls of at most `max_pieces` pieces and at least one. A nearly convex mesh gives one hull.
pub(super) fn pieces(mesh: &MeshFile, max_pieces: usize) -> Result<Vec<Shape>, ShapeError> {
    let solid = Shape::mesh(mesh.points.clone(), mesh.triangles.clone())?;
    let corner = |index: u32| mesh.points[index as usize];
    let polygons = mesh
        .triangles
        .iter()
        .map(|corners| corners.map(corner).to_vec());
    let cell = solid.bounding_box();
    let size = (cell.max - cell.min).norm();
    let mut pieces = vec![Piece::new(cell, polygons.collect(), Vec::new())?];
    while pieces.len() < max_pieces {
        let worst =
            (0..pieces.len()).max_by(|a, b| pieces[*a].hollow.total_cmp(&pieces[*b].hollow));
        let Some(worst) = worst.filter(|at| pieces[*at].hollow > MAX_RELATIVE_HOLLOW * size) else {
            break;
        };
        match pieces[worst].halves(&solid) {
            Some(halves) => {
                pieces.swap_remove(worst);
                pieces.extend(halves);
            }
            // No plane gives two hulls with a volume.
            None => pieces[worst].hollow = 0.0,
        }
    }
    Ok(pieces.into_iter().map(|piece| piece.shape).collect())
}

impl Piece {
    fn new(
        cell: BoundingBox,
        polygons: Vec<Vec<Vector3<f64>>>,
        corners: Vec<Vector3<f64>>,
    ) -> Result<Self, ShapeError> {
        let points: Vec<_> = polygons.iter().flatten().chain(&corners).copied().collect();
        let shape = Shape::convex(&points)?;
        let hollow = hull(&shape).map_or(0.0, |hull| {
            let below = |polygon: &Vec<Vector3<f64>>| {
                let sum = polygon.iter().fold(Vector3::zero(), |sum, p| sum + *p);
                let centre = sum * (polygon.len() as f64).recip();
                let points = polygon.iter().copied().chain([centre]);
                points.map(|p| -hull.farthest_face(p).0).fold(0.0, f64::max)
            };
            polygons.iter().map(below).fold(0.0, f64::max)
        });
        Ok(Self {
            cell,
            polygons,
            corners,
            shape,
            hollow,
        })
    }

    /// The two halves at the plane with the least sum of volumes.
    fn halves(&self, solid: &Shape) -> Option<[Self; 2]> {
        let all = self.polygons.iter().flatten().chain(&self.corners);
        let bounds = BoundingBox::around(all.copied());
        let (low, high) = (bounds.min.to_array(), bounds.max.to_array());
        let mut best: Option<(f64, [Self; 2])> = None;
        for axis in 0..3 {
            for plane in 1..=PLANES_PER_AXIS {
                let share = plane as f64 / (PLANES_PER_AXIS + 1) as f64;
                let at = low[axis] + share * (high[axis] - low[axis]);
                let Some(halves) = self.cut(solid, axis, at) else {
                    continue;
                };
                let volume = halves.iter().map(|half| volume(&half.shape)).sum::<f64>();
                if best
                    .as_ref()
                    .is_none_or(|(min_volume, _)| volume < *min_volume)
                {
                    best = Some((volume, halves));
                }
            }
        }
        best.map(|(_, halves)| halves)
    }

    fn cut(&self, solid: &Shape, axis: usize, position: f64) -> Option<[Self; 2]> {
        let coordinate = |p: &Vector3<f64>| p.to_array()[axis];
        let on_plane = cell_corners(&self.cell, axis, position);
        let inner = on_plane
            .into_iter()
            .filter(|p| solid.signed_distance(*p) < 0.0);
        let inner: Vec<_> = inner.collect();
        let half = |side: f64| {
            let clipped = self
                .polygons
                .iter()
                .map(|polygon| clip(polygon, axis, position, side));
            let polygons = clipped.filter(|polygon| polygon.len() > 2).collect();
            let half_corners = self
                .corners
                .iter()
                .filter(|p| side * (coordinate(p) - position) >= 0.0);
            let corners = half_corners.chain(&inner).copied().collect();
            let mut cell = self.cell;
            let bound = if side > 0.0 {
                &mut cell.min
            } else {
                &mut cell.max
            };
            let mut numbers = bound.to_array();
            numbers[axis] = position;
            *bound = numbers.into();
            Self::new(cell, polygons, corners).ok()
        };
        Some([half(-1.0)?, half(1.0)?])
    }
}

/// Corners of a box's cross-section with a plane.
fn cell_corners(cell: &BoundingBox, axis: usize, position: f64) -> [Vector3<f64>; 4] {
    let ends = [cell.min.to_array(), cell.max.to_array()];
    [(0, 0), (0, 1), (1, 0), (1, 1)].map(|(first, second)| {
        let mut corner = [position; 3];
        corner[(axis + 1) % 3] = ends[first][(axis + 1) % 3];
        corner[(axis + 2) % 3] = ends[second][(axis + 2) % 3];
        corner.into()
    })
}

/// The part of a polygon on one side of a plane (Sutherland & Hodgman 1974).
fn clip(polygon: &[Vector3<f64>], axis: usize, position: f64, side: f64) -> Vec<Vector3<f64>> {
    let height = |p: &Vector3<f64>| side * (p.to_array()[axis] - position);
    let mut clipped = Vec::with_capacity(polygon.len() + 1);
    let next = polygon.iter().cycle().skip(1);
    for (from, to) in polygon.iter().zip(next) {
        let (before, after) = (height(from), height(to));
        if before >= 0.0 {
            clipped.push(*from);
        }
        if (before > 0.0 && after < 0.0) || (before < 0.0 && after > 0.0) {
            let mut numbers = (*from + (*to - *from) * (before / (before - after))).to_array();
            numbers[axis] = position;
            clipped.push(numbers.into());
        }
    }
    clipped
}

fn hull(shape: &Shape) -> Option<&ConvexHull> {
    match shape.kind() {
        ShapeKind::Convex(hull) => Some(hull),
        _ => None,
    }
}

fn volume(shape: &Shape) -> f64 {
    let Some(hull) = hull(shape) else {
        return 0.0;
    };
    let origin = hull.vertices()[0];
    let part = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|k| hull.vertices()[k as usize] - origin);
        a.dot(b.cross(c)) / 6.0
    };
    hull.triangles().iter().map(part).sum()
}
