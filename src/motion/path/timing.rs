//! Times for a solved path: a plain trapezoid of speed.
//!
//! Each piece between reconfigurations is gone from rest to rest along its joint length s, with one highest speed V and one
//! acceleration A. A joint's speed is q′ ṡ and its acceleration q″ ṡ² + q′ s̈, so that V ≤ v / |q′|, V² ≤ a / (2 |q″|) and A ≤ a / (2 |q′|)
//! keep every joint within its limits. It is not the fastest way: for that the rows go to a time-optimal parametrisation.

use super::PathError;
use super::solution::PathSolution;
use crate::bad_option::{BadOption, POSITIVE};

/// A limit that may be none.
const LIMIT: (fn(f64) -> bool, &str) = (|v| v > 0.0, "a number above 0 (infinity for none)");

impl PathSolution {
    /// When each row is, seconds, the first at 0: so that no joint is faster than its velocity limit (infinite for none), nor its speed
    /// changes faster than its acceleration limit, radians or metres a second and a second squared, as
    /// [`Arm::velocity_limits`](crate::arm::Arm::velocity_limits) and
    /// [`Arm::acceleration_limits`](crate::arm::Arm::acceleration_limits) have them. Before and after a
    /// [reconfiguration](Self::reconfigurations), which is timed by the same limits, the arm rests. Rows that are the same are at one time.
    ///
    /// # Errors
    /// Another number of limits than joints, or one that is not above 0 (or an acceleration that is infinite).
    pub fn times(
        &self,
        velocity_limits: &[f64],
        acceleration_limits: &[f64],
    ) -> Result<Vec<f64>, PathError> {
        let rows: Vec<&[f64]> = self.rows().collect();
        let steps = self.reconfigurations.iter().map(|told| told.index);
        let rests: Vec<usize> = steps.collect();
        trapezoid_times(&rows, &rests, velocity_limits, acceleration_limits)
    }
}

/// The same for rows of joints in general: `rests` are the rows, in order, before whose step and after it the arm rests.
///
/// # Errors
/// As for [`PathSolution::times`].
pub fn trapezoid_times(
    rows: &[&[f64]],
    rests: &[usize],
    velocity_limits: &[f64],
    acceleration_limits: &[f64],
) -> Result<Vec<f64>, PathError> {
    let joints = rows.first().map_or(velocity_limits.len(), |row| row.len());
    for (option, limits) in [
        ("velocity_limits", velocity_limits),
        ("acceleration_limits", acceleration_limits),
    ] {
        if limits.len() != joints {
            return Err(PathError::Limits {
                option,
                given: limits.len(),
                joints,
            });
        }
    }
    for &limit in velocity_limits {
        BadOption::check("velocity_limits", limit, LIMIT)?;
    }
    for &limit in acceleration_limits {
        BadOption::check("acceleration_limits", limit, POSITIVE)?;
    }
    let mut times = Vec::with_capacity(rows.len());
    times.extend(rows.first().map(|_| 0.0));
    let mut first = 0;
    while first + 1 < rows.len() {
        // A reconfiguration is a piece of its own.
        let last = match rests.iter().find(|rest| **rest > first) {
            Some(&rest) if rest >= rows.len() => rows.len() - 1,
            Some(&rest) if rest == first + 1 => rest,
            Some(&rest) => rest - 1,
            None => rows.len() - 1,
        };
        let begin = times[first];
        let piece = Piece::new(&rows[first..=last], velocity_limits, acceleration_limits);
        let lengths = piece.lengths[1..].iter();
        times.extend(lengths.map(|length| begin + piece.time_at(*length)));
        first = last;
    }
    Ok(times)
}

/// Rows that are gone from rest to rest.
struct Piece {
    /// Joint length as far as each row.
    lengths: Vec<f64>,
    speed: f64,
    acceleration: f64,
}

impl Piece {
    fn new(rows: &[&[f64]], velocities: &[f64], accelerations: &[f64]) -> Self {
        let mut lengths = vec![0.0];
        let (mut speed, mut acceleration) = (f64::INFINITY, f64::INFINITY);
        // The slopes of the last step that moved, and its length.
        let mut last: Option<(Vec<f64>, f64)> = None;
        let mut whole = 0.0;
        for pair in rows.windows(2) {
            let moves: Vec<f64> = pair[1].iter().zip(pair[0]).map(|(b, a)| b - a).collect();
            let length = moves.iter().map(|by| by * by).sum::<f64>().sqrt();
            whole += length;
            lengths.push(whole);
            if length <= 0.0 {
                continue;
            }
            let slopes: Vec<f64> = moves.iter().map(|by| by / length).collect();
            for (joint, slope) in slopes.iter().enumerate() {
                speed = speed.min(velocities[joint] / slope.abs());
                acceleration = acceleration.min(0.5 * accelerations[joint] / slope.abs());
                if let Some((before, other)) = &last {
                    let bend = (slope - before[joint]).abs() / (0.5 * (length + other));
                    speed = speed.min((0.5 * accelerations[joint] / bend).sqrt());
                }
            }
            last = Some((slopes, length));
        }
        Self {
            lengths,
            speed,
            acceleration,
        }
    }

    /// When the piece has come so far, seconds.
    fn time_at(&self, length: f64) -> f64 {
        let whole = self.lengths.last().copied().unwrap_or(0.0);
        if whole <= 0.0 {
            return 0.0;
        }
        // The speed that is come to, and the length that it takes to come there.
        let top = self.speed.min((self.acceleration * whole).sqrt());
        let ramp = 0.5 * top * top / self.acceleration;
        let cruise = (whole - 2.0 * ramp).max(0.0);
        let ramp_time = top / self.acceleration;
        if length <= ramp {
            (2.0 * length / self.acceleration).sqrt()
        } else if length <= ramp + cruise {
            ramp_time + (length - ramp) / top
        } else {
            let left = (whole - length).max(0.0);
            2.0 * ramp_time + cruise / top - (2.0 * left / self.acceleration).sqrt()
        }
    }
}
