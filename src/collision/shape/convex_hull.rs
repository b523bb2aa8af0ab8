//! Convex hull of points, by quickhull.

use super::ShapeError;
use super::error::check_points;
use super::hull_climb::HullClimb;
use crate::collision::convex_surface::ConvexSurface;
use crate::spatial::Vector3;

/// Smallest thickness of the points, relative to their extent.
const MIN_RELATIVE_THICKNESS: f64 = 1e-10;

/// A convex hull: its vertices and triangles.
#[derive(Clone, Debug)]
pub struct ConvexHull {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    /// Unit outward normals and offsets n · x of the triangles that are wide enough to define a plane.
    planes: Vec<(Vector3<f64>, f64)>,
    climb: Option<HullClimb>,
    /// The mean of the vertices, and the largest distance of a vertex from the origin, metres.
    middle: Vector3<f64>,
    reach: f64,
}

impl ConvexHull {
    pub(super) fn new(points: &[Vector3<f64>]) -> Result<Self, ShapeError> {
        if points.len() < 4 {
            return Err(ShapeError::TooFew {
                shape: "convex hull",
                what: "points",
                needed: 4,
                given: points.len(),
            });
        }
        check_points("point", "points", points)?;
        let (corners, thickness, extent) = spanning(points);
        let flat = ShapeError::Flat {
            points: points.len(),
            thickness,
        };
        if thickness <= MIN_RELATIVE_THICKNESS * extent {
            return Err(flat);
        }
        let surface = grow(ConvexSurface::tetrahedron(corners).ok_or(flat)?, points);
        Ok(Self::of(&surface, extent))
    }

    fn of(surface: &ConvexSurface, extent: f64) -> Self {
        let mut new_indices = vec![u32::MAX; surface.points.len()];
        let mut vertices = Vec::new();
        let mut triangles = Vec::new();
        let mut planes = Vec::new();
        for facet in surface.facets.iter().filter(|facet| facet.alive) {
            triangles.push(facet.corners.map(|corner| {
                let index = &mut new_indices[corner as usize];
                if *index == u32::MAX {
                    *index = vertices.len() as u32;
                    vertices.push(surface.points[corner as usize]);
                }
                *index
            }));
            let [a, b, c] = facet.corners.map(|corner| surface.points[corner as usize]);
            // A sliver's plane is dominated by rounding, and the planes of its neighbours are as close.
            if let Some(normal) = unit_normal(a, b, c, MIN_RELATIVE_THICKNESS * extent) {
                planes.push((normal, normal.dot(a)));
            }
        }
        let sum = vertices.iter().fold(Vector3::zero(), |sum, &p| sum + p);
        let lengths = vertices.iter().map(|p| p.norm_squared());
        Self {
            climb: HullClimb::of(&vertices, &triangles),
            middle: sum * (vertices.len() as f64).recip(),
            reach: lengths.fold(0.0, f64::max).sqrt(),
            vertices,
            triangles,
            planes,
        }
    }

    /// Vertices, metres.
    #[must_use]
    pub fn vertices(&self) -> &[Vector3<f64>] {
        &self.vertices
    }

    /// Triangles as vertex indices, counter-clockwise seen from outside.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// The mean of the vertices.
    #[must_use]
    pub(crate) fn middle(&self) -> Vector3<f64> {
        self.middle
    }

    /// The largest distance of a vertex from the origin, metres.
    #[must_use]
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    #[cfg(test)]
    #[must_use]
    pub(super) fn climb(&self) -> Option<&HullClimb> {
        self.climb.as_ref()
    }

    #[cfg(test)]
    #[must_use]
    pub(super) fn planes(&self) -> &[(Vector3<f64>, f64)] {
        &self.planes
    }

    /// True if [`climbed`](Self::climbed) uses hill climbing, which may stop early by rounding.
    #[must_use]
    pub(crate) fn is_climbed(&self) -> bool {
        self.climb.is_some()
    }

    /// The first of the vertices that are farthest along a direction.
    pub(crate) fn farthest(&self, along: Vector3<f64>) -> Vector3<f64> {
        let climb = self.climb.as_ref();
        let vertex = climb.and_then(|c| c.try_farthest(&self.vertices, along, self.reach));
        vertex.unwrap_or_else(|| self.farthest_of_all(along))
    }

    fn farthest_of_all(&self, along: Vector3<f64>) -> Vector3<f64> {
        let mut best = (f64::NEG_INFINITY, self.vertices[0]);
        for &corner in &self.vertices {
            let projection = along.dot(corner);
            if projection > best.0 {
                best = (projection, corner);
            }
        }
        best.1
    }

    /// A vertex that is farthest along a direction up to rounding, by hill climbing on large hulls.
    pub(crate) fn climbed(&self, along: Vector3<f64>) -> Vector3<f64> {
        match &self.climb {
            Some(climb) => climb.farthest(&self.vertices, along),
            None => self.farthest_of_all(along),
        }
    }

    /// The face plane with the largest signed distance to a point: that distance, negative inside, and the plane's
    /// normal.
    pub(crate) fn farthest_face(&self, point: Vector3<f64>) -> (f64, Vector3<f64>) {
        let start = (f64::NEG_INFINITY, Vector3::UNITS[2]);
        self.planes.iter().fold(start, |best, &(normal, offset)| {
            let distance = normal.dot(point) - offset;
            if distance > best.0 {
                (distance, normal)
            } else {
                best
            }
        })
    }
}

/// Unit normal of a triangle; `None` if its width is at most `min_width`.
fn unit_normal(
    a: Vector3<f64>,
    b: Vector3<f64>,
    c: Vector3<f64>,
    min_width: f64,
) -> Option<Vector3<f64>> {
    let sides = [b - a, c - b, a - c];
    let longest = sides.iter().map(|s| s.norm()).fold(0.0, f64::max);
    let normal = sides[0].cross(sides[1]);
    let area = normal.norm();
    (area > min_width * longest).then(|| normal * area.recip())
}

/// Four points of large span, their thickness across a plane and their length.
fn spanning(points: &[Vector3<f64>]) -> ([Vector3<f64>; 4], f64, f64) {
    let first = points[0];
    let a = farthest(points, |p| (p - first).norm_squared());
    let b = farthest(points, |p| (p - a).norm_squared());
    let along = b - a;
    let extent = along.norm();
    let c = farthest(points, |p| along.cross(p - a).norm_squared());
    let normal = along.cross(c - a);
    let d = farthest(points, |p| normal.dot(p - a).abs());
    let thickness = normal.dot(d - a).abs() / normal.norm().max(f64::MIN_POSITIVE);
    ([a, b, c, d], thickness, extent)
}

fn farthest(points: &[Vector3<f64>], measure: impl Fn(Vector3<f64>) -> f64) -> Vector3<f64> {
    let start = (points[0], measure(points[0]));
    let best = points.iter().fold(start, |best, &p| {
        let measured = measure(p);
        if measured > best.1 {
            (p, measured)
        } else {
            best
        }
    });
    best.0
}

/// Inserts all points outside the surface; of each facet the farthest first.
fn grow(mut surface: ConvexSurface, points: &[Vector3<f64>]) -> ConvexSurface {
    // Points that see a facet, by facet. Each point is in the list of one facet only.
    let mut outside: Vec<Vec<u32>> = vec![Vec::new(); 4];
    let mut facets: Vec<u32> = (0..4).collect();
    let mut unassigned: Vec<u32> = (0..points.len() as u32).collect();
    assign(&surface, points, &mut unassigned, &facets, &mut outside);
    while let Some(facet) = facets.pop() {
        let [a, b, c] = surface.corners(facet);
        let normal = (b - a).cross(c - a);
        let above = |&i: &u32| normal.dot(points[i as usize] - a);
        // A hidden facet has no points left: they were assigned to other facets.
        let candidates = &outside[facet as usize];
        let Some(&top) = candidates
            .iter()
            .max_by(|i, j| above(i).total_cmp(&above(j)))
        else {
            continue;
        };
        surface.insert(points[top as usize], facet);
        outside.resize(surface.facets.len(), Vec::new());
        for &hidden in &surface.hidden {
            unassigned.append(&mut outside[hidden as usize]);
        }
        assign(
            &surface,
            points,
            &mut unassigned,
            &surface.new_facets,
            &mut outside,
        );
        facets.extend(&surface.new_facets);
    }
    surface
}

/// Assigns each loose point to the first facet that it sees. Points that see no facet are inside and are dropped.
fn assign(
    surface: &ConvexSurface,
    points: &[Vector3<f64>],
    unassigned: &mut Vec<u32>,
    facets: &[u32],
    outside: &mut [Vec<u32>],
) {
    for point in unassigned.drain(..) {
        let sees = |&&facet: &&u32| surface.sees(facet, points[point as usize]);
        if let Some(&facet) = facets.iter().find(sees) {
            outside[facet as usize].push(point);
        }
    }
}
