//! Closed convex surface of triangles that grows by points, for quickhull and EPA (Barber, Dobkin & Huhdanpaa 1996).
//!
//! The side of a facet that a point is on is computed exactly, by Shewchuk's predicate. Coplanar and collinear points
//! therefore never tear the surface.

use robust::{Coord3D, orient3d};

use kinopt_kinematics::spatial::Vector3;

/// Triangular facets over points.
#[derive(Clone, Debug, Default)]
pub(crate) struct ConvexSurface {
    pub(crate) points: Vec<Vector3<f64>>,
    pub(crate) facets: Vec<Facet>,
    /// Facets hidden by the last inserted point.
    pub(crate) hidden: Vec<u32>,
    /// Facets made by the last inserted point.
    pub(crate) new_facets: Vec<u32>,
    /// Boundary of the hidden region: from, to, and the facet beyond.
    rim: Vec<(u32, u32, u32)>,
}

/// A triangle, counter-clockwise seen from outside.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Facet {
    pub(crate) corners: [u32; 3],
    /// The adjacent facets across the sides. A side runs from a corner to the next.
    across: [u32; 3],
    /// True unless a later point hides the facet.
    pub(crate) alive: bool,
}

impl ConvexSurface {
    /// A tetrahedron; `None` if the points have no volume.
    pub(crate) fn tetrahedron(mut points: [Vector3<f64>; 4]) -> Option<Self> {
        let volume = below([points[0], points[1], points[2]], points[3]);
        if volume == 0.0 {
            return None;
        }
        if volume < 0.0 {
            points.swap(0, 1);
        }
        let facet = |corners, across| Facet {
            corners,
            across,
            alive: true,
        };
        // The fourth point lies below the plane of the first three.
        Some(Self {
            points: points.to_vec(),
            facets: vec![
                facet([0, 1, 2], [1, 2, 3]),
                facet([1, 0, 3], [0, 3, 2]),
                facet([2, 1, 3], [0, 1, 3]),
                facet([0, 2, 3], [0, 2, 1]),
            ],
            ..Self::default()
        })
    }

    /// The corners of a facet.
    pub(crate) fn corners(&self, facet: u32) -> [Vector3<f64>; 3] {
        let corners = self.facets[facet as usize].corners;
        corners.map(|corner| self.points[corner as usize])
    }

    /// True if a point is strictly outside a facet's plane.
    pub(crate) fn sees(&self, facet: u32, point: Vector3<f64>) -> bool {
        below(self.corners(facet), point) < 0.0
    }

    /// Inserts a point that sees the facet `visible`. The hidden and the new facets are in `hidden` and `new_facets`.
    pub(crate) fn insert(&mut self, point: Vector3<f64>, visible: u32) {
        self.hidden.clear();
        self.new_facets.clear();
        self.rim.clear();
        self.facets[visible as usize].alive = false;
        self.hidden.push(visible);
        let mut next = 0;
        while let Some(&facet) = self.hidden.get(next) {
            next += 1;
            let Facet {
                corners, across, ..
            } = self.facets[facet as usize];
            for side in 0..3 {
                let neighbour = across[side];
                if !self.facets[neighbour as usize].alive {
                    continue;
                }
                if self.sees(neighbour, point) {
                    self.facets[neighbour as usize].alive = false;
                    self.hidden.push(neighbour);
                } else {
                    self.rim
                        .push((corners[side], corners[(side + 1) % 3], neighbour));
                }
            }
        }
        // A facet that was alive at the test of its neighbour may be hidden by a later step.
        let facets = &self.facets;
        self.rim
            .retain(|&(_, _, neighbour)| facets[neighbour as usize].alive);
        self.rim.sort_unstable();
        let apex = self.points.len() as u32;
        self.points.push(point);
        let first = self.facets.len() as u32;
        for index in 0..self.rim.len() {
            let (from, to, neighbour) = self.rim[index];
            // The rim is one closed polygon: each corner starts one side and ends another.
            let after = self.rim.partition_point(|&(start, _, _)| start < to) as u32;
            self.facets.push(Facet {
                corners: [from, to, apex],
                across: [neighbour, first + after, u32::MAX],
                alive: true,
            });
            self.new_facets.push(first + index as u32);
            let outer = &mut self.facets[neighbour as usize];
            for side in 0..3 {
                if outer.corners[side] == to && outer.corners[(side + 1) % 3] == from {
                    outer.across[side] = first + index as u32;
                }
            }
        }
        for &facet in &self.new_facets {
            let after = self.facets[facet as usize].across[1];
            if let Some(after) = self.facets.get_mut(after as usize) {
                after.across[2] = facet;
            }
        }
    }
}

/// Positive if `point` lies below the plane of three points, counter-clockwise seen from above. The sign is exact.
fn below(plane: [Vector3<f64>; 3], point: Vector3<f64>) -> f64 {
    let [a, b, c] = plane.map(coordinates);
    orient3d(a, b, c, coordinates(point))
}

fn coordinates(Vector3 { x, y, z }: Vector3<f64>) -> Coord3D<f64> {
    Coord3D { x, y, z }
}
