//! What this processor can do, asked in one place.

/// Whether functions compiled for AVX2 and FMA may run here.
#[cfg(target_arch = "x86_64")]
#[inline]
pub(crate) fn has_avx2_and_fma() -> bool {
    std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma")
}
