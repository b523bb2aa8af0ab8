//! Skinning: deformation of a mesh by bones and handles.

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

/// Returns a skinning method by its name.
pub(crate) fn method(name: &str) -> PyResult<SkinningMethod> {
    name.parse::<SkinningMethod>().or_raise()
}

/// Deformation of a mesh by bones and handles.
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
