//! Rotation keys ready for slerp without trigonometry at run time.
//!
//! slerp's weights are sin((1−t)Ω)/sin Ω and sin(tΩ)/sin Ω, with Ω at most π/2 after the choice of
//! side. Ω is the same on every frame between two keys, so Ω² and Ω/sin Ω are kept with them, and
//! sin x / x is a polynomial in x² (Taylor to x¹⁰; the next term is below 4e-8 here). Then t Ω/sin Ω ·
//! P(t²Ω²) is the weight, exact to single precision for all angles, zero included.

use glam::Quat;

/// The arc from one key to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Arc {
    /// Ω²: the angle between the unit quaternions, squared, in radians.
    squared: f32,
    /// Ω / sin Ω.
    ratio: f32,
}

/// How many weights are computed at a time, so that the compiler makes vectors of them.
pub(super) const WIDTH: usize = 8;

impl Arc {
    /// From one unit quaternion to another on its side.
    pub(super) fn between(from: Quat, to: Quat) -> Self {
        let (from, to) = (from.as_dquat(), to.as_dquat());
        let cosine = from.dot(to).clamp(-1.0, 1.0);
        let sine = (to - from * cosine).length();
        let angle = sine.atan2(cosine);
        Self {
            squared: (angle * angle) as f32,
            ratio: if sine > 0.0 { angle / sine } else { 1.0 } as f32,
        }
    }
}

/// sin(tΩ)/sin Ω for each t and its arc.
#[inline(always)]
pub(super) fn weights(t: &[f32; WIDTH], arcs: &[Arc; WIDTH]) -> [f32; WIDTH] {
    const SERIES: [f32; 5] = [
        1.0 / 362_880.0,
        -1.0 / 5_040.0,
        1.0 / 120.0,
        -1.0 / 6.0,
        1.0,
    ];
    let mut squared = [0.0; WIDTH];
    for lane in 0..WIDTH {
        squared[lane] = t[lane] * t[lane] * arcs[lane].squared;
    }
    let mut sum = [-1.0 / 39_916_800.0; WIDTH];
    for term in SERIES {
        for lane in 0..WIDTH {
            sum[lane] = sum[lane] * squared[lane] + term;
        }
    }
    for lane in 0..WIDTH {
        sum[lane] *= t[lane] * arcs[lane].ratio;
    }
    sum
}
