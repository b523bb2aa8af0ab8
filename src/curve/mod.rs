//! Curves through numbers and vectors: linear, eased, Bézier, Hermite, Catmull-Rom, Kochanek-Bartels.

mod bezier;
mod catmull_rom;
pub mod easing;
mod handle;
mod hermite;
mod keyed;
mod keys;
mod kochanek_bartels;
mod linear;
#[cfg(feature = "serde")]
mod serialised;
mod value;

pub use bezier::CubicBezier;
pub use catmull_rom::{Knots, catmull_rom, catmull_rom_at_knots};
pub use handle::BezierHandle;
pub use hermite::Hermite;
#[cfg(feature = "gltf")]
pub(crate) use keyed::Between;
pub use keyed::KeyedCurve;
pub use keys::{KeyError, KeyRepair, repair_keys};
pub(crate) use keys::{check_count, check_times};
pub use kochanek_bartels::TensionContinuityBias;
pub use linear::lerp;
pub use value::{CurveValue, Real};
