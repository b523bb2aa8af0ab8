//! Joints with a range of more than one revolution.
//!
//! Branches are compared without whole revolutions, which are selected afterwards. Otherwise six joints with two
//! revolutions each would turn eight branches into more than a hundred configurations.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use super::graph::Selection;
use super::layers::{Layer, LayerGenerator};

/// Tolerance of limits, radians; stations are stored in single precision.
const ROUNDING: f64 = 1e-5;

/// Whole revolutions by which a stretch of rows may be shifted, for each joint.
type Allowed = Vec<RangeInclusive<i32>>;

impl LayerGenerator<'_> {
    /// Adds the whole revolutions to the selected configurations, and the additional reconfigurations.
    ///
    /// A branch is extended as far as one common shift by revolutions keeps it within the limits. At the end of such a
    /// stretch the joints rotate back. Greedy extension is optimal, as in stabbing intervals with the fewest points.
    pub(super) fn with_revolutions(
        &self,
        layers: &[Layer],
        selection: &Selection,
    ) -> (Vec<Layer>, Selection) {
        let n = self.width();
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(layers.len());
        let mut joined = selection.joined.clone();
        let mut allowed: Allowed = Vec::new();
        let mut stretch_start = 0;
        for (station, layer) in layers.iter().enumerate() {
            let index = selection.indices[station] as usize;
            let row = &layer.q[index * n..(index + 1) * n];
            let mut row: Vec<f64> = row.iter().map(|q| f64::from(*q)).collect();
            if let Some(before) = rows.last() {
                for (joint, (value, before)) in row.iter_mut().zip(before).enumerate() {
                    if self.revolutions.is_ignored(joint) {
                        *value += TAU * ((before - *value) / TAU).round();
                    }
                }
            }
            let row_allowed = self.allowed_shifts(&row, station, layers.len());
            let both = intersection(&allowed, &row_allowed);
            let continues =
                station > 0 && joined[station] && !both.iter().any(RangeInclusive::is_empty);
            if continues {
                allowed = both;
            } else {
                self.shift_stretch(&mut rows, stretch_start, &allowed);
                (joined[station], allowed, stretch_start) = (station == 0, row_allowed, station);
            }
            rows.push(row);
        }
        self.shift_stretch(&mut rows, stretch_start, &allowed);
        let layers = rows.iter().enumerate().map(|(station, row)| {
            let (index, source) = (selection.indices[station] as usize, &layers[station]);
            let mut layer = Layer {
                unreached: source.unreached,
                ..Layer::default()
            };
            layer.push(row);
            let before = station
                .checked_sub(1)
                .map(|before| selection.indices[before]);
            if before.is_some_and(|before| source.linked_to(index) == Some(before as usize)) {
                layer.link(0, 0);
            }
            layer
        });
        let selection = Selection {
            indices: vec![0; rows.len()],
            joined,
            cost: selection.cost,
        };
        (layers.collect(), selection)
    }

    /// Returns the revolutions by which a station's configuration may be shifted: within the limits, and onto a given
    /// end.
    fn allowed_shifts(&self, row: &[f64], station: usize, stations: usize) -> Allowed {
        let end = match station {
            0 => self.start,
            _ if station + 1 == stations => self.end,
            _ => None,
        };
        let joints = row.iter().zip(self.arms.primary().limits()).enumerate();
        let shifts = joints.map(|(joint, (value, limits))| {
            match (self.revolutions.is_ignored(joint), end) {
                (false, _) => 0..=0,
                (true, Some(end)) => {
                    let shift = ((end[joint] - value) / TAU).round() as i32;
                    shift..=shift
                }
                (true, None) => {
                    let low = (limits.lower - ROUNDING - value) / TAU;
                    let high = (limits.upper + ROUNDING - value) / TAU;
                    low.ceil() as i32..=high.floor() as i32
                }
            }
        });
        shifts.collect()
    }

    /// Shifts the rows of a stretch by the allowed revolutions nearest to the end of the previous stretch.
    fn shift_stretch(&self, rows: &mut [Vec<f64>], stretch_start: usize, allowed: &Allowed) {
        let before = stretch_start
            .checked_sub(1)
            .map(|before| rows[before].clone());
        for (joint, allowed_shifts) in allowed.iter().enumerate() {
            let nearest = match (&before, rows.get(stretch_start)) {
                (Some(before), Some(row)) => ((before[joint] - row[joint]) / TAU).round() as i32,
                _ => 0,
            };
            let shift = nearest
                .max(*allowed_shifts.start())
                .min(*allowed_shifts.end());
            for row in &mut rows[stretch_start..] {
                row[joint] += TAU * f64::from(shift);
            }
        }
    }
}

fn intersection(a: &Allowed, b: &Allowed) -> Allowed {
    let both = a.iter().zip(b);
    let both = both.map(|(a, b)| *a.start().max(b.start())..=*a.end().min(b.end()));
    both.collect()
}
