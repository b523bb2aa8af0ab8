//! Squad: smooth curves through rotations at even times.
//!
//! Shoemake 1987, "Quaternion calculus and fast animation". The angular velocity is continuous at evenly spaced keys;
//! for uneven times use [`RotationHermite`](super::RotationHermite).

use glam::{Quat, Vec3};

use super::exponential::{exp, log};
use super::slerp::{arc, nearer};

/// Control quaternion of a key from its neighbours: s = q exp(−(log(q⁻¹ q₊) + log(q⁻¹ q₋)) / 4).
#[must_use]
pub fn squad_control(before: Quat, key: Quat, after: Quat) -> Quat {
    let inverse = key.conjugate();
    let towards = |other: Quat| log(inverse * nearer(other, key));
    let mean: Vec3 = (towards(after) + towards(before)) * -0.25;
    (key * exp(mean)).normalize()
}

/// Squad from `start` to `end` at t in [0, 1]: slerp(slerp(start, end, t), slerp(controls, t), 2t(1−t)), with the
/// controls of the two keys. `end` is flipped to the hemisphere of `start`, and each control to that of its key. The
/// slerps do not flip signs again, as this could make the curve discontinuous.
#[must_use]
pub fn squad(start: Quat, controls: [Quat; 2], end: Quat, t: f32) -> Quat {
    let end = nearer(end, start);
    let [first, second] = [nearer(controls[0], start), nearer(controls[1], end)];
    let chord = arc(start, end, t);
    let bow = arc(first, second, t);
    arc(chord, bow, 2.0 * t * (1.0 - t))
}
