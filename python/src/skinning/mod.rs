//! Skinning: moving a mesh with the handles it is bound to.

mod automatic;
mod handles;
mod mesh_weights;
mod morph;
mod weights;

use kinopt::skinning::SkinningMethod;
use pyo3::prelude::*;

pub(crate) use self::morph::MorphTargets;
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
    #[pymodule_export]
    use super::automatic::{AutomaticWeights, HeatWeights};
    #[pymodule_export]
    use super::handles::{BoneBoxes, CageBinding, PointHandle};
    #[pymodule_export]
    use super::mesh_weights::MeshWeights;
    #[pymodule_export]
    use super::morph::{BlendShapes, MorphTarget, MorphTargets};
}
