//! Detection of processor features.

/// True if functions compiled for AVX2 and FMA may run on this machine.
///
/// The processor must have both, and the environment variable `KINOPT_PORTABLE` must be unset at the first call, or
/// empty or `0` (see `docs/internals/reproducibility.md`).
#[cfg(target_arch = "x86_64")]
#[inline]
#[doc(hidden)]
pub fn has_avx2_and_fma() -> bool {
    use std::sync::OnceLock;
    static IS_SUPPORTED: OnceLock<bool> = OnceLock::new();
    *IS_SUPPORTED.get_or_init(|| {
        std::is_x86_feature_detected!("avx2")
            && std::is_x86_feature_detected!("fma")
            && std::env::var_os("KINOPT_PORTABLE")
                .is_none_or(|value| value.is_empty() || value == "0")
    })
}
