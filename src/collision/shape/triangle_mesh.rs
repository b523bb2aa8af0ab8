//! Triangle meshes, welded and with what is known of their inside.

use std::collections::HashMap;

use super::error::check_points;
use super::{ShapeError, ShapeNote, near_welds};
use crate::collision::bounding_box::BoundingBox;
use crate::collision::box_tree::BoxTree;
use crate::scalar::elementary::atan2;
use crate::spatial::Vector3;

/// Triangles over vertices of which no two are at one place.
#[derive(Clone, Debug)]
pub struct TriangleMesh {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    notes: Vec<ShapeNote>,
    /// Of closed meshes.
    inside: Option<Inside>,
    tree: BoxTree,
}

/// What tells inside from outside (Bærentzen & Aanæs 2005, "Signed distance computation using the angle weighted
/// pseudonormal").
#[derive(Clone, Debug)]
struct Inside {
    /// By triangle: the triangles beyond its sides, each side from a corner to the next.
    across: Vec<[u32; 3]>,
    /// By vertex: the sum of its triangles' unit normals, each times its angle there.
    vertex_normals: Vec<Vector3<f64>>,
}

/// The part of a triangle that a point is nearest to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Feature {
    /// One of its corners.
    Corner(usize),
    /// A side, from this corner to the next.
    Side(usize),
    /// Within.
    Face,
}

impl TriangleMesh {
    pub(super) fn new(
        vertices: Vec<Vector3<f64>>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self, ShapeError> {
        check_points("vertex", "vertices", &vertices)?;
        super::error::check_number("triangles", triangles.len())?;
        for (triangle, corners) in triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices.len()) {
                return Err(ShapeError::UnknownVertex {
                    triangle,
                    vertex,
                    vertices: vertices.len(),
                });
            }
        }
        let given = triangles.len();
        let (mut vertices, mut triangles) = welded(&vertices, &triangles);
        let mut notes = Vec::new();
        if triangles.len() < given {
            notes.push(ShapeNote::WithoutArea {
                triangles: given - triangles.len(),
            });
        }
        if triangles.is_empty() {
            return Err(ShapeError::TooFew {
                shape: "mesh",
                what: "triangle with three corners apart",
                needed: 1,
                given: 0,
            });
        }
        let mut beyond = across(&triangles);
        if let Err(ShapeNote::Open { .. }) = beyond
            && let Some(closed) = near_welds::closed(&vertices, &triangles)
        {
            let within = near_welds::TOLERANCE * closed.size;
            let made_one = vertices.len() - closed.vertices.len();
            notes.push(ShapeNote::Closed {
                vertices: made_one,
                within,
            });
            (vertices, triangles) = (closed.vertices, closed.triangles);
            beyond = Ok(closed.across);
        }
        let inside = match beyond {
            Err(note) => {
                notes.push(note);
                None
            }
            Ok(mut beyond) => {
                if volume(&vertices, &triangles) < 0.0 {
                    notes.push(ShapeNote::InsideOut);
                    triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
                    // Sides 01, 12, 20 become 02, 21, 10.
                    beyond.iter_mut().for_each(|sides| sides.swap(0, 2));
                }
                Some(Inside {
                    across: beyond,
                    vertex_normals: vertex_normals(&vertices, &triangles),
                })
            }
        };
        let corners = |i: usize| triangles[i].map(|v| vertices[v as usize]);
        let tree = BoxTree::new(triangles.len(), |i| BoundingBox::around(corners(i)));
        Ok(Self {
            vertices,
            triangles,
            notes,
            inside,
            tree,
        })
    }

    getters! {
        /// Its vertices, of which no two are at one place.
        pub fn vertices(&self) -> &[Vector3<f64>] = &self.vertices;
        /// Three vertices each, counter-clockwise seen from outside where it is closed.
        pub fn triangles(&self) -> &[[u32; 3]] = &self.triangles;
        /// Whether it encloses a volume, which then belongs to it.
        pub fn is_closed(&self) -> bool = self.inside.is_some();
        pub(super) fn notes(&self) -> &[ShapeNote] = &self.notes;
        pub(super) fn bounding_box(&self) -> BoundingBox = self.tree.bounds();
        pub(crate) fn tree(&self) -> &BoxTree = &self.tree;
    }

    /// The corners of a triangle.
    pub(crate) fn triangle(&self, index: usize) -> [Vector3<f64>; 3] {
        self.triangles[index].map(|vertex| self.vertices[vertex as usize])
    }

    /// Which way is out where a point next to the mesh is nearest to; `None` for an open mesh.
    pub(crate) fn outward(&self, triangle: usize, feature: Feature) -> Option<Vector3<f64>> {
        let inside = self.inside.as_ref()?;
        Some(match feature {
            Feature::Corner(i) => inside.vertex_normals[self.triangles[triangle][i] as usize],
            Feature::Side(i) => {
                let beyond = inside.across[triangle][i] as usize;
                unit_normal(self.triangle(triangle)) + unit_normal(self.triangle(beyond))
            }
            Feature::Face => unit_normal(self.triangle(triangle)),
        })
    }
}

/// The vertices in use without copies, and the triangles with three of them.
pub(super) fn welded(
    vertices: &[Vector3<f64>],
    triangles: &[[u32; 3]],
) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let mut names: HashMap<[u64; 3], u32> = HashMap::new();
    let mut kept = Vec::new();
    let mut weld = |vertex: u32| {
        // Zeros of both signs are one.
        let place = vertices[vertex as usize] + Vector3::zero();
        let bits = place.to_array().map(f64::to_bits);
        *names.entry(bits).or_insert_with(|| {
            kept.push(place);
            kept.len() as u32 - 1
        })
    };
    let triangles = triangles.iter().map(|corners| corners.map(&mut weld));
    let with_area = triangles.filter(|[a, b, c]| a != b && b != c && c != a);
    let with_area = with_area.collect();
    (kept, with_area)
}

/// The triangles beyond each side, if the mesh is closed and wound one way.
pub(super) fn across(triangles: &[[u32; 3]]) -> Result<Vec<[u32; 3]>, ShapeNote> {
    // Each side by its ends, then whether it goes from the greater to the lesser, its triangle and place there.
    let mut sides = Vec::with_capacity(3 * triangles.len());
    for (t, corners) in triangles.iter().enumerate() {
        for side in 0..3 {
            let (from, to) = (corners[side], corners[(side + 1) % 3]);
            sides.push((from.min(to), from.max(to), from > to, t as u32, side));
        }
    }
    sides.sort_unstable();
    let mut beyond = vec![[0; 3]; triangles.len()];
    let (mut open, mut wound) = (0, 0);
    for edge in sides.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        match edge {
            [a, b] if a.2 != b.2 => {
                beyond[a.3 as usize][a.4] = b.3;
                beyond[b.3 as usize][b.4] = a.3;
            }
            [_, _] => wound += 1,
            _ => open += 1,
        }
    }
    match (open, wound) {
        (0, 0) => Ok(beyond),
        (0, edges) => Err(ShapeNote::Winding { edges }),
        (edges, _) => Err(ShapeNote::Open { edges }),
    }
}

/// What the triangles enclose, negative where they are clockwise seen from outside; about the first vertex, so
/// that a mesh far from the origin does not drown.
fn volume(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> f64 {
    let origin = vertices[0];
    let part = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|v| vertices[v as usize] - origin);
        a.dot(b.cross(c))
    };
    triangles.iter().map(part).sum()
}

fn vertex_normals(vertices: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Vec<Vector3<f64>> {
    let mut normals = vec![Vector3::zero(); vertices.len()];
    for corners in triangles {
        let places = corners.map(|v| vertices[v as usize]);
        let normal = unit_normal(places);
        for i in 0..3 {
            let [a, b] = [1, 2].map(|j| places[(i + j) % 3] - places[i]);
            let angle = atan2(a.cross(b).norm(), a.dot(b));
            normals[corners[i] as usize] += normal * angle;
        }
    }
    normals
}

/// Zero where the triangle has no area.
fn unit_normal([a, b, c]: [Vector3<f64>; 3]) -> Vector3<f64> {
    let normal = (b - a).cross(c - a);
    let length = normal.norm();
    match length > 0.0 {
        true => normal * length.recip(),
        false => Vector3::zero(),
    }
}
