//! Triangle meshes with merged vertices and a test for inside.

use super::error::check_points;
use super::triangle_sides::{across, welded};
use super::{ShapeError, ShapeNote, near_welds};
use crate::collision::aabb_tree::AabbTree;
use crate::collision::bounding_box::BoundingBox;
use kinopt_kinematics::scalar::elementary::atan2;
use kinopt_kinematics::spatial::Vector3;

/// A triangle mesh over distinct vertices.
#[derive(Clone, Debug)]
pub struct TriMesh {
    vertices: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    notes: Vec<ShapeNote>,
    /// Present for closed meshes only.
    inside: Option<Inside>,
    tree: AabbTree,
}

/// Pseudonormals that separate inside from outside (Bærentzen & Aanæs 2005, "Signed distance computation using the
/// angle weighted pseudonormal").
#[derive(Clone, Debug)]
struct Inside {
    /// Adjacent triangle across each side, by triangle. A side runs from a corner to the next.
    across: Vec<[u32; 3]>,
    /// Sum of the unit normals of the adjacent triangles, each weighted by its angle at the vertex, by vertex.
    vertex_normals: Vec<Vector3<f64>>,
}

/// Feature of a triangle that holds a closest point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TriangleFeature {
    /// A corner, by its index in the triangle.
    Corner(usize),
    /// A side, by the index of its first corner.
    Side(usize),
    /// The interior.
    Face,
}

impl TriMesh {
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
        let mut adjacent = across(&triangles);
        if let Err(ShapeNote::Open { .. }) = adjacent
            && let Some(closed) = near_welds::closed(&vertices, &triangles)
        {
            let tolerance = near_welds::TOLERANCE * closed.size;
            let merged = vertices.len() - closed.vertices.len();
            notes.push(ShapeNote::Closed {
                vertices: merged,
                within: tolerance,
            });
            (vertices, triangles) = (closed.vertices, closed.triangles);
            adjacent = Ok(closed.across);
        }
        let inside = match adjacent {
            Err(note) => {
                notes.push(note);
                None
            }
            Ok(mut adjacent) => {
                if volume(&vertices, &triangles) < 0.0 {
                    notes.push(ShapeNote::InsideOut);
                    triangles.iter_mut().for_each(|corners| corners.swap(1, 2));
                    // Sides 01, 12, 20 become 02, 21, 10.
                    adjacent.iter_mut().for_each(|sides| sides.swap(0, 2));
                }
                Some(Inside {
                    across: adjacent,
                    vertex_normals: vertex_normals(&vertices, &triangles),
                })
            }
        };
        let corners = |i: usize| triangles[i].map(|v| vertices[v as usize]);
        let tree = AabbTree::new(triangles.len(), |i| BoundingBox::around(corners(i)));
        Ok(Self {
            vertices,
            triangles,
            notes,
            inside,
            tree,
        })
    }

    /// Vertices, metres. No two are at the same position.
    #[must_use]
    pub fn vertices(&self) -> &[Vector3<f64>] {
        &self.vertices
    }

    /// Triangles as vertex indices, counter-clockwise seen from outside if the mesh is closed.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// True if the mesh is closed, so that the enclosed volume is solid.
    #[must_use]
    pub fn is_closed(&self) -> bool {
        self.inside.is_some()
    }

    #[must_use]
    pub(super) fn notes(&self) -> &[ShapeNote] {
        &self.notes
    }

    #[must_use]
    pub(super) fn bounding_box(&self) -> BoundingBox {
        self.tree.bounds()
    }

    #[must_use]
    pub(crate) fn tree(&self) -> &AabbTree {
        &self.tree
    }

    /// The corners of a triangle.
    pub(crate) fn triangle(&self, index: usize) -> [Vector3<f64>; 3] {
        self.triangles[index].map(|vertex| self.vertices[vertex as usize])
    }

    /// Outward pseudonormal of a feature of a triangle, not normalised; `None` for an open mesh.
    pub(crate) fn outward(
        &self,
        triangle: usize,
        feature: TriangleFeature,
    ) -> Option<Vector3<f64>> {
        let inside = self.inside.as_ref()?;
        Some(match feature {
            TriangleFeature::Corner(i) => {
                inside.vertex_normals[self.triangles[triangle][i] as usize]
            }
            TriangleFeature::Side(i) => {
                let adjacent = inside.across[triangle][i] as usize;
                unit_normal(self.triangle(triangle)) + unit_normal(self.triangle(adjacent))
            }
            TriangleFeature::Face => unit_normal(self.triangle(triangle)),
        })
    }
}

/// Six times the enclosed volume, negative if the triangles are clockwise seen from outside. It is computed about the
/// first vertex, so that a mesh far from the origin does not lose precision.
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
        let positions = corners.map(|v| vertices[v as usize]);
        let normal = unit_normal(positions);
        for i in 0..3 {
            let [a, b] = [1, 2].map(|j| positions[(i + j) % 3] - positions[i]);
            let angle = atan2(a.cross(b).norm(), a.dot(b));
            normals[corners[i] as usize] += normal * angle;
        }
    }
    normals
}

/// Unit normal of a triangle; zero if it has no area.
fn unit_normal([a, b, c]: [Vector3<f64>; 3]) -> Vector3<f64> {
    let normal = (b - a).cross(c - a);
    let length = normal.norm();
    match length > 0.0 {
        true => normal * length.recip(),
        false => Vector3::zero(),
    }
}
