//! Keyframe animation: clips, curves, poses, blending, state machines and IK layers.
//!
//! - Bones: an [`Armature`], made of bones or [of a skeleton](Armature::of_skeleton), and its [`Pose`]s. The armature
//!   computes model transforms and skinning transforms of a pose.
//! - Interpolation: [`curve`] (Hermite, Bézier, Catmull-Rom, Kochanek-Bartels, glTF's modes, easing) and [`rotation`]
//!   (slerp, squad, other splines, Euler angles, axis and angle). [`curve::repair_keys`] repairs unsorted or damaged
//!   keys.
//! - Playback: a [`Clip`] of [`Channel`]s and [`Event`]s, sampled with a [`Cursor`]. A [`Playhead`] holds the playback
//!   position and reports the events it passes.
//! - Edits: [`Clip::through_poses`], [`Clip::with_fewer_keys`], [`RootMotion`], [`Clip::with_closed_seam`].
//! - Blending: [`Pose::cross_fade`], [`blend_poses`], and [`Layer`]s with a [`BoneMask`].
//! - State machines: a [`StateMachine`] from JSON; each character runs its own [`StateMachineRun`].
//! - IK after the pose: [`Limb`] and [`Aim`] in closed form, [`ReachLayer`] by optimisation.
//! - Many characters: a [`Crowd`].
//! - Euler angles of a skeleton: an [`EulerClip`], as in rig files.
//! - Affine maps: [`interpolate_affine`].
//!
//! From keys to a skinned mesh:
//!
//! ```
//! use kinopt::animation::{Armature, Clip, Cursor, Playback};
//! use kinopt::io::rig::Rig;
//! use kinopt::skinning::{MeshWeights, SkinningMethod};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! # std::env::set_current_dir("../..")?;
//! let rig = Rig::read("models/humanoid/humanoid.json")?;
//! let (mesh, weights) = rig.mesh.zip(rig.weights).ok_or("a rig without a skin")?;
//! let (weights, lost) = weights.pruned(4)?;
//! assert!(lost.largest_lost < 0.1);
//! let weights = MeshWeights::from(weights);
//! let armature = Armature::of_skeleton(&rig.skeleton);
//! let mut builder = Clip::builder("keys", &armature);
//! builder.euler_clip(&rig.clip)?;
//! let clip = builder.build();
//!
//! // Each frame reuses these buffers.
//! let (mut pose, mut cursor) = (armature.rest().clone(), Cursor::new());
//! let (mut model_from_bone, mut posed_from_rest) = (Vec::new(), Vec::new());
//! clip.sample(0.5, Playback::Loop, &mut cursor, &mut pose)?;
//! armature.local_to_model(&pose, &mut model_from_bone)?;
//! armature.skinning_transforms(&model_from_bone, &mut posed_from_rest)?;
//! let posed = weights.mesh(SkinningMethod::DualQuaternion, &mesh, &posed_from_rest)?;
//! assert_eq!(posed.triangles(), mesh.triangles());
//! # Ok(())
//! # }
//! ```

mod affine;
mod blend;
pub(crate) mod clip;
mod clip_edits;
mod clip_error;
mod crowd;
mod euler_clip;
mod ik_layer;
mod layer_error;
mod pose;
pub mod rotation;
mod state_machine;

pub use affine::{
    Decomposition, NotFinite, PlaneDecomposition, interpolate_affine, interpolate_plane_affine,
};
pub use blend::{BoneMask, Layer, LayerMode, blend_poses};
pub use clip::{
    Channel, Clip, ClipBuilder, Cursor, EulerCurve, Event, Fired, Passage, Playback, Playhead,
    Property,
};
pub use clip_edits::{KeyTolerance, RootMotion};
pub use clip_error::ClipError;
pub use crowd::{Character, Crowd, PlayingClip};
pub use curve::easing::{BezierEasing, Easing, HandleError};
pub use euler_clip::{EulerClip, EulerInterpolation, EulerKey, EulerTrack};
pub use ik_layer::{
    Aim, AimGoal, BallPoseMap, EndRotation, EulerPoseMap, Limb, LimbGoal, NoEffector, ReachLayer,
};
#[doc(hidden)]
pub use ik_layer::{Corrected, ShearCorrection};
#[doc(hidden)]
pub use ik_layer::{bone_angles, bone_rotation};
pub use kinopt_kinematics::SizeMismatch;
pub use kinopt_kinematics::curve;
pub use layer_error::LayerError;
pub use pose::{Armature, ArmatureBone, LocalTransform, Pose, ScaleNote};
#[doc(hidden)]
pub use pose::{Mirror, Stretch};
pub use state_machine::{
    BlendClip, BlendDefinition, ConditionDefinition, Interruption, MotionDefinition,
    ParameterDefault, ParameterValue, StateDefinition, StateEvent, StateMachine,
    StateMachineDefinition, StateMachineError, StateMachineRun, TransitionDefinition, TriggerWord,
};
