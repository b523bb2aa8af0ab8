//! Squad: a smooth curve through rotations at even times.
//!
//! Shoemake 1987, "Quaternion calculus and fast animation". At keys an even time apart the angular
//! velocity is continuous; for uneven times use [`RotationHermite`](super::RotationHermite).

use glam::{Quat, Vec3};

use super::exponential::{exp, log};
use super::slerp::{arc, nearer};

/// The control quaternion of a key from its neighbours:
/// s = q exp(−(log(q⁻¹ q₊) + log(q⁻¹ q₋)) / 4).
#[must_use]
pub fn squad_control(before: Quat, key: Quat, after: Quat) -> Quat {
    let inverse = key.conjugate();
    let towards = |other: Quat| log(inverse * nearer(other, key));
    let mean: Vec3 = (towards(after) + towards(before)) * -0.25;
    (key * exp(mean)).normalize()
}

/// From `start` to `end` at t in [0, 1]:
/// slerp(slerp(start, end, t), slerp(controls, t), 2t(1−t)), with the two keys' own controls. The
/// keys are taken the shorter way round and controls on their keys' sides; what follows stays on the
/// arcs between those quaternions, as a side chosen again on the way could jump.
#[must_use]
pub fn squad(start: Quat, controls: [Quat; 2], end: Quat, t: f32) -> Quat {
    let end = nearer(end, start);
    let [first, second] = [nearer(controls[0], start), nearer(controls[1], end)];
    let chord = arc(start, end, t);
    let bow = arc(first, second, t);
    arc(chord, bow, 2.0 * t * (1.0 - t))
}
