//! Skinning: deformation of a mesh by bones, points, cages and morph targets.
//!
//! - Bones: [`SkinWeights`] and one transform per bone, with [`LinearBlend`] or [`DualQuaternionBlend`]; both implement
//!   [`Deformation`]. [`AutomaticWeights`], or `HeatWeights` with feature `heat`, compute weights.
//! - Scaled bones: [`LinearBlend`], or [`DualQuaternionBlend::stretched`] with the pivots of the bones.
//! - At most four influences per vertex: [`PackedWeights`], [`PackedLinearBlend`] and [`PackedDualQuaternionBlend`] are
//!   faster. [`MeshWeights`] selects them if possible.
//! - Points: [`PointHandle`]s. Their transforms deform the skin in place of bone transforms.
//! - Cages: [`CageBinding`] by mean-value coordinates.
//! - Shapes: [`MorphTargets`] change the mesh at rest, before skinning. [`BlendShapes`] are whole shapes, blended with
//!   weights that sum to 1.

mod automatic_weights;
mod blend_shapes;
mod bone_motions;
mod bone_transform;
mod bone_volumes;
mod bounds;
mod cage;
mod deformation;
mod directions;
mod dual_quaternion;
mod dual_quaternion_blend;
mod error;
mod linear_blend;
mod mean_value;
mod mesh_weights;
mod method;
mod morph;
mod packed;
mod point_handles;
mod pruning;
mod shared_scale;
mod vertices;
mod volume_masses;
mod weights;

pub use automatic_weights::AutomaticWeights;
#[cfg(feature = "heat")]
pub use automatic_weights::HeatWeights;
pub use blend_shapes::BlendShapes;
pub use bone_transform::single_precision_transform;
#[cfg(feature = "gltf")]
pub(crate) use bone_volumes::bone_volumes_within;
pub use bone_volumes::{BoneVolume, bone_volumes};
pub use bounds::BoneBoxes;
pub use cage::CageBinding;
pub use deformation::Deformation;
pub use dual_quaternion::DualQuaternion;
pub use dual_quaternion_blend::DualQuaternionBlend;
pub use error::SkinningError;
pub use linear_blend::LinearBlend;
pub use mesh_weights::MeshWeights;
pub use method::{SkinningMethod, UnknownSkinning};
pub use morph::{MorphTarget, MorphTargets};
pub use packed::{PackedDualQuaternionBlend, PackedLinearBlend, PackedWeights};
pub use point_handles::PointHandle;
pub use pruning::Pruning;
pub use vertices::{PosedVertices, RestVertices};
pub(crate) use volume_masses::masses_of_volumes;
pub use weights::{
    Influence, NEGATIVE_TOLERANCE, ROW_SUM_TOLERANCE, SkinWeights, SkinWeightsBuilder, WeightRepair,
};
