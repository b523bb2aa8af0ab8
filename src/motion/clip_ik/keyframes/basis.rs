//! How a clip's angles depend on its keys: linearly, whatever spline runs between them.

use nalgebra::DVector;

use crate::animation::curve::KeyedCurve;
use crate::animation::{EulerClip, EulerTrack};
use crate::model::Limits;
use crate::motion::clip_ik::ClipIkError;
use crate::skeleton::{ANGLES_PER_BONE, BoneId};

/// An angle of a key that may change.
#[derive(Clone, Debug)]
pub(super) struct KeyAngle {
    pub(super) track: usize,
    pub(super) key: usize,
    pub(super) angle: usize,
    /// Which number of a configuration it is a key of.
    pub(super) coordinate: usize,
    /// What the angle gains at a time where the key gains a radian.
    gain: KeyedCurve<f64>,
    /// Where that is not 0, in seconds: two segments on either side.
    support: [f64; 2],
}

impl KeyAngle {
    pub(super) fn new(
        clip: &EulerClip,
        track: usize,
        key: usize,
        angle: usize,
    ) -> Result<Self, ClipIkError> {
        let own = &clip.tracks()[track];
        let mut unit = vec![0.0; own.keys.len()];
        unit[key] = 1.0;
        let times: Vec<f64> = own.keys.iter().map(|key| key.time).collect();
        // The ends hold on.
        let ends = [key.checked_sub(2), Some(key + 2)];
        let [from, to] = ends.map(|key| key.and_then(|key| times.get(key).copied()));
        Ok(Self {
            track,
            key,
            angle,
            coordinate: ANGLES_PER_BONE * own.bone.index() + angle,
            gain: clip.interpolation(own.bone).curve(times, unit)?,
            support: [
                from.unwrap_or(f64::NEG_INFINITY),
                to.unwrap_or(f64::INFINITY),
            ],
        })
    }

    /// What the angle gains at a time, per radian of the key.
    pub(super) fn gain(&self, time: f64) -> f64 {
        let [from, to] = self.support;
        if time <= from || time >= to {
            return 0.0;
        }
        self.gain.at(time)
    }
}

/// Pieces of a segment whose control points bound it.
const PIECES: usize = 8;

/// A row of the limits: base + Σ gainᵥ Δᵥ ≤ allowed.
#[derive(Clone, Debug)]
pub(super) struct Row {
    pub(super) base: f64,
    /// By variable, those that are not 0.
    pub(super) gains: Vec<(usize, f64)>,
    /// How far beyond the limit it may be; infinite where it is only told of.
    pub(super) allowed: f64,
    pub(super) bone: BoneId,
    pub(super) angle: usize,
    /// Near which moment, in seconds.
    pub(super) time: f64,
}

impl Row {
    /// How far beyond the limit.
    pub(super) fn beyond(&self, x: &DVector<f64>) -> f64 {
        self.base + self.change(x)
    }

    /// How far beyond what is allowed: 0 or less where the row is kept.
    pub(super) fn excess(&self, x: &DVector<f64>) -> f64 {
        self.base - self.allowed + self.change(x)
    }

    fn change(&self, x: &DVector<f64>) -> f64 {
        self.gains.iter().map(|(v, gain)| gain * x[*v]).sum::<f64>()
    }
}

/// The limits of an angle over a stretch of its track, told of control points: a cubic lies within the hull of its Bézier
/// points, and after it is cut in eight these are within a hundredth of how far it bends.
///
/// Next to a key that stays beyond a limit nothing can keep that limit: such rows are only told of. Between two keys that stay
/// within, where their spline itself is beyond, it may stay as far beyond.
pub(super) fn limit_rows(
    clip: &EulerClip,
    track: &EulerTrack,
    angle: usize,
    limits: Limits,
    own: &[(usize, &KeyAngle)],
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
    let solved = |key: usize| own.iter().find(|(_, own)| own.key == key);
    let over = |key: usize, (sign, limit): (f64, f64)| sign * track.keys[key].angles[angle] - limit;
    let mut rows = Vec::new();
    // One key is the same at all times.
    if let ([time], Some((variable, _))) = (&times[..], solved(0)) {
        let own = sides.map(|side| row(over(0, side), vec![(*variable, side.0)], 0.0, *time));
        rows.extend(own.into_iter().filter(|row| row.base.is_finite()));
    }
    for (first, segment) in times.windows(2).enumerate() {
        let [from, to] = [segment[0], segment[1]];
        let ends = [first, first + 1];
        let middle = 0.5 * (from + to);
        let moving: Vec<&(usize, &KeyAngle)> = own
            .iter()
            .filter(|(_, own)| own.support[0] < middle && middle < own.support[1])
            .collect();
        if moving.is_empty() {
            continue;
        }
        for piece in 0..PIECES {
            let at = |share: f64| {
                let share = (piece as f64 + share) / PIECES as f64;
                if share >= 1.0 {
                    to
                } else {
                    from + (to - from) * share
                }
            };
            let moments = [at(0.0), at(1.0 / 3.0), at(2.0 / 3.0), at(1.0)];
            let still = controls(moments.map(|time| base.at(time)));
            let gains = moving.iter().map(|(variable, own)| {
                (*variable, controls(moments.map(|time| own.gain.at(time))))
            });
            let gains: Vec<(usize, [f64; 4])> = gains.collect();
            // The last is the next piece's first.
            let last = if piece + 1 == PIECES { 4 } else { 3 };
            for point in 0..last {
                let at_key = match (piece, point) {
                    (0, 0) => solved(first).is_some(),
                    (_, 3) => solved(first + 1).is_some(),
                    _ => false,
                };
                for side in sides {
                    let (sign, limit) = side;
                    let base = sign * still[point] - limit;
                    if !base.is_finite() {
                        continue;
                    }
                    let stays = |key: &usize| solved(*key).is_none();
                    let allowed = if at_key {
                        0.0
                    } else if ends.iter().any(|key| stays(key) && over(*key, side) > 0.0) {
                        f64::INFINITY
                    } else if ends.iter().all(stays) {
                        base.max(0.0)
                    } else {
                        0.0
                    };
                    let gains = gains.iter().map(|(v, own)| (*v, sign * own[point]));
                    rows.push(row(base, gains.collect(), allowed, moments[point]));
                }
            }
        }
    }
    Ok(rows)
}

/// The Bézier points of a cubic by its values at 0, 1/3, 2/3 and 1.
fn controls([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    let near = |a: f64, b: f64, c: f64, d: f64| (-5.0 * a + 18.0 * b - 9.0 * c + 2.0 * d) / 6.0;
    [a, near(a, b, c, d), near(d, c, b, a), d]
}
