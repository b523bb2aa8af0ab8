//! Weights by distance: bones pull at what is near, evened out over the surface.

use glam::DVec3;

use super::AutomaticWeightsError;
use super::neighbours::Neighbours;
use super::segments::{self, Segment, distance};
use super::smooth_pruning::Strongest;
use crate::mesh::TriangleMesh;
use crate::scalar::elementary;
use crate::skeleton::Skeleton;
use crate::skinning::SkinWeights;

/// How weights are made up.
///
/// With d_ij the distance of vertex i from bone j's segment (tail to tip at rest), s the mesh's size
/// and p the falloff,
///
/// ```text
/// w_ij = g_ij / Σ_k g_ik,   g_ij = (d_ij² + (s/1000)²)^(−p/2)
/// ```
///
/// and then, as many times as there are smoothing steps, every vertex takes the mean of its own
/// weight and the mean weight of its neighbours over edges. Both keep sums at 1. At last the largest
/// few weights of each vertex stay: with t the largest one that does not, as w − t²/w, divided by their
/// sum, and evened out where that takes anything away, so that an influence fades before it ends and
/// skin does not tear there.
///
/// Distances are straight, also through gaps: two legs that touch pull at each other's skin; weights by
/// heat (`HeatWeights`, feature `heat`) do not. The same input gives the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct AutomaticWeights {
    /// p: how fast a bone's pull falls with distance; larger is stiffer. Above 0.
    pub falloff: f64,
    /// How often weights are evened out over the mesh's edges.
    pub smoothing_steps: u32,
    /// The most influences a vertex keeps, at least 1. Four take the packed path, and steeper steps
    /// where many bones are near: palms, shoulders.
    pub most: usize,
}

impl Default for AutomaticWeights {
    /// Falloff 4, ten smoothing steps, eight influences.
    fn default() -> Self {
        Self {
            falloff: 4.0,
            smoothing_steps: 10,
            most: 8,
        }
    }
}

impl AutomaticWeights {
    /// Weights for a skeleton's bones at rest, in the mesh's own frame and unit.
    ///
    /// # Errors
    /// The skeleton has no bones, the falloff is not above 0, or no influence may stay.
    pub fn for_skeleton(
        &self,
        mesh: &TriangleMesh,
        skeleton: &Skeleton,
    ) -> Result<SkinWeights, AutomaticWeightsError> {
        self.for_segments(mesh, &segments::of_skeleton(skeleton))
    }

    /// Weights for bones given as [tail, tip]; a bone without length is a point.
    ///
    /// # Errors
    /// There are no bones, an end is not finite, the falloff is not above 0, or no influence may stay.
    pub fn for_segments(
        &self,
        mesh: &TriangleMesh,
        segments: &[[DVec3; 2]],
    ) -> Result<SkinWeights, AutomaticWeightsError> {
        segments::check(segments, self.most)?;
        if !(self.falloff > 0.0 && self.falloff.is_finite()) {
            return Err(AutomaticWeightsError::Falloff(self.falloff));
        }
        let points: Vec<DVec3> = mesh.positions().iter().map(|p| p.as_dvec3()).collect();
        let nearest = nearest_distances(&points, segments);
        let core = 1e-3 * mesh.size();
        // As a share of the nearest bone's pull, which a high power could not overflow.
        let pull = |point: usize, segment: &Segment| {
            let squared = |distance: f64| distance * distance + core * core;
            let ratio = squared(nearest[point]) / squared(distance(points[point], segment));
            // A point on a bone of a mesh without size is 0 / 0 apart.
            match ratio.is_nan() {
                true => 1.0,
                false => elementary::pow(ratio, 0.5 * self.falloff),
            }
        };
        let mut sums = vec![0.0; points.len()];
        for segment in segments {
            for (point, sum) in sums.iter_mut().enumerate() {
                *sum += pull(point, segment);
            }
        }
        // A bone at a time, so that memory does not grow with their number.
        let neighbours = Neighbours::of(points.len(), mesh.triangles().iter().copied());
        let mut strongest = Strongest::new(points.len(), self.most);
        for (bone, segment) in segments.iter().enumerate() {
            let shares = sums.iter().enumerate();
            let mut column: Vec<f64> = shares.map(|(i, sum)| pull(i, segment) / sum).collect();
            for _ in 0..self.smoothing_steps {
                column = evened_out(&neighbours, &column);
            }
            strongest.add(bone, column);
        }
        let rows: Vec<usize> = (0..points.len()).collect();
        Ok(strongest.build(segments.len(), &rows, &neighbours)?)
    }
}

fn nearest_distances(points: &[DVec3], segments: &[Segment]) -> Vec<f64> {
    let nearest = |point: &DVec3| {
        let distances = segments.iter().map(|segment| distance(*point, segment));
        distances.fold(f64::INFINITY, f64::min)
    };
    points.iter().map(nearest).collect()
}

/// ½ w_i + ½ (mean of w over i's neighbours); a vertex without neighbours keeps its own.
fn evened_out(neighbours: &Neighbours, column: &[f64]) -> Vec<f64> {
    let rows = neighbours.rows().zip(column);
    let mean = |(others, &own): (&[u32], &f64)| {
        if others.is_empty() {
            return own;
        }
        let sum: f64 = others.iter().map(|&other| column[other as usize]).sum();
        0.5 * own + 0.5 * sum / others.len() as f64
    };
    rows.map(mean).collect()
}
