//! Packed skinning: at most four influences per vertex, eight vertices at a time.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod dual_quaternions;
mod matrices;
mod weights;

pub use dual_quaternions::PackedDualQuaternionBlend;
pub use matrices::PackedLinearBlend;
pub use weights::PackedWeights;
