//! Weights for a mesh that has none: bones pull at what is near, evened out over the surface.

use glam::DVec3;

use super::{SkinWeights, WeightsError};
use crate::mesh::TriangleMesh;
use crate::scalar::elementary;
use crate::skeleton::Skeleton;

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
/// few weights of each vertex stay, divided by their sum.
///
/// Distances are straight, also through gaps: two legs that touch pull at each other's skin. The
/// same input gives the same bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AutomaticWeights {
    /// p: how fast a bone's pull falls with distance; larger is stiffer. Above 0.
    pub falloff: f64,
    /// How often weights are evened out over the mesh's edges.
    pub smoothing_steps: u32,
    /// The most influences a vertex keeps; 0 counts as 1.
    pub most: usize,
}

/// Why no weights can be made up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AutomaticWeightsError {
    /// There are no bones.
    #[error("there are no bones to follow")]
    NoBones,
    /// The falloff is not a number above 0.
    #[error("a falloff of {0} is not a finite number above 0")]
    Falloff(f64),
    /// A bone's end is NaN or infinite.
    #[error("bone {bone}: an end of it is not finite")]
    NonFiniteBone {
        /// Which bone, from 0.
        bone: usize,
    },
    /// The weights could not be normalised.
    #[error(transparent)]
    Weights(#[from] WeightsError),
}

impl Default for AutomaticWeights {
    /// Falloff 4, ten smoothing steps, four influences.
    fn default() -> Self {
        Self {
            falloff: 4.0,
            smoothing_steps: 10,
            most: 4,
        }
    }
}

impl AutomaticWeights {
    /// Weights for a skeleton's bones at rest, in the mesh's own frame and unit.
    ///
    /// # Errors
    /// The skeleton has no bones, or the falloff is not above 0.
    pub fn for_skeleton(
        &self,
        mesh: &TriangleMesh,
        skeleton: &Skeleton,
    ) -> Result<SkinWeights, AutomaticWeightsError> {
        let end = |v: crate::spatial::Vector3<f64>| DVec3::from_array(v.to_array());
        let bones = skeleton.bones().iter();
        let segments: Vec<_> = bones
            .map(|bone| [end(bone.rest_tail()), end(bone.rest_tip())])
            .collect();
        self.for_segments(mesh, &segments)
    }

    /// Weights for bones given as [tail, tip]; a bone without length is a point.
    ///
    /// # Errors
    /// There are no bones, an end is not finite, or the falloff is not above 0.
    pub fn for_segments(
        &self,
        mesh: &TriangleMesh,
        segments: &[[DVec3; 2]],
    ) -> Result<SkinWeights, AutomaticWeightsError> {
        if segments.is_empty() {
            return Err(AutomaticWeightsError::NoBones);
        }
        if !(self.falloff > 0.0 && self.falloff.is_finite()) {
            return Err(AutomaticWeightsError::Falloff(self.falloff));
        }
        let broken = |[tail, tip]: &[DVec3; 2]| !(tail.is_finite() && tip.is_finite());
        if let Some(bone) = segments.iter().position(broken) {
            return Err(AutomaticWeightsError::NonFiniteBone { bone });
        }
        let points: Vec<DVec3> = mesh.positions().iter().map(|p| p.as_dvec3()).collect();
        let nearest = nearest_distances(&points, segments);
        let core = 1e-3 * mesh.size();
        // As a share of the nearest bone's pull, which a high power could not overflow.
        let pull = |point: usize, segment: &[DVec3; 2]| {
            let squared = |distance: f64| distance * distance + core * core;
            let ratio = squared(nearest[point]) / squared(distance(points[point], segment));
            // A point on a bone of a mesh without size is 0 / 0 apart.
            if ratio.is_nan() {
                1.0
            } else {
                elementary::pow(ratio, 0.5 * self.falloff)
            }
        };
        let mut sums = vec![0.0; points.len()];
        for segment in segments {
            for (point, sum) in sums.iter_mut().enumerate() {
                *sum += pull(point, segment);
            }
        }
        // A bone at a time, so that memory does not grow with their number.
        let neighbours = Neighbours::of(mesh);
        let mut kept: Vec<Vec<(usize, f64)>> = vec![Vec::new(); points.len()];
        for (bone, segment) in segments.iter().enumerate() {
            let shares = sums.iter().enumerate();
            let mut column: Vec<f64> = shares.map(|(i, sum)| pull(i, segment) / sum).collect();
            for _ in 0..self.smoothing_steps {
                column = neighbours.evened_out(&column);
            }
            for (row, &weight) in kept.iter_mut().zip(&column) {
                keep_largest(row, (bone, weight), self.most.max(1));
            }
        }
        let mut builder = SkinWeights::builder(points.len(), segments.len());
        for (vertex, row) in kept.iter().enumerate() {
            let sum: f64 = row.iter().map(|(_, weight)| weight).sum();
            for (bone, weight) in row {
                builder.add(vertex, *bone, weight / sum)?;
            }
        }
        Ok(builder.build()?)
    }
}

fn nearest_distances(points: &[DVec3], segments: &[[DVec3; 2]]) -> Vec<f64> {
    let nearest = |point: &DVec3| {
        let distances = segments.iter().map(|segment| distance(*point, segment));
        distances.fold(f64::INFINITY, f64::min)
    };
    points.iter().map(nearest).collect()
}

/// From a point to a segment.
fn distance(point: DVec3, [tail, tip]: &[DVec3; 2]) -> f64 {
    let along = *tip - *tail;
    let squared = along.length_squared();
    let share = if squared > 0.0 {
        ((point - *tail).dot(along) / squared).clamp(0.0, 1.0)
    } else {
        0.0
    };
    point.distance(*tail + share * along)
}

/// Puts an entry among the largest `most`; of equal ones the earlier stays.
fn keep_largest(row: &mut Vec<(usize, f64)>, entry: (usize, f64), most: usize) {
    let place = row.partition_point(|(_, weight)| *weight >= entry.1);
    row.insert(place, entry);
    row.truncate(most);
}

/// The other ends of each vertex's edges: compressed sparse rows.
struct Neighbours {
    starts: Vec<usize>,
    others: Vec<u32>,
}

impl Neighbours {
    fn of(mesh: &TriangleMesh) -> Self {
        let directed = |&[a, b, c]: &[u32; 3]| [(a, b), (b, a), (b, c), (c, b), (c, a), (a, c)];
        let mut edges: Vec<(u32, u32)> = mesh.triangles().iter().flat_map(directed).collect();
        edges.sort_unstable();
        edges.dedup();
        let mut starts = vec![0; mesh.positions().len() + 1];
        for &(vertex, _) in &edges {
            starts[vertex as usize + 1] += 1;
        }
        for vertex in 1..starts.len() {
            starts[vertex] += starts[vertex - 1];
        }
        let others = edges.into_iter().map(|(_, other)| other).collect();
        Self { starts, others }
    }

    /// ½ w_i + ½ (mean of w over i's neighbours); a vertex without neighbours keeps its own.
    fn evened_out(&self, column: &[f64]) -> Vec<f64> {
        let rows = self.starts.windows(2).zip(column);
        let mean = |(ends, &own): (&[usize], &f64)| {
            let others = &self.others[ends[0]..ends[1]];
            if others.is_empty() {
                return own;
            }
            let sum: f64 = others.iter().map(|&other| column[other as usize]).sum();
            0.5 * own + 0.5 * sum / others.len() as f64
        };
        rows.map(mean).collect()
    }
}
