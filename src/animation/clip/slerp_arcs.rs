//! Rotation keys ready for slerp without trigonometry at run time.
//!
//! slerp's weights are sin((1−t)Ω)/sin Ω and sin(tΩ)/sin Ω, with Ω at most π/2 after the choice of
//! side. Ω is the same on every frame between two keys, so Ω² and Ω/sin Ω are kept with them, and
//! sin x / x is a polynomial in x²: the one of degree 8 with the least relative error for x up to π/2
//! (Remez; 5.3e-9). Then t Ω/sin Ω · P(t²Ω²) is the weight, exact to single precision for all angles,
//! zero included.

use glam::{Quat, Vec4};

use crate::scalar::elementary;

/// The arc from one key to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    /// Ω²: the angle between the unit quaternions, squared, in radians.
    pub(super) squared: f32,
    /// Ω / sin Ω.
    pub(super) ratio: f32,
}

impl Arc {
    /// From one unit quaternion to another on its side.
    pub(super) fn between(from: Quat, to: Quat) -> Self {
        let (from, to) = (from.as_dquat(), to.as_dquat());
        let cosine = from.dot(to).clamp(-1.0, 1.0);
        let sine = (to - from * cosine).length();
        let angle = elementary::atan2(sine, cosine);
        Self {
            squared: (angle * angle) as f32,
            ratio: if sine > 0.0 { angle / sine } else { 1.0 } as f32,
        }
    }
}

/// sin(tΩ)/sin Ω for four arcs.
#[inline(always)]
pub(super) fn weights(t: Vec4, squared: Vec4, ratio: Vec4) -> Vec4 {
    const SERIES: [f32; 4] = [-0.000_198_074_2, 0.008_333_025, -0.166_666_57, 1.0];
    let x_squared = t * t * squared;
    let first = Vec4::splat(2.601_903e-6);
    let sum = SERIES
        .iter()
        .fold(first, |sum, &term| sum * x_squared + Vec4::splat(term));
    sum * t * ratio
}
