//! Skinning: moving a mesh with the handles it is bound to.

mod weights;

use kinopt::skinning::SkinningMethod;
use pyo3::prelude::*;

pub(crate) use self::weights::SkinWeights;
use crate::error::OrRaise;

/// A way to move skin by its name.
pub(crate) fn method(name: &str) -> PyResult<SkinningMethod> {
    name.parse::<SkinningMethod>().or_raise()
}

/// Moving a mesh with the handles it is bound to.
#[pymodule(submodule)]
pub(crate) mod skinning {
    #[pymodule_export]
    use super::SkinWeights;
}
