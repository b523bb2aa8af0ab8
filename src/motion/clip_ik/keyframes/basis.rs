//! Linear dependence of a clip's angles on its keys, for any spline between them.

use nalgebra::DVector;

use crate::animation::{EulerClip, EulerTrack};
use crate::curve::KeyedCurve;
use crate::model::Limits;
use crate::motion::clip_ik::ClipIkError;
use crate::skeleton::{ANGLES_PER_BONE, BoneId};

/// Angle of a key that may change.
#[derive(Clone, Debug)]
pub(super) struct KeyAngle {
    pub(super) track: usize,
    pub(super) key: usize,
    pub(super) angle: usize,
    /// Index of the angle in a configuration.
    pub(super) coordinate: usize,
    /// Derivative of the angle with respect to the key's angle, over time in seconds.
    gain: KeyedCurve<f64>,
    /// Interval in which `gain` is not zero, seconds: two segments on either side of the key.
    support: [f64; 2],
}

impl KeyAngle {
    pub(super) fn new(
        clip: &EulerClip,
        track: usize,
        key: usize,
        angle: usize,
    ) -> Result<Self, ClipIkError> {
        let euler_track = &clip.tracks()[track];
        let mut unit = vec![0.0; euler_track.keys.len()];
        unit[key] = 1.0;
        let times: Vec<f64> = euler_track.keys.iter().map(|key| key.time).collect();
        // Before its first key and after its last key a track is constant.
        let ends = [key.checked_sub(2), Some(key + 2)];
        let [from, to] = ends.map(|key| key.and_then(|key| times.get(key).copied()));
        Ok(Self {
            track,
            key,
            angle,
            coordinate: ANGLES_PER_BONE * euler_track.bone.index() + angle,
            gain: clip.interpolation(euler_track.bone).curve(times, unit)?,
            support: [
                from.unwrap_or(f64::NEG_INFINITY),
                to.unwrap_or(f64::INFINITY),
            ],
        })
    }

    /// Returns the derivative of the angle at a time with respect to the key's angle.
    pub(super) fn gain(&self, time: f64) -> f64 {
        let [from, to] = self.support;
        if time <= from || time >= to {
            return 0.0;
        }
        self.gain.at(time)
    }
}

/// Number of pieces into which a segment is cut before its control points bound it.
const PIECES: usize = 8;

/// Row of the limits: base + Σ gainᵥ Δᵥ ≤ allowed.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) base: f64,
    /// Variables with a gain other than zero, and their gains.
    pub(super) gains: Vec<(usize, f64)>,
    /// Allowed excess over the limit, radians. Infinite for a row that is only reported.
    pub(super) allowed: f64,
    pub(super) bone: BoneId,
    pub(super) angle: usize,
    /// Time of the row, seconds.
    pub(super) time: f64,
}

impl Row {
    /// Returns the excess over the limit, radians.
    pub(super) fn limit_excess(&self, x: &DVector<f64>) -> f64 {
        self.base + self.change(x)
    }

    /// Returns the excess over the allowed value, radians: 0 or less if the row is satisfied.
    pub(super) fn excess(&self, x: &DVector<f64>) -> f64 {
        self.base - self.allowed + self.change(x)
    }

    fn change(&self, x: &DVector<f64>) -> f64 {
        self.gains.iter().map(|(v, gain)| gain * x[*v]).sum::<f64>()
    }
}

/// Returns the rows of an angle's limits over the segments of its track that can change.
///
/// The rows bound Bézier control points, whose convex hull contains the cubic. Each segment is cut into [`PIECES`]
/// pieces. The distance of a piece's control points from the cubic is then at most a hundredth of the segment's bend.
///
/// Two kinds of rows allow an excess:
///
/// - Next to an unchanged key beyond a limit no change can satisfy the limit. Such a row is only reported.
/// - Between two unchanged keys within the limit the spline itself may exceed it. Such a row allows the present excess.
pub(super) fn limit_rows(
    clip: &EulerClip,
    track: &EulerTrack,
    angle: usize,
    limits: Limits,
    track_keys: &[(usize, &KeyAngle)],
) -> Result<Vec<Row>, ClipIkError> {
    let times: Vec<f64> = track.keys.iter().map(|key| key.time).collect();
    let values = track.keys.iter().map(|key| key.angles[angle]).collect();
    let base = clip
        .interpolation(track.bone)
        .curve(times.clone(), values)?;
    let row = |base: f64, gains: Vec<(usize, f64)>, allowed: f64, time: f64| Row {
        base,
        gains,
        allowed,
        bone: track.bone,
        angle,
        time,
    };
    let sides = [(1.0, limits.upper), (-1.0, -limits.lower)];
    let changing_key = |key: usize| {
        track_keys
            .iter()
            .find(|(_, key_angle)| key_angle.key == key)
    };
    let key_excess =
        |key: usize, (sign, limit): (f64, f64)| sign * track.keys[key].angles[angle] - limit;
    let mut rows = Vec::new();
    // A single key is a constant angle.
    if let ([time], Some((variable, _))) = (&times[..], changing_key(0)) {
        let single_rows =
            sides.map(|side| row(key_excess(0, side), vec![(*variable, side.0)], 0.0, *time));
        rows.extend(single_rows.into_iter().filter(|row| row.base.is_finite()));
    }
    for (first, segment) in times.windows(2).enumerate() {
        let [from, to] = [segment[0], segment[1]];
        let ends = [first, first + 1];
        let middle = 0.5 * (from + to);
        let moving: Vec<&(usize, &KeyAngle)> = track_keys
            .iter()
            .filter(|(_, key_angle)| key_angle.support[0] < middle && middle < key_angle.support[1])
            .collect();
        if moving.is_empty() {
            continue;
        }
        for piece in 0..PIECES {
            let time_at = |fraction: f64| {
                let fraction = (piece as f64 + fraction) / PIECES as f64;
                if fraction >= 1.0 {
                    to
                } else {
                    from + (to - from) * fraction
                }
            };
            let sample_times = [
                time_at(0.0),
                time_at(1.0 / 3.0),
                time_at(2.0 / 3.0),
                time_at(1.0),
            ];
            let base_controls = controls(sample_times.map(|time| base.at(time)));
            let gains = moving.iter().map(|(variable, key_angle)| {
                (
                    *variable,
                    controls(sample_times.map(|time| key_angle.gain.at(time))),
                )
            });
            let gains: Vec<(usize, [f64; 4])> = gains.collect();
            // The last control point of a piece is the first of the next piece.
            let last = if piece + 1 == PIECES { 4 } else { 3 };
            for point in 0..last {
                let at_key = match (piece, point) {
                    (0, 0) => changing_key(first).is_some(),
                    (_, 3) => changing_key(first + 1).is_some(),
                    _ => false,
                };
                for side in sides {
                    let (sign, limit) = side;
                    let base = sign * base_controls[point] - limit;
                    if !base.is_finite() {
                        continue;
                    }
                    let is_unchanged = |key: &usize| changing_key(*key).is_none();
                    let allowed = if at_key {
                        0.0
                    } else if ends
                        .iter()
                        .any(|key| is_unchanged(key) && key_excess(*key, side) > 0.0)
                    {
                        f64::INFINITY
                    } else if ends.iter().all(is_unchanged) {
                        base.max(0.0)
                    } else {
                        0.0
                    };
                    let gains = gains.iter().map(|(v, values)| (*v, sign * values[point]));
                    rows.push(row(base, gains.collect(), allowed, sample_times[point]));
                }
            }
        }
    }
    Ok(rows)
}

/// Returns the Bézier control points of a cubic from its values at 0, 1/3, 2/3 and 1.
fn controls([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    let near = |a: f64, b: f64, c: f64, d: f64| (-5.0 * a + 18.0 * b - 9.0 * c + 2.0 * d) / 6.0;
    [a, near(a, b, c, d), near(d, c, b, a), d]
}
