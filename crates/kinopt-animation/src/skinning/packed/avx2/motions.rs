//! Blended dual quaternions of eight vertices, and their matrices.

use std::arch::x86_64::*;

use super::lanes::{Vec3x8, lower, transposed, upper};
use super::{BLOCK, Blended, entry};
use crate::skinning::packed::weights::FourInfluences;

/// A dual quaternion in one register: the real part x, y, z, w, then the dual part.
pub(crate) type PackedDualQuaternion = __m256;

/// Blends dual quaternions. With `STRETCH` a blended stretch precedes them.
#[inline]
#[target_feature(enable = "avx2,fma")]
pub(super) fn blended<const STRETCH: bool>(
    palette: &[PackedDualQuaternion],
    influences: &[FourInfluences; BLOCK],
) -> Blended {
    let mut sums = [_mm256_setzero_ps(); BLOCK];
    for (sum, four) in sums.iter_mut().zip(influences) {
        *sum = blend(palette, four);
    }
    let (real, w) = transposed(sums.map(|sum| lower(sum)));
    let (dual, dual_w) = transposed(sums.map(|sum| upper(sum)));
    matrices(real, w, dual, dual_w)
}

/// Σ_j ±w_j q̂_j, each on the hemisphere of the first, which has the largest weight.
#[inline]
#[target_feature(enable = "avx2,fma")]
fn blend(palette: &[PackedDualQuaternion], four: &FourInfluences) -> PackedDualQuaternion {
    // SAFETY: `PackedWeights::new` checked the bone indices, and `deform` the length of the palette.
    #[allow(unsafe_code)]
    let [pivot, a, b, c] = four.bones.map(|bone| unsafe { entry(palette, bone) });
    let products = [a, b, c].map(|motion| _mm_mul_ps(lower(pivot), lower(motion)));
    let pairs = _mm_hadd_ps(products[0], products[1]);
    let dots = _mm_hadd_ps(pairs, _mm_hadd_ps(products[2], products[2]));
    let opposite = _mm_cmplt_ps(dots, _mm_setzero_ps());

    let [first, second, third, fourth] = four.weights;
    let others = _mm_setr_ps(second, third, fourth, 0.0);
    let signed = _mm_xor_ps(others, _mm_and_ps(opposite, _mm_set1_ps(-0.0)));
    let signed = _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(signed), signed);

    let sum = _mm256_mul_ps(pivot, _mm256_set1_ps(first));
    let sum = _mm256_fmadd_ps(a, _mm256_permute_ps::<0x00>(signed), sum);
    let sum = _mm256_fmadd_ps(b, _mm256_permute_ps::<0x55>(signed), sum);
    _mm256_fmadd_ps(c, _mm256_permute_ps::<0xAA>(signed), sum)
}

/// The rotation of r / ‖r‖ and the translation 2 d r* / ‖r‖².
#[inline]
#[target_feature(enable = "avx2,fma")]
fn matrices(r: Vec3x8, w: __m256, d: Vec3x8, dual_w: __m256) -> Blended {
    let squared = _mm256_fmadd_ps(w, w, r.dot(r));
    let twice = _mm256_div_ps(_mm256_set1_ps(2.0), squared);
    let s = r.scaled(twice);
    let mul = |a, b| _mm256_mul_ps(a, b);
    let (xx, yy, zz) = (mul(r.x, s.x), mul(r.y, s.y), mul(r.z, s.z));
    let (xy, xz, yz) = (mul(r.x, s.y), mul(r.x, s.z), mul(r.y, s.z));
    let (wx, wy, wz) = (mul(w, s.x), mul(w, s.y), mul(w, s.z));
    let add = |a, b| _mm256_add_ps(a, b);
    let sub = |a, b| _mm256_sub_ps(a, b);
    let one_less = |a, b| sub(_mm256_set1_ps(1.0), add(a, b));
    let cross = r.cross(d);
    let translation = |d, r, cross| {
        let sum = _mm256_fmadd_ps(w, d, cross);
        mul(_mm256_fnmadd_ps(dual_w, r, sum), twice)
    };
    Blended {
        x: Vec3x8 {
            x: one_less(yy, zz),
            y: add(xy, wz),
            z: sub(xz, wy),
        },
        y: Vec3x8 {
            x: sub(xy, wz),
            y: one_less(xx, zz),
            z: add(yz, wx),
        },
        z: Vec3x8 {
            x: add(xz, wy),
            y: sub(yz, wx),
            z: one_less(xx, yy),
        },
        translation: Vec3x8 {
            x: translation(d.x, r.x, cross.x),
            y: translation(d.y, r.y, cross.y),
            z: translation(d.z, r.z, cross.z),
        },
    }
}
