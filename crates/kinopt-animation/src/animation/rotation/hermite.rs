//! Rotation segments with given angular velocities at their ends, for keys at uneven times.
//!
//! Kim, Kim & Shin 1995, "A general construction scheme for unit quaternion curves with simple high order derivatives".
//! The segment is the cumulative Bernstein form of a cubic, with products of exponentials in place of sums.

use glam::{Quat, Vec3};

use super::exponential::{exp, log};
use super::slerp::nearer;

/// Rotation segment with given angular velocities at both ends. Segments with equal velocities at their common key join
/// with continuous angular velocity, at any key times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotationHermite {
    start: Quat,
    rotation_vectors: [Vec3; 3],
}

impl RotationHermite {
    /// Segment between two unit quaternions along the shorter arc. Velocities are rotation vectors in the body frame,
    /// radians per segment; multiply a rate per second by the segment's duration in seconds.
    #[must_use]
    pub fn new(start: Quat, leaving: Vec3, end: Quat, arriving: Vec3) -> Self {
        let [first, last] = [leaving / 3.0, arriving / 3.0];
        let end = nearer(end, start);
        let middle = exp(-first) * (start.conjugate() * end) * exp(-last);
        // The rotation vector is not reduced to below π: a segment that overshoots rotates back the same way.
        let middle = log(middle);
        Self {
            start,
            rotation_vectors: [first, middle, last],
        }
    }

    /// Rotation at u in [0, 1].
    #[must_use]
    pub fn at(&self, u: f32) -> Quat {
        let rest = 1.0 - u;
        // Cumulative Bernstein polynomials of degree three.
        let weights = [1.0 - rest * rest * rest, u * u * (3.0 - 2.0 * u), u * u * u];
        let rotation = self
            .rotation_vectors
            .iter()
            .zip(weights)
            .fold(self.start, |q, (vector, weight)| q * exp(*vector * weight));
        rotation.normalize()
    }
}

/// Angular velocity at each key: rotation vectors per second in the body frame. It is the sum of the rotation vectors
/// from the previous and to the next key, divided by the sum of their times; one-sided at the ends.
///
/// Times strictly increase, one for each rotation. With fewer than two keys all rates are zero.
#[must_use]
pub fn mean_rates(times: &[f32], rotations: &[Quat]) -> Vec<Vec3> {
    let segment_rotations: Vec<(Vec3, f32)> = rotations
        .windows(2)
        .zip(times.windows(2))
        .map(|(q, t)| {
            let rotation = q[0].conjugate() * nearer(q[1], q[0]);
            (log(rotation), t[1] - t[0])
        })
        .collect();
    (0..rotations.len())
        .map(|key| {
            let sides = [key.checked_sub(1), Some(key)];
            let sides = sides
                .into_iter()
                .flatten()
                .filter_map(|k| segment_rotations.get(k));
            let sum = sides.fold((Vec3::ZERO, 0.0), |(rotation, time), (t, dt)| {
                (rotation + *t, time + dt)
            });
            if sum.1 > 0.0 {
                sum.0 / sum.1
            } else {
                Vec3::ZERO
            }
        })
        .collect()
}
