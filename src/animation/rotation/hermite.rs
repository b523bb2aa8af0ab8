//! A rotation curve with given angular velocities at its ends, for keys at uneven times.
//!
//! Kim, Kim & Shin 1995, "A general construction scheme for unit quaternion curves with simple high
//! order derivatives": the cumulative Bernstein form of a cubic, with products of
//! exponentials for its sums.

use glam::{Quat, Vec3};

use super::exponential::{exp, log};
use super::slerp::nearer;

/// A segment from one rotation to another that leaves and arrives with given angular velocities.
/// Segments that share their velocities join with a continuous angular velocity at any times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotationHermite {
    start: Quat,
    turns: [Vec3; 3],
}

impl RotationHermite {
    /// The segment between two unit quaternions, the shorter way round. Velocities are rotation
    /// vectors in the rotating frame's own axes, in radians per segment (multiply a rate per second
    /// by the segment's seconds).
    #[must_use]
    pub fn new(start: Quat, leaving: Vec3, end: Quat, arriving: Vec3) -> Self {
        let [first, last] = [leaving / 3.0, arriving / 3.0];
        let end = nearer(end, start);
        let middle = exp(-first) * (start.conjugate() * end) * exp(-last);
        // Not the shorter turn of its rotation: where a segment swings out it comes back the way it went.
        let middle = log(middle);
        Self {
            start,
            turns: [first, middle, last],
        }
    }

    /// The rotation at u in [0, 1].
    #[must_use]
    pub fn at(&self, u: f32) -> Quat {
        let rest = 1.0 - u;
        // Cumulative Bernstein polynomials of degree three.
        let shares = [1.0 - rest * rest * rest, u * u * (3.0 - 2.0 * u), u * u * u];
        let turned = self
            .turns
            .iter()
            .zip(shares)
            .fold(self.start, |q, (turn, share)| q * exp(*turn * share));
        turned.normalize()
    }
}

/// The angular velocity at each key (rotation vectors per second in the rotating frame's own axes):
/// the mean rate from the key before to the key after, one-sided at the ends. As Catmull-Rom
/// tangents, but each half weighs by its time. Times strictly increase and there is one for each
/// rotation; with fewer than two keys all rates are zero.
#[must_use]
pub fn mean_rates(times: &[f32], rotations: &[Quat]) -> Vec<Vec3> {
    let turns: Vec<(Vec3, f32)> = rotations
        .windows(2)
        .zip(times.windows(2))
        .map(|(q, t)| {
            let turn = q[0].conjugate() * nearer(q[1], q[0]);
            (log(turn), t[1] - t[0])
        })
        .collect();
    (0..rotations.len())
        .map(|key| {
            let sides = [key.checked_sub(1), Some(key)];
            let sides = sides.into_iter().flatten().filter_map(|k| turns.get(k));
            let sum = sides.fold((Vec3::ZERO, 0.0), |(turn, time), (t, dt)| {
                (turn + *t, time + dt)
            });
            if sum.1 > 0.0 {
                sum.0 / sum.1
            } else {
                Vec3::ZERO
            }
        })
        .collect()
}
