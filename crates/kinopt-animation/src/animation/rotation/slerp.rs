//! Interpolation of rotations and directions along the shortest arc.
//!
//! Shoemake 1985, "Animating rotation with quaternion curves".

use glam::{Quat, Vec3};

use kinopt_kinematics::scalar::elementary::single;

/// Cosine above which the arc is straight to single precision, and sin Ω too small to divide by.
const MIN_NLERP_COSINE: f32 = 0.9995;

/// `q` or −q, which describe one rotation: the one on the hemisphere of `reference`.
#[inline]
#[must_use]
pub fn nearer(q: Quat, reference: Quat) -> Quat {
    if q.dot(reference) < 0.0 { -q } else { q }
}

/// Normalised linear interpolation between unit quaternions along the shorter arc. It follows the arc of [`slerp`], but
/// is faster in the middle. For rotations half a turn apart both arcs are equally short.
#[inline]
#[must_use]
pub fn nlerp(from: Quat, to: Quat, t: f32) -> Quat {
    let to = nearer(to, from);
    (from * (1.0 - t) + to * t).normalize()
}

/// Spherical linear interpolation between unit quaternions along the shorter arc, at constant angular speed. The result
/// is sin((1−t)Ω)/sin Ω · from + sin(tΩ)/sin Ω · to, with cos Ω = from · to. Nearly equal rotations use [`nlerp`].
#[must_use]
pub fn slerp(from: Quat, to: Quat, t: f32) -> Quat {
    arc(from, nearer(to, from), t)
}

/// [`slerp`] without a choice of sign, even if the arc is the longer one for the rotations.
pub(super) fn arc(from: Quat, to: Quat, t: f32) -> Quat {
    let cosine = from.dot(to);
    if cosine > MIN_NLERP_COSINE {
        return (from * (1.0 - t) + to * t).normalize();
    }
    // From sine and cosine, because the arc cosine loses digits at small angles.
    let sine = (to - from * cosine).length();
    if sine < f32::EPSILON {
        // Opposite quaternions describe one rotation.
        return from;
    }
    let angle = single::atan2(sine, cosine);
    let [a, b] = [1.0 - t, t].map(|weight| single::sin(weight * angle) / sine);
    (from * a + to * b).normalize()
}

/// Rotates unit vector `from` towards unit vector `to` by the fraction `t` of the angle θ between them. The result is
/// cos(tθ) from + sin(tθ) w, with w the unit vector along to − (from · to) from. For opposite vectors, w is some vector
/// perpendicular to `from`.
#[must_use]
pub fn slerp_vectors(from: Vec3, to: Vec3, t: f32) -> Vec3 {
    let cosine = from.dot(to);
    let perpendicular = to - from * cosine;
    let sine = perpendicular.length();
    let w = if sine > 1e-6 {
        perpendicular / sine
    } else if cosine < 0.0 {
        from.any_orthonormal_vector()
    } else {
        return (from * (1.0 - t) + to * t).normalize_or(from);
    };
    let (sin, cos) = single::sin_cos(t * single::atan2(sine, cosine));
    from * cos + w * sin
}
