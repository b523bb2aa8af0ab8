//! Joints that turn more than once round: branches are compared without their whole turns, which are chosen afterwards. Six joints of two
//! turns each make of eight branches more than a hundred configurations, of which each would have to be known.

use std::f64::consts::TAU;
use std::ops::RangeInclusive;

use super::graph::Chosen;
use super::layers::{Growth, Layer};
use crate::arm::Arm;

/// A joint whose range has so much more than a turn, radians, is never near a limit within half a turn of its middle.
const MORE_THAN_A_TURN: f64 = 1.0;
/// Stations stand in single precision, radians.
const ROUNDING: f64 = 1e-5;

/// Which joints are taken without their whole turns.
#[derive(Clone, Debug, Default)]
pub(super) struct Turns {
    /// The middle of each joint's range, where it is taken so.
    middles: Vec<Option<f32>>,
}

impl Turns {
    /// No joint is.
    pub(super) fn kept(joints: usize) -> Self {
        Self {
            middles: vec![None; joints],
        }
    }

    /// All joints with limits are that turn by more than a turn.
    pub(super) fn left_out(arm: &Arm) -> Self {
        let joints = arm.limits().zip(arm.slides());
        let middles = joints.map(|(limits, slides)| {
            let range = limits.upper - limits.lower;
            let turns = !slides && range.is_finite() && range >= TAU + MORE_THAN_A_TURN;
            turns.then_some(0.5 * (limits.lower + limits.upper) as f32)
        });
        Self {
            middles: middles.collect(),
        }
    }

    pub(super) fn are_left_out(&self) -> bool {
        self.middles.iter().any(Option::is_some)
    }

    pub(super) fn is_left_out(&self, joint: usize) -> bool {
        self.middles[joint].is_some()
    }

    /// How far a joint is from one value to another, without whole turns where these are left out.
    pub(super) fn difference(&self, joint: usize, from: f32, to: f32) -> f32 {
        match self.middles[joint] {
            None => to - from,
            Some(_) => without_turns(to - from),
        }
    }

    /// Values within half a turn of the joint's middle, where turns are left out.
    pub(super) fn fold(&self, q: &mut [f32]) {
        for (value, middle) in q.iter_mut().zip(&self.middles) {
            if let Some(middle) = middle {
                *value = middle + without_turns(*value - middle);
            }
        }
    }
}

fn without_turns(angle: f32) -> f32 {
    let turn = TAU as f32;
    angle - turn * (angle / turn).round()
}

/// Whole turns by which a stretch may be turned, joint by joint.
type Allowed = Vec<RangeInclusive<i32>>;

impl Growth<'_> {
    /// What was chosen with its whole turns: one configuration a station, and where a branch is left. As far as a branch goes on within the
    /// limits, turned by as many turns as it takes, it is not left; where that ends, the joints turn back (as of intervals that one point
    /// hits, going as far as each hits is best).
    pub(super) fn with_turns(&self, layers: &[Layer], chosen: &Chosen) -> (Vec<Layer>, Chosen) {
        let n = self.width();
        let mut rows: Vec<Vec<f64>> = Vec::with_capacity(layers.len());
        let mut joined = chosen.joined.clone();
        let mut allowed: Allowed = Vec::new();
        let mut begun = 0;
        for (station, layer) in layers.iter().enumerate() {
            let place = chosen.places[station] as usize;
            let row = &layer.q[place * n..(place + 1) * n];
            let mut row: Vec<f64> = row.iter().map(|q| f64::from(*q)).collect();
            if let Some(before) = rows.last() {
                for (joint, (value, before)) in row.iter_mut().zip(before).enumerate() {
                    if self.turns.is_left_out(joint) {
                        *value += TAU * ((before - *value) / TAU).round();
                    }
                }
            }
            let own = self.allowed_turns(&row, station, layers.len());
            let both = common(&allowed, &own);
            let goes_on =
                station > 0 && joined[station] && !both.iter().any(RangeInclusive::is_empty);
            if goes_on {
                allowed = both;
            } else {
                self.turn(&mut rows, begun, &allowed);
                (joined[station], allowed, begun) = (station == 0, own, station);
            }
            rows.push(row);
        }
        self.turn(&mut rows, begun, &allowed);
        let layers = rows.iter().enumerate().map(|(station, row)| {
            let (place, own) = (chosen.places[station] as usize, &layers[station]);
            let mut layer = Layer {
                missed: own.missed,
                ..Layer::default()
            };
            layer.take(row);
            let before = station.checked_sub(1).map(|before| chosen.places[before]);
            if before.is_some_and(|before| own.linked_to(place) == Some(before as usize)) {
                layer.link(0, 0);
            }
            layer
        });
        let chosen = Chosen {
            places: vec![0; rows.len()],
            joined,
            cost: chosen.cost,
        };
        (layers.collect(), chosen)
    }

    /// By how many turns a station's configuration may be turned: within the limits, and onto an end that is given.
    fn allowed_turns(&self, row: &[f64], station: usize, stations: usize) -> Allowed {
        let end = match station {
            0 => self.start,
            _ if station + 1 == stations => self.end,
            _ => None,
        };
        let joints = row.iter().zip(self.arms.own().limits()).enumerate();
        let turns =
            joints.map(
                |(joint, (value, limits))| match (self.turns.is_left_out(joint), end) {
                    (false, _) => 0..=0,
                    (true, Some(end)) => {
                        let turn = ((end[joint] - value) / TAU).round() as i32;
                        turn..=turn
                    }
                    (true, None) => {
                        let low = (limits.lower - ROUNDING - value) / TAU;
                        let high = (limits.upper + ROUNDING - value) / TAU;
                        low.ceil() as i32..=high.floor() as i32
                    }
                },
            );
        turns.collect()
    }

    /// Turns the rows of a stretch to the turns that are nearest to where the one before it ends.
    fn turn(&self, rows: &mut [Vec<f64>], begun: usize, allowed: &Allowed) {
        let before = begun.checked_sub(1).map(|before| rows[before].clone());
        for (joint, turns) in allowed.iter().enumerate() {
            let wanted = match (&before, rows.get(begun)) {
                (Some(before), Some(row)) => ((before[joint] - row[joint]) / TAU).round() as i32,
                _ => 0,
            };
            let turns = wanted.max(*turns.start()).min(*turns.end());
            for row in &mut rows[begun..] {
                row[joint] += TAU * f64::from(turns);
            }
        }
    }
}

fn common(a: &Allowed, b: &Allowed) -> Allowed {
    let both = a.iter().zip(b);
    let both = both.map(|(a, b)| *a.start().max(b.start())..=*a.end().min(b.end()));
    both.collect()
}
