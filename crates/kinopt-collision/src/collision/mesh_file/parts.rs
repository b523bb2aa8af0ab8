//! Connected parts of a mesh.

use std::collections::HashMap;

use super::MeshFile;

impl MeshFile {
    /// The connected parts, in the order of their first triangles. Vertices at the same position count as one.
    #[must_use]
    pub fn parts(&self) -> Vec<Self> {
        let mut parents: Vec<u32> = (0..self.points.len() as u32).collect();
        let mut first_vertices: HashMap<[u64; 3], u32> = HashMap::new();
        for &corner in self.triangles.iter().flatten() {
            let position = self.points[corner as usize].to_array();
            let first = *first_vertices
                .entry(position.map(|x| (x + 0.0).to_bits()))
                .or_insert(corner);
            join(&mut parents, first, corner);
        }
        for &[a, b, c] in &self.triangles {
            join(&mut parents, a, b);
            join(&mut parents, b, c);
        }
        let mut order: Vec<u32> = Vec::new();
        let mut parts: HashMap<u32, Vec<[u32; 3]>> = HashMap::new();
        for &triangle in &self.triangles {
            let root = root(&mut parents, triangle[0]);
            let part = parts.entry(root).or_insert_with(|| {
                order.push(root);
                Vec::new()
            });
            part.push(triangle);
        }
        let part = |root| self.with_triangles(&parts[root]);
        order.iter().map(part).collect()
    }

    /// The mesh without unused vertices: a stray vertex would enlarge a hull.
    pub(in crate::collision) fn without_loose_points(&self) -> Self {
        self.with_triangles(&self.triangles)
    }

    /// A mesh of some of the triangles and their vertices.
    fn with_triangles(&self, triangles: &[[u32; 3]]) -> Self {
        let mut new_indices: HashMap<u32, u32> = HashMap::new();
        let mut points = Vec::new();
        let triangles = triangles.iter().map(|corners| {
            corners.map(|corner| {
                *new_indices.entry(corner).or_insert_with(|| {
                    points.push(self.points[corner as usize]);
                    points.len() as u32 - 1
                })
            })
        });
        let triangles = triangles.collect();
        Self { points, triangles }
    }
}

fn root(parents: &mut [u32], mut point: u32) -> u32 {
    while parents[point as usize] != point {
        let grandparent = parents[parents[point as usize] as usize];
        parents[point as usize] = grandparent;
        point = grandparent;
    }
    point
}

fn join(parents: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parents, a), root(parents, b));
    parents[a.max(b) as usize] = a.min(b);
}
