//! Connected parts of a mesh.

use std::collections::HashMap;

use super::MeshFile;

impl MeshFile {
    /// The connected parts, in the order of their first triangles. Vertices at the same position count as one.
    #[must_use]
    pub fn parts(&self) -> Vec<Self> {
        let mut above: Vec<u32> = (0..self.points.len() as u32).collect();
        let mut places: HashMap<[u64; 3], u32> = HashMap::new();
        for &corner in self.triangles.iter().flatten() {
            let place = self.points[corner as usize].to_array();
            let first = *places
                .entry(place.map(|x| (x + 0.0).to_bits()))
                .or_insert(corner);
            join(&mut above, first, corner);
        }
        for &[a, b, c] in &self.triangles {
            join(&mut above, a, b);
            join(&mut above, b, c);
        }
        let mut order: Vec<u32> = Vec::new();
        let mut parts: HashMap<u32, Vec<[u32; 3]>> = HashMap::new();
        for &triangle in &self.triangles {
            let root = root(&mut above, triangle[0]);
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
        let mut renamed: HashMap<u32, u32> = HashMap::new();
        let mut points = Vec::new();
        let triangles = triangles.iter().map(|corners| {
            corners.map(|corner| {
                *renamed.entry(corner).or_insert_with(|| {
                    points.push(self.points[corner as usize]);
                    points.len() as u32 - 1
                })
            })
        });
        let triangles = triangles.collect();
        Self { points, triangles }
    }
}

fn root(above: &mut [u32], mut point: u32) -> u32 {
    while above[point as usize] != point {
        let next = above[above[point as usize] as usize];
        above[point as usize] = next;
        point = next;
    }
    point
}

fn join(above: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(above, a), root(above, b));
    above[a.max(b) as usize] = a.min(b);
}
