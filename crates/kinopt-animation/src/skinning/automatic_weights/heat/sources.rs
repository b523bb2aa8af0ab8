//! Heat sources: the bones that heat each point, and their strength.

use super::crossings::Crossings;
use super::stiffness::Stiffness;
use super::surface::Surface;
use crate::skinning::automatic_weights::segments::{BoneSegment, distance, nearest_point};

/// Largest relative excess over the smallest distance at which a bone still counts as nearest.
const NEAREST_TOLERANCE: f64 = 1e-4;
/// Lower bound of distances to bones, relative to the size of the mesh.
const MIN_DISTANCE: f64 = 1e-3;

pub(super) struct Sources {
    /// A_i H_i of each point.
    pub(super) given: Vec<f64>,
    /// The points that each bone heats, with A_i H_i p_ij.
    pub(super) of_bones: Vec<Vec<(usize, f64)>>,
}

impl Sources {
    pub(super) fn new(
        surface: &Surface,
        stiffness: &Stiffness,
        segments: &[BoneSegment],
        heat: f64,
    ) -> Self {
        let mut sources = Self {
            given: vec![0.0; surface.points.len()],
            of_bones: vec![Vec::new(); segments.len()],
        };
        let crossings = Crossings::new(surface);
        for point in 0..surface.points.len() {
            sources.heat(surface, stiffness, segments, heat, point, |segment| {
                let target = nearest_point(surface.points[point], segment);
                !crossings.is_hidden(point, target)
            });
        }
        for point in sources.points_of_unheated_components(stiffness) {
            sources.heat(surface, stiffness, segments, heat, point, |_| true);
        }
        sources
    }

    /// Heats a point by the nearest bones that are visible from it.
    fn heat(
        &mut self,
        surface: &Surface,
        stiffness: &Stiffness,
        segments: &[BoneSegment],
        heat: f64,
        point: usize,
        is_visible: impl Fn(&BoneSegment) -> bool,
    ) {
        let position = surface.points[point];
        let distances = segments.iter().map(|segment| distance(position, segment));
        let nearest = distances.clone().fold(f64::INFINITY, f64::min);
        let clamped = nearest.max(MIN_DISTANCE);
        let amount = stiffness.areas[point] * heat / (clamped * clamped);
        for (bone, (segment, distance)) in segments.iter().zip(distances).enumerate() {
            if distance <= nearest * (1.0 + NEAREST_TOLERANCE) && is_visible(segment) {
                self.given[point] += amount;
                self.of_bones[bone].push((point, amount));
            }
        }
    }

    /// The points of connected pieces without a heated point.
    fn points_of_unheated_components(&self, stiffness: &Stiffness) -> Vec<usize> {
        let mut parents: Vec<usize> = (0..self.given.len()).collect();
        for &(a, b, _) in &stiffness.edges {
            let [a, b] = [a, b].map(|point| find(&mut parents, point));
            parents[a.max(b)] = a.min(b);
        }
        let roots: Vec<usize> = (0..parents.len()).map(|p| find(&mut parents, p)).collect();
        let mut is_heated = vec![false; roots.len()];
        for (&root, &given) in roots.iter().zip(&self.given) {
            is_heated[root] |= given > 0.0;
        }
        let points = roots.into_iter().enumerate();
        let cold = points.filter(|(_, root)| !is_heated[*root]);
        cold.map(|(point, _)| point).collect()
    }
}

/// Root of the set of a point in a union-find forest, with path halving.
fn find(parents: &mut [usize], mut point: usize) -> usize {
    while parents[point] != point {
        parents[point] = parents[parents[point]];
        point = parents[point];
    }
    point
}
