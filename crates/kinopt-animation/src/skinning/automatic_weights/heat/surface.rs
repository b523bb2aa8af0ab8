//! A mesh as a surface: vertices at one position are one point.

use std::collections::BTreeMap;

use glam::DVec3;

use kinopt_mesh::mesh::TriangleMesh;

/// Points and triangles, in units of the mesh's size.
pub(super) struct Surface {
    pub(super) points: Vec<DVec3>,
    /// Triangles with three different corners.
    pub(super) triangles: Vec<[usize; 3]>,
    /// Point index of each vertex of the mesh; the vertices of a seam share a point.
    pub(super) point_of: Vec<usize>,
    /// Size of the mesh, or 1 for a mesh of size 0.
    pub(super) unit: f64,
}

impl Surface {
    pub(super) fn new(mesh: &TriangleMesh) -> Self {
        let unit = Some(mesh.size()).filter(|size| *size > 0.0).unwrap_or(1.0);
        let mut points = Vec::new();
        let mut known: BTreeMap<[u32; 3], usize> = BTreeMap::new();
        let positions = mesh.positions().iter();
        let point_of: Vec<usize> = positions
            .map(|position| {
                // The addition maps −0 to 0.
                let key = (*position + glam::Vec3::ZERO).to_array().map(f32::to_bits);
                *known.entry(key).or_insert_with(|| {
                    points.push(position.as_dvec3() / unit);
                    points.len() - 1
                })
            })
            .collect();
        let triangles = mesh.triangles().iter();
        let triangles = triangles.map(|corners| {
            corners.map(|corner| point_of.get(corner as usize).copied().unwrap_or(0))
        });
        let nondegenerate = triangles.filter(|[a, b, c]| a != b && b != c && c != a);
        Self {
            triangles: nondegenerate.collect(),
            points,
            point_of,
            unit,
        }
    }

    pub(super) fn corners(&self, triangle: [usize; 3]) -> [DVec3; 3] {
        triangle.map(|point| self.points[point])
    }
}
