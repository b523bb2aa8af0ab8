//! Between two rotations or directions along the shortest arc.
//!
//! Shoemake 1985, "Animating rotation with quaternion curves".

use glam::{Quat, Vec3};

use crate::scalar::elementary::single;

/// Above this cosine the arc is straight to single precision and sin Ω too short to divide by.
const CLOSE: f32 = 0.9995;

/// Of `q` and −q, which are the same rotation, the one on the side of `reference`.
#[inline]
#[must_use]
pub fn nearer(q: Quat, reference: Quat) -> Quat {
    if q.dot(reference) < 0.0 { -q } else { q }
}

/// Normalised linear interpolation, the shorter way round: the arc of [`slerp`], but faster in its
/// middle. `from` and `to` are of unit length. Half a turn apart either way is as short.
#[inline]
#[must_use]
pub fn nlerp(from: Quat, to: Quat, t: f32) -> Quat {
    let to = nearer(to, from);
    (from * (1.0 - t) + to * t).normalize()
}

/// Spherical linear interpolation, the shorter way round, at constant angular speed:
/// sin((1−t)Ω)/sin Ω · from + sin(tΩ)/sin Ω · to, with cos Ω = from · to. Nearly equal rotations
/// are interpolated by [`nlerp`]. `from` and `to` are of unit length.
#[must_use]
pub fn slerp(from: Quat, to: Quat, t: f32) -> Quat {
    arc(from, nearer(to, from), t)
}

/// [`slerp`] between the quaternions as they are, even where that is the longer way round for the
/// rotations.
pub(super) fn arc(from: Quat, to: Quat, t: f32) -> Quat {
    let cosine = from.dot(to);
    if cosine > CLOSE {
        return (from * (1.0 - t) + to * t).normalize();
    }
    // From sine and cosine, because the arc cosine alone loses digits for small angles.
    let sine = (to - from * cosine).length();
    if sine < f32::EPSILON {
        // Opposite quaternions: one rotation, and every arc is as long.
        return from;
    }
    let angle = single::atan2(sine, cosine);
    let [a, b] = [1.0 - t, t].map(|share| single::sin(share * angle) / sine);
    (from * a + to * b).normalize()
}

/// Turns unit vector `from` towards unit vector `to` by the share `t` of the angle θ between them:
/// cos(tθ) from + sin(tθ) w, where w is the unit vector along to − (from · to) from. Opposite
/// vectors have no shortest arc; then w is some vector at a right angle to `from`.
#[must_use]
pub fn slerp_vectors(from: Vec3, to: Vec3, t: f32) -> Vec3 {
    let cosine = from.dot(to);
    let across = to - from * cosine;
    let sine = across.length();
    let w = if sine > 1e-6 {
        across / sine
    } else if cosine < 0.0 {
        from.any_orthonormal_vector()
    } else {
        return (from * (1.0 - t) + to * t).normalize_or(from);
    };
    let (sin, cos) = single::sin_cos(t * single::atan2(sine, cosine));
    from * cos + w * sin
}
