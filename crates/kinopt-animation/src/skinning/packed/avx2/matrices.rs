//! Blended matrices Σ_j w_j T_j of eight vertices.

use std::arch::x86_64::*;

use glam::{Affine3A, Vec4};

use super::lanes::{lower, transposed, upper};
use super::{BLOCK, Blended, entry};
use crate::skinning::packed::weights::FourInfluences;

/// A transform in two registers: columns x and y, then z and the translation. Each column is padded with a zero.
pub(crate) type Columns = [__m256; 2];

/// Converts a transform to the layout of the kernel.
#[inline]
pub(crate) fn columns(transform: &Affine3A) -> Columns {
    let matrix = transform.matrix3;
    let columns = [
        matrix.x_axis,
        matrix.y_axis,
        matrix.z_axis,
        transform.translation,
    ];
    bytemuck::cast(columns.map(|column| Vec4::from((column, 0.0))))
}

/// Blends transforms, or stretches if `STRETCH` is set.
#[inline]
#[target_feature(enable = "avx2,fma")]
pub(super) fn blended<const STRETCH: bool>(
    palette: &[Columns],
    influences: &[FourInfluences; BLOCK],
) -> Blended {
    let mut sums = [[_mm256_setzero_ps(); 2]; BLOCK];
    for (sum, four) in sums.iter_mut().zip(influences) {
        *sum = blend(palette, four);
    }
    let (x, _) = transposed(sums.map(|[xy, _]| lower(xy)));
    let (y, _) = transposed(sums.map(|[xy, _]| upper(xy)));
    let (z, _) = transposed(sums.map(|[_, zt]| lower(zt)));
    let (translation, _) = transposed(sums.map(|[_, zt]| upper(zt)));
    Blended {
        x,
        y,
        z,
        translation,
    }
}

#[inline]
#[target_feature(enable = "avx2,fma")]
fn blend(palette: &[Columns], four: &FourInfluences) -> Columns {
    // SAFETY: `PackedWeights::new` checked the bone indices, and `deform` the length of the palette.
    #[allow(unsafe_code)]
    let column = |index: usize| unsafe { entry(palette, four.bones[index]) };
    let weight = |index: usize| _mm256_set1_ps(four.weights[index]);
    let mut sum = column(0).map(|entries| _mm256_mul_ps(entries, weight(0)));
    for index in 1..four.bones.len() {
        let entries = column(index);
        sum[0] = _mm256_fmadd_ps(entries[0], weight(index), sum[0]);
        sum[1] = _mm256_fmadd_ps(entries[1], weight(index), sum[1]);
    }
    sum
}
