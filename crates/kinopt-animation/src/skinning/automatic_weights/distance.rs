//! Skin weights computed from distances to the bones and smoothed over the surface.

use glam::DVec3;

use super::neighbours::Neighbours;
use super::segments::{self, BoneSegment, distance};
use super::smooth_pruning::Strongest;
use crate::skinning::{SkinWeights, SkinningError};
use kinopt_kinematics::scalar::elementary;
use kinopt_kinematics::skeleton::Skeleton;
use kinopt_mesh::mesh::TriangleMesh;

/// Parameters of skin weights computed from distances.
///
/// d_ij is the distance of vertex i from the segment of bone j (tail to tip at rest). s is the size of the mesh and p
/// the falloff.
///
/// ```text
/// w_ij = g_ij / Σ_k g_ik,   g_ij = (d_ij² + (s/1000)²)^(−p/2)
/// ```
///
/// Each smoothing step then replaces a weight by the mean of itself and the mean weight of the neighbours over edges.
/// Both keep sums at 1.
///
/// Pruning at the end keeps the largest weights of each vertex. With t the largest removed weight, a kept weight w
/// becomes w − t²/w, and the row is normalised. Weights near such vertices are smoothed again, so that an influence
/// fades before it ends and the skin has no visible step.
///
/// Distances are straight lines, also through gaps: two legs in contact influence each other's skin. Bone heat weights
/// (`HeatWeights`, feature `heat`) avoid this. Results are bitwise reproducible.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct AutomaticWeights {
    /// p: exponent with which the influence of a bone falls with distance. Larger values give stiffer skin. Above 0.
    pub falloff: f64,
    /// Number of smoothing steps over the mesh's edges.
    pub smoothing_steps: u32,
    /// Largest number of influences per vertex, at least 1. Four allow packed weights, but give steeper transitions at
    /// palms and shoulders, which many bones influence.
    pub most: usize,
}

impl Default for AutomaticWeights {
    /// Falloff 4, 10 smoothing steps, 8 influences.
    fn default() -> Self {
        Self {
            falloff: 4.0,
            smoothing_steps: 10,
            most: 8,
        }
    }
}

impl AutomaticWeights {
    /// Weights for the bones of a skeleton at rest, in the mesh's frame and unit.
    ///
    /// # Errors
    /// The skeleton has no bones, the falloff is not above 0, or `most` is 0.
    pub fn for_skeleton(
        &self,
        mesh: &TriangleMesh,
        skeleton: &Skeleton,
    ) -> Result<SkinWeights, SkinningError> {
        self.for_segments(mesh, &segments::of_skeleton(skeleton))
    }

    /// Weights for bones given as [tail, tip]. A bone of length 0 is a point.
    ///
    /// # Errors
    /// There are no bones, an end is not finite, the falloff is not above 0, or `most` is 0.
    pub fn for_segments(
        &self,
        mesh: &TriangleMesh,
        segments: &[[DVec3; 2]],
    ) -> Result<SkinWeights, SkinningError> {
        segments::check(segments, self.most)?;
        if !(self.falloff > 0.0 && self.falloff.is_finite()) {
            return Err(SkinningError::Falloff(self.falloff));
        }
        let points: Vec<DVec3> = mesh.positions().iter().map(|p| p.as_dvec3()).collect();
        let nearest = nearest_distances(&points, segments);
        let core_radius = 1e-3 * mesh.size();
        // Relative to the nearest bone, so that high exponents do not overflow.
        let influence = |point: usize, segment: &BoneSegment| {
            let squared = |distance: f64| distance * distance + core_radius * core_radius;
            let ratio = squared(nearest[point]) / squared(distance(points[point], segment));
            // A point on a bone of a mesh of size 0 gives 0 / 0.
            match ratio.is_nan() {
                true => 1.0,
                false => elementary::pow(ratio, 0.5 * self.falloff),
            }
        };
        let mut sums = vec![0.0; points.len()];
        for segment in segments {
            for (point, sum) in sums.iter_mut().enumerate() {
                *sum += influence(point, segment);
            }
        }
        // One bone at a time, so that memory does not grow with the number of bones.
        let neighbours = Neighbours::new(points.len(), mesh.triangles().iter().copied());
        let mut strongest = Strongest::new(points.len(), self.most);
        for (bone, segment) in segments.iter().enumerate() {
            let point_sums = sums.iter().enumerate();
            let mut column: Vec<f64> = point_sums
                .map(|(i, sum)| influence(i, segment) / sum)
                .collect();
            for _ in 0..self.smoothing_steps {
                column = smoothed(&neighbours, &column);
            }
            strongest.add(bone, column);
        }
        let rows: Vec<usize> = (0..points.len()).collect();
        strongest.build(segments.len(), &rows, &neighbours)
    }
}

fn nearest_distances(points: &[DVec3], segments: &[BoneSegment]) -> Vec<f64> {
    let nearest = |point: &DVec3| {
        let distances = segments.iter().map(|segment| distance(*point, segment));
        distances.fold(f64::INFINITY, f64::min)
    };
    points.iter().map(nearest).collect()
}

/// ½ w_i + ½ (mean of w over the neighbours of i). A vertex without neighbours keeps its weight.
fn smoothed(neighbours: &Neighbours, column: &[f64]) -> Vec<f64> {
    let rows = neighbours.rows().zip(column);
    let mean = |(others, &weight): (&[u32], &f64)| {
        if others.is_empty() {
            return weight;
        }
        let sum: f64 = others.iter().map(|&other| column[other as usize]).sum();
        0.5 * weight + 0.5 * sum / others.len() as f64
    };
    rows.map(mean).collect()
}
