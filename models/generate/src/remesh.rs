//! Isotropic remeshing (Botsch & Kobbelt 2004, "A remeshing approach to multiresolution modeling").
//!
//! Short edges collapse, edges flip towards six neighbours per vertex, and vertices spread evenly over the surface.
//! The mesh stays closed.

use glam::DVec3;

use crate::polygonise::Soup;
use crate::surface::Surface;

/// Length below which an edge collapses, and the maximum length of a new edge, as fractions of the target length.
const MIN_EDGE_RATIO: f64 = 0.85;
const MAX_EDGE_RATIO: f64 = 1.4;
const ROUNDS: usize = 12;

struct Mesh<'a> {
    surface: &'a Surface,
    positions: Vec<DVec3>,
    /// Target edge length at each vertex.
    target_lengths: Vec<f64>,
    triangles: Vec<Option<[u32; 3]>>,
    /// Triangles at each vertex.
    around: Vec<Vec<u32>>,
}

/// Remeshes a surface with the edge lengths of its parts.
pub(crate) fn remesh(soup: Soup, surface: &Surface) -> Soup {
    let mut around = vec![Vec::new(); soup.positions.len()];
    for (index, triangle) in soup.triangles.iter().enumerate() {
        for &vertex in triangle {
            around[vertex as usize].push(index as u32);
        }
    }
    let mut mesh = Mesh {
        surface,
        target_lengths: vec![0.0; soup.positions.len()],
        positions: soup.positions,
        triangles: soup.triangles.into_iter().map(Some).collect(),
        around,
    };
    mesh.set_target_lengths();
    for _ in 0..ROUNDS {
        mesh.collapse_short_edges();
        mesh.flip_edges();
        mesh.spread();
    }
    mesh.compact()
}

impl Mesh<'_> {
    /// Sets the target edge lengths from the parts, with gradual changes from vertex to vertex.
    fn set_target_lengths(&mut self) {
        for (target_length, &p) in self.target_lengths.iter_mut().zip(&self.positions) {
            *target_length = self.surface.part_at(p).map_or(0.0, |part| part.edge);
        }
        for _ in 0..8 {
            let vertices = 0..self.positions.len() as u32;
            let smooth = vertices.map(|vertex| {
                let neighbours = self.neighbours(vertex);
                let sum: f64 = neighbours
                    .iter()
                    .map(|&n| self.target_lengths[n as usize])
                    .sum();
                0.5 * (self.target_lengths[vertex as usize] + sum / neighbours.len().max(1) as f64)
            });
            self.target_lengths = smooth.collect();
        }
    }

    fn corners(&self, vertex: u32) -> impl Iterator<Item = [u32; 3]> {
        let triangles = self.around[vertex as usize].iter();
        triangles.filter_map(|&index| self.triangles[index as usize])
    }

    /// Sorted neighbours without duplicates.
    fn neighbours(&self, vertex: u32) -> Vec<u32> {
        let mut neighbours: Vec<u32> = self
            .corners(vertex)
            .flatten()
            .filter(|&v| v != vertex)
            .collect();
        neighbours.sort_unstable();
        neighbours.dedup();
        neighbours
    }

    fn normal(&self, [a, b, c]: [u32; 3]) -> DVec3 {
        let [a, b, c] = [a, b, c].map(|vertex| self.positions[vertex as usize]);
        (b - a).cross(c - a).normalize_or_zero()
    }

    fn collapse_short_edges(&mut self) {
        for a in 0..self.positions.len() as u32 {
            let (position, target_length) =
                (self.positions[a as usize], self.target_lengths[a as usize]);
            let mut neighbours = self.neighbours(a);
            let length = |&v: &u32| position.distance_squared(self.positions[v as usize]);
            neighbours.sort_by(|v, w| length(v).total_cmp(&length(w)));
            neighbours.retain(|v| length(v) < (MIN_EDGE_RATIO * target_length).powi(2));
            for b in neighbours {
                if self.collapse(a, b) {
                    break;
                }
            }
        }
    }

    /// Merges `b` into `a`, unless that would tear, fold or stretch the mesh.
    fn collapse(&mut self, a: u32, b: u32) -> bool {
        let (near_a, near_b) = (self.neighbours(a), self.neighbours(b));
        let shared = near_a
            .iter()
            .filter(|v| near_b.binary_search(v).is_ok())
            .count();
        let (pa, pb) = (self.positions[a as usize], self.positions[b as usize]);
        let middle = self.surface.project(0.5 * (pa + pb));
        let is_too_long = |v: u32| {
            middle.distance(self.positions[v as usize])
                > MAX_EDGE_RATIO * self.target_lengths[v as usize]
        };
        if shared != 2
            || near_a
                .iter()
                .chain(&near_b)
                .any(|&v| v != a && v != b && is_too_long(v))
        {
            return false;
        }
        let is_kept = |t: &[u32; 3]| !(t.contains(&a) && t.contains(&b));
        let moved: Vec<[u32; 3]> = self
            .corners(a)
            .chain(self.corners(b))
            .filter(is_kept)
            .collect();
        let before: Vec<DVec3> = moved.iter().map(|&t| self.normal(t)).collect();
        (self.positions[a as usize], self.positions[b as usize]) = (middle, middle);
        if moved
            .iter()
            .zip(&before)
            .any(|(&t, n)| self.normal(t).dot(*n) < 0.5)
        {
            (self.positions[a as usize], self.positions[b as usize]) = (pa, pb);
            return false;
        }
        for index in std::mem::take(&mut self.around[b as usize]) {
            let Some(triangle) = &mut self.triangles[index as usize] else {
                continue;
            };
            if triangle.contains(&a) {
                self.triangles[index as usize] = None;
            } else {
                *triangle = triangle.map(|v| if v == b { a } else { v });
                self.around[a as usize].push(index);
            }
        }
        for vertex in near_a.into_iter().chain([a]) {
            let triangles = &self.triangles;
            self.around[vertex as usize].retain(|&index| triangles[index as usize].is_some());
        }
        true
    }

    fn flip_edges(&mut self) {
        for a in 0..self.positions.len() as u32 {
            for b in self.neighbours(a) {
                if a < b {
                    self.flip(a, b);
                }
            }
        }
    }

    /// Flips the edge a–b between the triangles (a, b, c) and (b, a, d) to c–d. A flip must bring the numbers of
    /// neighbours nearer to six.
    fn flip(&mut self, a: u32, b: u32) {
        let opposite = |from: u32, to: u32| {
            self.around[from as usize].iter().find_map(|&index| {
                let t = self.triangles[index as usize]?;
                let corner = (0..3).find(|&k| t[k] == from && t[(k + 1) % 3] == to)?;
                Some((index, t[(corner + 2) % 3]))
            })
        };
        let (Some((first, c)), Some((second, d))) = (opposite(a, b), opposite(b, a)) else {
            return;
        };
        let valence = [a, b, c, d].map(|v| self.neighbours(v).len() as i32);
        let irregularity = |change: [i32; 4]| -> i32 {
            valence
                .iter()
                .zip(change)
                .map(|(n, change)| (n + change - 6).pow(2))
                .sum()
        };
        let (first_flipped, second_flipped) = ([a, d, c], [d, b, c]);
        let old = self.normal([a, b, c]) + self.normal([b, a, d]);
        let folds = [first_flipped, second_flipped]
            .iter()
            .any(|&t| self.normal(t).dot(old.normalize_or_zero()) < 0.8);
        let joined = self.neighbours(c).binary_search(&d).is_ok();
        if irregularity([-1, -1, 1, 1]) >= irregularity([0; 4])
            || folds
            || joined
            || valence[0].min(valence[1]) < 5
        {
            return;
        }
        self.triangles[first as usize] = Some(first_flipped);
        self.triangles[second as usize] = Some(second_flipped);
        self.around[a as usize].retain(|&t| t != second);
        self.around[b as usize].retain(|&t| t != first);
        self.around[c as usize].push(second);
        self.around[d as usize].push(first);
    }

    /// Moves every vertex along the surface towards the mean of its neighbours.
    fn spread(&mut self) {
        for vertex in 0..self.positions.len() as u32 {
            let neighbours = self.neighbours(vertex);
            if neighbours.is_empty() {
                continue;
            }
            let p = self.positions[vertex as usize];
            let sum: DVec3 = neighbours.iter().map(|&n| self.positions[n as usize]).sum();
            let normal = self.surface.normal(p);
            let step = sum / neighbours.len() as f64 - p;
            let position = p + 0.7 * (step - normal * step.dot(normal));
            self.positions[vertex as usize] = self.surface.project(position);
        }
    }

    /// Removes collapsed vertices and triangles.
    fn compact(self) -> Soup {
        let mut new_index = vec![u32::MAX; self.positions.len()];
        let mut soup = Soup::default();
        for triangle in self.triangles.into_iter().flatten() {
            soup.triangles.push(triangle.map(|vertex| {
                let vertex = vertex as usize;
                if new_index[vertex] == u32::MAX {
                    new_index[vertex] = soup.positions.len() as u32;
                    soup.positions.push(self.positions[vertex]);
                }
                new_index[vertex]
            }));
        }
        soup
    }
}
