//! Closure of cyclic paths: matching configurations of the first and the last station.

use std::f64::consts::TAU;

use super::PathError;
use super::layers::{Layer, LayerGenerator};
use crate::arm::Ends;

/// Maximum number of configurations of the first station that are tried.
const MAX_START_COUNT: usize = 16;

impl LayerGenerator<'_> {
    /// Returns pairs of equal configurations of the first and the last station, up to whole revolutions of unlimited
    /// joints.
    ///
    /// Adds configurations of the first station to the last one if it lacks them.
    pub(super) fn close(&self, layers: &mut [Layer]) -> Vec<(usize, usize)> {
        let n = self.middle.len();
        let Some((first, last)) = layers.split_first_mut() else {
            return Vec::new();
        };
        let Some(last) = last.last_mut() else {
            return vec![(0, 0)];
        };
        let mut pairs = Vec::new();
        for (index, q) in first.q.chunks_exact(n).take(MAX_START_COUNT).enumerate() {
            let before = pairs.len();
            for (end, other) in last.q.chunks_exact(n).enumerate() {
                let same = other.iter().zip(q).enumerate().all(|(joint, (a, b))| {
                    let difference =
                        f64::from(a - b) - self.whole_revolutions(joint, f64::from(a - b));
                    difference.abs() as f32 <= self.merge_distances[joint]
                });
                if same {
                    pairs.push((index, end));
                }
            }
            if pairs.len() == before {
                pairs.push((index, last.count(n)));
                last.q.extend_from_slice(q);
            }
        }
        pairs
    }

    /// Returns the solved first configuration, and the last one, which differs by the whole revolutions of the path.
    pub(super) fn closing_ends(
        &self,
        layers: &[Layer],
        first: usize,
        last: usize,
    ) -> Result<(Vec<f64>, Vec<f64>), PathError> {
        let n = self.middle.len();
        let configuration = |layer: Option<&Layer>, index: usize| -> Vec<f64> {
            let row = layer.and_then(|layer| layer.q.get(index * n..(index + 1) * n));
            row.map_or(self.middle.clone(), |row| {
                row.iter().map(|q| f64::from(*q)).collect()
            })
        };
        let (begin, end) = (
            configuration(layers.first(), first),
            configuration(layers.last(), last),
        );
        let start = match self.start {
            Some(start) => start.to_vec(),
            None => {
                let mut ends = Ends::default();
                let arm = self.arms.arm(self.knots.tool(0));
                arm.continue_all(&self.knots.targets[..1], &begin, &mut ends)?;
                ends.q
            }
        };
        let moves = begin.iter().zip(&end).enumerate();
        let revolutions = moves.map(|(joint, (a, b))| self.whole_revolutions(joint, b - a));
        let end = start
            .iter()
            .zip(revolutions)
            .map(|(q, shift)| q + shift)
            .collect();
        Ok((start, end))
    }

    /// Returns the whole revolutions in an angle of a joint without limits, radians; 0 for other joints.
    pub(super) fn whole_revolutions(&self, joint: usize, angle: f64) -> f64 {
        let mut limits = self.arms.primary().limits();
        let free = limits.nth(joint).is_some_and(|limits| {
            limits.lower == f64::NEG_INFINITY && limits.upper == f64::INFINITY
        });
        match free && !self.is_prismatic[joint] {
            true => TAU * (angle / TAU).round(),
            false => 0.0,
        }
    }
}
