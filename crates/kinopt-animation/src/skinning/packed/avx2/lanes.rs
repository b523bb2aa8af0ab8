//! SIMD vectors of eight vertices: one register per coordinate.

use std::arch::x86_64::*;

use glam::{Vec3, Vec4};

use super::BLOCK;

/// Largest squared length that counts as zero: vectors shorter than 1e-18 have no direction.
const MAX_ZERO_LENGTH_SQUARED: f32 = 1e-36;

/// x, y and z of eight vectors.
#[derive(Clone, Copy)]
pub(super) struct Vec3x8 {
    pub(super) x: __m256,
    pub(super) y: __m256,
    pub(super) z: __m256,
}

/// Lower half of a register.
#[inline]
#[target_feature(enable = "avx2,fma")]
pub(super) fn lower(v: __m256) -> __m128 {
    _mm256_castps256_ps128(v)
}

#[inline]
#[target_feature(enable = "avx2,fma")]
pub(super) fn upper(v: __m256) -> __m128 {
    _mm256_extractf128_ps::<1>(v)
}

/// Transposes eight vectors of four coordinates to four registers.
#[inline]
#[target_feature(enable = "avx2,fma")]
pub(super) fn transposed(v: [__m128; BLOCK]) -> (Vec3x8, __m256) {
    let join_halves = |low, high| _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(low), high);
    let [a, b, c, d] = [
        join_halves(v[0], v[4]),
        join_halves(v[1], v[5]),
        join_halves(v[2], v[6]),
        join_halves(v[3], v[7]),
    ];
    // Within each half: x0 x1 y0 y1, x2 x3 y2 y3, z0 z1 w0 w1, z2 z3 w2 w3.
    let (xy, xy_after) = (_mm256_unpacklo_ps(a, b), _mm256_unpacklo_ps(c, d));
    let (zw, zw_after) = (_mm256_unpackhi_ps(a, b), _mm256_unpackhi_ps(c, d));
    let vectors = Vec3x8 {
        x: _mm256_shuffle_ps::<0x44>(xy, xy_after),
        y: _mm256_shuffle_ps::<0xEE>(xy, xy_after),
        z: _mm256_shuffle_ps::<0x44>(zw, zw_after),
    };
    (vectors, _mm256_shuffle_ps::<0xEE>(zw, zw_after))
}

/// `value` with its sign flipped if `sign_source` is negative.
#[inline]
#[target_feature(enable = "avx2,fma")]
pub(super) fn with_sign_flipped_by(value: __m256, sign_source: __m256) -> __m256 {
    _mm256_xor_ps(value, _mm256_and_ps(sign_source, _mm256_set1_ps(-0.0)))
}

impl Vec3x8 {
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn zero() -> Self {
        let zero = _mm256_setzero_ps();
        Self {
            x: zero,
            y: zero,
            z: zero,
        }
    }

    /// Loads eight vectors and separates their 24 numbers by coordinate.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn load(vectors: &[Vec3; BLOCK]) -> Self {
        let [first, second, third]: [__m256; 3] = bytemuck::cast(*vectors);
        // Six quarters of four numbers: a holds the first and fourth, b and c the next ones.
        let a = _mm256_permute2f128_ps::<0x30>(first, second);
        let b = _mm256_permute2f128_ps::<0x21>(first, third);
        let c = _mm256_permute2f128_ps::<0x30>(second, third);
        let xy = _mm256_shuffle_ps::<0b10_01_11_10>(b, c); // x2 y2 x3 y3
        let yz = _mm256_shuffle_ps::<0b01_00_10_01>(a, b); // y0 z0 y1 z1
        Self {
            x: _mm256_shuffle_ps::<0b10_00_11_00>(a, xy),
            y: _mm256_shuffle_ps::<0b11_01_10_00>(yz, xy),
            z: _mm256_shuffle_ps::<0b11_00_11_01>(yz, c),
        }
    }

    /// Inverse of [`load`](Self::load).
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn store(self) -> [Vec3; BLOCK] {
        let Self { x, y, z } = self;
        let xy = _mm256_shuffle_ps::<0b10_00_10_00>(x, y); // x0 x2 y0 y2
        let yz = _mm256_shuffle_ps::<0b11_01_11_01>(y, z); // y1 y3 z1 z3
        let zx = _mm256_shuffle_ps::<0b11_01_10_00>(z, x); // z0 z2 x1 x3
        let a = _mm256_shuffle_ps::<0b10_00_10_00>(xy, zx); // x0 y0 z0 x1
        let b = _mm256_shuffle_ps::<0b11_01_10_00>(yz, xy); // y1 z1 x2 y2
        let c = _mm256_shuffle_ps::<0b11_01_11_01>(zx, yz); // z2 x3 y3 z3
        bytemuck::cast([
            _mm256_permute2f128_ps::<0x20>(a, b),
            _mm256_permute2f128_ps::<0x30>(c, a),
            _mm256_permute2f128_ps::<0x31>(b, c),
        ])
    }

    /// Loads eight vectors; returns x, y, z, and w separately.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn load_with_fourth(vectors: &[Vec4; BLOCK]) -> (Self, __m256) {
        transposed(bytemuck::cast(*vectors))
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn store_with_fourth(self, w: __m256) -> [Vec4; BLOCK] {
        // A transposition is its own inverse within each half.
        let (xy, xy_after) = (
            _mm256_unpacklo_ps(self.x, self.y),
            _mm256_unpackhi_ps(self.x, self.y),
        );
        let (zw, zw_after) = (_mm256_unpacklo_ps(self.z, w), _mm256_unpackhi_ps(self.z, w));
        let rows = [
            _mm256_shuffle_ps::<0x44>(xy, zw),
            _mm256_shuffle_ps::<0xEE>(xy, zw),
            _mm256_shuffle_ps::<0x44>(xy_after, zw_after),
            _mm256_shuffle_ps::<0xEE>(xy_after, zw_after),
        ];
        bytemuck::cast([
            _mm256_permute2f128_ps::<0x20>(rows[0], rows[1]),
            _mm256_permute2f128_ps::<0x20>(rows[2], rows[3]),
            _mm256_permute2f128_ps::<0x31>(rows[0], rows[1]),
            _mm256_permute2f128_ps::<0x31>(rows[2], rows[3]),
        ])
    }

    /// x a + y b + z c + d.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn weighted(self, a: Self, b: Self, c: Self, d: Self) -> Self {
        let sum = |a, b, c, d| {
            let inner = _mm256_fmadd_ps(self.y, b, _mm256_fmadd_ps(self.z, c, d));
            _mm256_fmadd_ps(self.x, a, inner)
        };
        Self {
            x: sum(a.x, b.x, c.x, d.x),
            y: sum(a.y, b.y, c.y, d.y),
            z: sum(a.z, b.z, c.z, d.z),
        }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn dot(self, other: Self) -> __m256 {
        let inner = _mm256_fmadd_ps(self.y, other.y, _mm256_mul_ps(self.z, other.z));
        _mm256_fmadd_ps(self.x, other.x, inner)
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn cross(self, other: Self) -> Self {
        let difference_of_products = |a, b, c, d| _mm256_fmsub_ps(a, b, _mm256_mul_ps(c, d));
        Self {
            x: difference_of_products(self.y, other.z, self.z, other.y),
            y: difference_of_products(self.z, other.x, self.x, other.z),
            z: difference_of_products(self.x, other.y, self.y, other.x),
        }
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn scaled(self, factor: __m256) -> Self {
        Self {
            x: _mm256_mul_ps(self.x, factor),
            y: _mm256_mul_ps(self.y, factor),
            z: _mm256_mul_ps(self.z, factor),
        }
    }

    /// Normalised vectors; zero for vectors without length.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn normalised(self) -> Self {
        self.divided(self.length())
    }

    /// Normalised vectors, negated if `sign` is negative.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    pub(super) fn normalised_with_sign_of(self, sign: __m256) -> Self {
        self.divided(with_sign_flipped_by(self.length(), sign))
    }

    /// ‖v‖, or infinity for a length that counts as zero. The root is exact: the results of the estimates rsqrt and rcp
    /// differ between processors.
    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn length(self) -> __m256 {
        let squared = self.dot(self);
        let is_nonzero =
            _mm256_cmp_ps::<_CMP_GT_OQ>(squared, _mm256_set1_ps(MAX_ZERO_LENGTH_SQUARED));
        let infinite = _mm256_set1_ps(f32::INFINITY);
        _mm256_blendv_ps(infinite, _mm256_sqrt_ps(squared), is_nonzero)
    }

    #[inline]
    #[target_feature(enable = "avx2,fma")]
    fn divided(self, divisor: __m256) -> Self {
        Self {
            x: _mm256_div_ps(self.x, divisor),
            y: _mm256_div_ps(self.y, divisor),
            z: _mm256_div_ps(self.z, divisor),
        }
    }
}
