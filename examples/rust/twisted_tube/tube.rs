//! A tube with a bone at each end, for comparisons of skinning methods.

use std::f64::consts::TAU;

use glam::{Affine3A, DVec3, Quat, Vec3};

use kinopt::mesh::{MeshError, TriangleMesh};
use kinopt::skinning::{SkinWeights, SkinningError};

/// A closed tube along x with flat ends. Bone 0 holds the end at x = 0. Bone 1 holds the end at `length` and twists
/// about x. Between them, weights are interpolated linearly over a middle part.
///
/// Linear blend shrinks the area of a ring of weight w, twisted by φ, to the fraction 1 − 2 w (1 − w)(1 − cos φ). That
/// is 0 in the middle for φ = π (the "candy wrapper" artefact). The mean over the middle part is 1 − (1 − cos φ)/3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwistedTube {
    /// Radius, in any unit.
    pub radius: f64,
    /// Length from end to end, in the unit of the radius.
    pub length: f64,
    /// Fraction of the length over which weights are interpolated, 0 to 1.
    pub blended_share: f64,
    /// Number of corners of each ring, at least 3.
    pub sides: u32,
    /// Number of rings, both ends included, at least 2.
    pub rings: u32,
}

impl Default for TwistedTube {
    /// Radius 1, length 8, the middle half blended, 64 sides, 129 rings.
    fn default() -> Self {
        Self {
            radius: 1.0,
            length: 8.0,
            blended_share: 0.5,
            sides: 64,
            rings: 129,
        }
    }
}

impl TwistedTube {
    /// The mesh at rest, with normals. Fewer than 3 sides or 2 rings are raised to these minima.
    ///
    /// # Errors
    /// A coordinate is not finite in single precision.
    pub fn mesh(&self) -> Result<TriangleMesh, MeshError> {
        let (sides, rings) = (self.sides.max(3), self.rings.max(2));
        let mut positions = Vec::new();
        for ring in 0..rings {
            for side in 0..sides {
                let (sin, cos) = (TAU * f64::from(side) / f64::from(sides)).sin_cos();
                let corner = DVec3::new(self.along(ring), self.radius * cos, self.radius * sin);
                positions.push(corner.as_vec3());
            }
        }
        let corner = |ring: u32, side: u32| ring * sides + side % sides;
        let mut triangles = Vec::new();
        for ring in 1..rings {
            for side in 0..sides {
                let [a, b] = [side, side + 1].map(|side| corner(ring - 1, side));
                let [c, d] = [side, side + 1].map(|side| corner(ring, side));
                // Alternating diagonals, so that the tube has no handedness.
                if (ring + side) % 2 == 0 {
                    triangles.extend([[a, b, d], [a, d, c]]);
                } else {
                    triangles.extend([[a, b, c], [b, d, c]]);
                }
            }
        }
        let centre = rings * sides;
        positions.push(Vec3::ZERO);
        positions.push(Vec3::new(self.length as f32, 0.0, 0.0));
        for side in 0..sides {
            triangles.push([centre, corner(0, side + 1), corner(0, side)]);
            let [c, d] = [side, side + 1].map(|side| corner(rings - 1, side));
            triangles.push([centre + 1, c, d]);
        }
        Ok(TriangleMesh::new(positions, Vec::new(), triangles)?.with_computed_normals())
    }

    /// The weights of the vertices of [`mesh`](Self::mesh) for the two bones.
    ///
    /// # Errors
    /// The blended share is not finite.
    pub fn weights(&self) -> Result<SkinWeights, SkinningError> {
        let (sides, rings) = (self.sides.max(3), self.rings.max(2));
        let on_rings = (0..rings).flat_map(|ring| (0..sides).map(move |_| ring));
        let vertices = on_rings.chain([0, rings - 1]);
        let mut builder = SkinWeights::builder((rings * sides) as usize + 2, 2);
        for (vertex, ring) in vertices.enumerate() {
            let fraction = f64::from(ring) / f64::from(rings - 1);
            let raw_weight = (fraction - 0.5) / self.blended_share.max(1e-9) + 0.5;
            let weight = raw_weight.clamp(0.0, 1.0);
            builder.add(vertex, 0, 1.0 - weight)?;
            builder.add(vertex, 1, weight)?;
        }
        builder.build()
    }

    /// The transforms of the two bones (rest → posed) for a twist in radians.
    #[must_use]
    pub fn transforms(twist: f64) -> [Affine3A; 2] {
        let (sin, cos) = (0.5 * twist).sin_cos();
        let rotation = Quat::from_xyzw(sin as f32, 0.0, 0.0, cos as f32);
        [Affine3A::IDENTITY, Affine3A::from_quat(rotation)]
    }

    /// Mean radius of each ring of a posed [`mesh`](Self::mesh), from bone 0 to bone 1: (x at rest, radius) in the
    /// tube's unit.
    #[must_use]
    pub fn ring_radii(&self, posed: &TriangleMesh) -> Vec<(f64, f64)> {
        let sides = self.sides.max(3) as usize;
        let rings = posed.positions().chunks_exact(sides);
        let radius = |ring: &[Vec3]| {
            let points = ring.iter().map(|p| p.as_dvec3());
            let distances = points.map(|p| p.y.hypot(p.z));
            distances.sum::<f64>() / sides as f64
        };
        let coordinates = (0..self.rings.max(2)).map(|ring| self.along(ring));
        coordinates.zip(rings.map(radius)).collect()
    }

    fn along(&self, ring: u32) -> f64 {
        self.length * f64::from(ring) / f64::from(self.rings.max(2) - 1)
    }
}
