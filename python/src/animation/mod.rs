//! Motion over time: keyframes, what is between them, and poses.

mod euler_clip;
mod playback;

use pyo3::prelude::*;

pub(crate) use self::euler_clip::EulerClip;

/// Motion over time: keyframes, what is between them, and poses.
#[pymodule(submodule)]
pub(crate) mod animation {
    #[pymodule_export]
    use super::EulerClip;
}
