//! Heat sources: the bones that heat each point, and their strength.

use super::crossings::Crossings;
use super::stiffness::Stiffness;
use super::surface::Surface;
use crate::skinning::automatic_weights::segments::{Segment, distance, nearest_point};

/// Largest relative excess over the smallest distance at which a bone still counts as nearest.
const AS_NEAR: f64 = 1e-4;
/// Lower bound of distances to bones, relative to the size of the mesh.
const NEAREST: f64 = 1e-3;

pub(super) struct Sources {
    /// A_i H_i of each point.
    pub(super) given: Vec<f64>,
    /// The points that each bone heats, with A_i H_i p_ij.
    pub(super) of_bones: Vec<Vec<(usize, f64)>>,
}

impl Sources {
    pub(super) fn of(
        surface: &Surface,
        stiffness: &Stiffness,
        segments: &[Segment],
        heat: f64,
    ) -> Self {
        let mut own = Self {
            given: vec![0.0; surface.points.len()],
            of_bones: vec![Vec::new(); segments.len()],
        };
        let crossings = Crossings::of(surface);
        for point in 0..surface.points.len() {
            own.heat(surface, stiffness, segments, heat, point, |segment| {
                let place = nearest_point(surface.points[point], segment);
                !crossings.hide(point, place)
            });
        }
        for point in own.points_of_cold_pieces(stiffness) {
            own.heat(surface, stiffness, segments, heat, point, |_| true);
        }
        own
    }

    /// Heats a point by the nearest bones that are visible from it.
    fn heat(
        &mut self,
        surface: &Surface,
        stiffness: &Stiffness,
        segments: &[Segment],
        heat: f64,
        point: usize,
        sees: impl Fn(&Segment) -> bool,
    ) {
        let place = surface.points[point];
        let distances = segments.iter().map(|segment| distance(place, segment));
        let nearest = distances.clone().fold(f64::INFINITY, f64::min);
        let near = nearest.max(NEAREST);
        let each = stiffness.areas[point] * heat / (near * near);
        for (bone, (segment, distance)) in segments.iter().zip(distances).enumerate() {
            if distance <= nearest * (1.0 + AS_NEAR) && sees(segment) {
                self.given[point] += each;
                self.of_bones[bone].push((point, each));
            }
        }
    }

    /// The points of connected pieces without a heated point.
    fn points_of_cold_pieces(&self, stiffness: &Stiffness) -> Vec<usize> {
        let mut leader: Vec<usize> = (0..self.given.len()).collect();
        for &(a, b, _) in &stiffness.edges {
            let [a, b] = [a, b].map(|point| find(&mut leader, point));
            leader[a.max(b)] = a.min(b);
        }
        let leaders: Vec<usize> = (0..leader.len()).map(|p| find(&mut leader, p)).collect();
        let mut warm = vec![false; leaders.len()];
        for (&leader, &given) in leaders.iter().zip(&self.given) {
            warm[leader] |= given > 0.0;
        }
        let points = leaders.into_iter().enumerate();
        let cold = points.filter(|(_, leader)| !warm[*leader]);
        cold.map(|(point, _)| point).collect()
    }
}

/// Root of the set of a point in a union-find forest, with path halving.
fn find(leader: &mut [usize], mut point: usize) -> usize {
    while leader[point] != point {
        leader[point] = leader[leader[point]];
        point = leader[point];
    }
    point
}
