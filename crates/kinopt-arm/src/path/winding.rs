//! Joints with a range of more than one revolution.
//!
//! Branches are compared without whole revolutions, which are selected afterwards. Otherwise six joints with two
//! revolutions each would turn eight branches into more than a hundred configurations.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use super::graph::Selection;
use super::layers::{Layer, LayerGenerator};
use crate::arm::Arm;

/// Range beyond one revolution, radians, that keeps the half revolutions about the centre away from the limits.
const MIN_EXCESS_RANGE: f64 = 1.0;
/// Tolerance of limits, radians; stations are stored in single precision.
const ROUNDING: f64 = 1e-5;

/// Joints whose whole revolutions are ignored.
#[derive(Clone, Debug, Default)]
pub(super) struct Revolutions {
    /// Centre of each joint's range, if its revolutions are ignored.
    middles: Vec<Option<f32>>,
}

impl Revolutions {
    /// Ignores no revolutions.
    pub(super) fn counted(joints: usize) -> Self {
        Self {
            middles: vec![None; joints],
        }
    }

    /// Ignores the revolutions of all limited joints with a range of sufficiently more than one revolution.
    pub(super) fn ignored(arm: &Arm) -> Self {
        let joints = arm.limits().zip(arm.slides());
        let middles = joints.map(|(limits, slides)| {
            let range = limits.upper - limits.lower;
            let is_ignored = !slides && range.is_finite() && range >= TAU + MIN_EXCESS_RANGE;
            is_ignored.then_some(0.5 * (limits.lower + limits.upper) as f32)
        });
        Self {
            middles: middles.collect(),
        }
    }

    pub(super) fn any_ignored(&self) -> bool {
        self.middles.iter().any(Option::is_some)
    }

    pub(super) fn is_ignored(&self, joint: usize) -> bool {
        self.middles[joint].is_some()
    }

    /// Returns the displacement of a joint, without whole revolutions if these are ignored.
    pub(super) fn difference(&self, joint: usize, from: f32, to: f32) -> f32 {
        match self.middles[joint] {
            None => to - from,
            Some(_) => without_revolutions(to - from),
        }
    }

    /// Moves values to within half a revolution of the centre, if revolutions are ignored.
    pub(super) fn fold(&self, q: &mut [f32]) {
        for (value, middle) in q.iter_mut().zip(&self.middles) {
            if let Some(middle) = middle {
                *value = middle + without_revolutions(*value - middle);
            }
        }
    }
}

fn without_revolutions(angle: f32) -> f32 {
    let revolution = TAU as f32;
    angle - revolution * (angle / revolution).round()
}

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
