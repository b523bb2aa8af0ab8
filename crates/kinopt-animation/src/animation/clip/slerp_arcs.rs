//! Rotation keys prepared for slerp without trigonometry at run time.
//!
//! The weights of slerp are sin((1−t)Ω)/sin Ω and sin(tΩ)/sin Ω. After the choice of sign Ω is at most π/2.
//!
//! Ω is constant between two keys, so Ω² and Ω/sin Ω are stored with them. sin x / x is a polynomial in x² of degree 8
//! in x. It has the least relative error up to π/2 (Remez; 5.3e-9). The weight t · Ω/sin Ω · P(t²Ω²) is exact to single
//! precision for all angles, including zero.

use glam::{Quat, Vec4};

use kinopt_kinematics::scalar::elementary;

/// Arc from one key to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    /// Ω²: squared angle between the unit quaternions, rad².
    pub(super) squared: f32,
    /// Ω / sin Ω.
    pub(super) ratio: f32,
}

impl Arc {
    /// Arc between two unit quaternions on the same hemisphere.
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
