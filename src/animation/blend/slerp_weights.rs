//! slerp's weights from the cosine, without trigonometry.
//!
//! Eberly 2011, "A fast and accurate algorithm for computing SLERP": sin(tΩ)/sin Ω as a series in
//! cos Ω − 1, cut after eight terms with the last one corrected. Off by at most 2e-5, and by less
//! than 1e-6 below Ω = 60° (rotations 120° apart). Unlike the arcs of a clip's keys, the two
//! rotations of a blend are new on every frame, so there is no angle to keep.

/// The correction of the last term for eight terms (the paper's table).
const MU: f32 = 1.852_981_1;
const TERMS: usize = 8;

/// sin(tΩ)/sin Ω for each t and cosine; the cosines are at least 0 and at most 1 but for rounding.
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
