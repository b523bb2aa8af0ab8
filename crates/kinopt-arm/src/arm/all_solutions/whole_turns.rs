//! Whole turns of revolute joints within their limits.

use kinopt_kinematics::model::Limits;
use std::f64::consts::TAU;

/// Excess over a limit that counts as rounding and is clamped, radians.
const ROUNDING: f64 = 1e-9;
/// Largest number of configurations of a set.
pub(super) const MAX_CONFIGURATIONS: usize = 1 << 16;

/// The turn of an angle that is nearest to `start` within the limits; `None` if there is none.
pub(super) fn nearest_turn(angle: f64, start: f64, limits: Limits) -> Option<f64> {
    let lowest = ((limits.lower - ROUNDING - angle) / TAU).ceil();
    let highest = ((limits.upper + ROUNDING - angle) / TAU).floor();
    let turns = ((start - angle) / TAU).round().min(highest).max(lowest);
    let value = angle + turns * TAU;
    (lowest <= highest).then(|| limits.clamp(value))
}

/// Enumeration of all whole turns of a configuration.
#[derive(Clone, Debug)]
pub(super) struct Turns {
    q: [f64; 6],
    /// Lowest value of every joint, and the number of its turns.
    lowest: [f64; 6],
    counts: [usize; 6],
    turn: [usize; 6],
    limits: [Limits; 6],
    nearest: [f64; 6],
}

impl Turns {
    /// Begins at the lowest turn of every joint; `None` if a joint has none within its limits.
    ///
    /// A joint without a limit on a side has only the turn nearest to `start`.
    pub(super) fn new(
        limits: impl Iterator<Item = Limits>,
        angles: &[f64; 6],
        start: &[f64],
    ) -> Option<Self> {
        let mut turns = Self {
            q: *angles,
            lowest: *angles,
            counts: [1; 6],
            turn: [0; 6],
            limits: [Limits::new(0.0, 0.0); 6],
            nearest: *angles,
        };
        for (i, limits) in limits.enumerate().take(6) {
            let nearest = nearest_turn(angles[i], *start.get(i)?, limits)?;
            turns.limits[i] = limits;
            turns.nearest[i] = nearest;
            turns.lowest[i] = nearest;
            if limits.lower.is_finite() && limits.upper.is_finite() {
                let lowest = ((limits.lower - ROUNDING - angles[i]) / TAU).ceil();
                let highest = ((limits.upper + ROUNDING - angles[i]) / TAU).floor();
                turns.lowest[i] = angles[i] + lowest * TAU;
                turns.counts[i] = (highest - lowest) as usize + 1;
            }
            turns.q[i] = limits.clamp(turns.lowest[i]);
        }
        Some(turns)
    }

    /// Current configuration.
    pub(super) fn q(&self) -> &[f64; 6] {
        &self.q
    }

    /// Number of configurations; at the largest number of an integer if there are more.
    pub(super) fn count(&self) -> usize {
        self.counts
            .iter()
            .fold(1, |product: usize, &count| product.saturating_mul(count))
    }

    /// Reduces the enumeration to the configuration nearest to the start.
    pub(super) fn keep_nearest(&mut self) {
        (self.q, self.lowest, self.counts) = (self.nearest, self.nearest, [1; 6]);
    }

    /// Goes to the next configuration. Returns false after the last.
    pub(super) fn advance(&mut self) -> bool {
        for i in 0..6 {
            self.turn[i] += 1;
            if self.turn[i] < self.counts[i] {
                let value = self.lowest[i] + self.turn[i] as f64 * TAU;
                self.q[i] = self.limits[i].clamp(value);
                return true;
            }
            self.turn[i] = 0;
            self.q[i] = self.limits[i].clamp(self.lowest[i]);
        }
        false
    }
}
