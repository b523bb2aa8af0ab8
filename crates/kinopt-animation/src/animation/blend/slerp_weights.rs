//! Slerp weights from the cosine, without trigonometry.
//!
//! Eberly 2011, "A fast and accurate algorithm for computing SLERP": sin(tΩ)/sin Ω as a series in cos Ω − 1. The series
//! has eight terms, with a correction of the last. The error is at most 2e-5, and below 1e-6 for Ω under 60° (rotations
//! 120° apart). In a blend both rotations change each frame, so no angle can be stored as in a clip's arcs.

/// Correction of the last of eight terms, from the table of the paper.
const MU: f32 = 1.852_981_1;
const TERMS: usize = 8;

/// sin(tΩ)/sin Ω for each t and cosine. Cosines are within [0, 1], up to rounding.
#[inline(always)]
pub(super) fn slerp_weights<const N: usize>(t: &[f32; N], cosines: &[f32; N]) -> [f32; N] {
    let mut sum = [0.0; N];
    for term in (1..=TERMS).rev() {
        let [n, odd] = [term as f32, (2 * term + 1) as f32];
        let correction = if term == TERMS { MU } else { 1.0 };
        let [u, v] = [correction / (n * odd), correction * n / odd];
        for lane in 0..N {
            let b = (u * t[lane] * t[lane] - v) * (cosines[lane] - 1.0);
            sum[lane] = b * sum[lane] + b;
        }
    }
    for lane in 0..N {
        sum[lane] = t[lane] * sum[lane] + t[lane];
    }
    sum
}
