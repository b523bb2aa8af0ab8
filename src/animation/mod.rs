//! Motion over time: keyframes, what is between them, and poses.

mod affine;
mod blend;
mod clip;
mod crowd;
pub mod curve;
mod euler_clip;
mod euler_interpolation;
mod euler_sampling;
mod ik_layer;
mod plane_affine;
mod playback;
mod pose;
pub mod rotation;
mod state_machine;

pub use affine::{Decomposition, NotFinite, interpolate_affine};
pub use blend::{BlendError, BoneMask, Layer, LayerMode, blend_poses};
pub use clip::{
    Channel, ChannelError, Clip, ClipBuilder, Cursor, EulerCurve, Event, Fired, Passage, Playhead,
    Property,
};
pub use crowd::{Character, Crowd, PlayingClip};
pub use curve::easing::{BezierEasing, Easing, HandleError};
pub use euler_clip::{ClipError, EulerClip, EulerKey, EulerTrack};
pub use euler_interpolation::EulerInterpolation;
pub use euler_sampling::SampleError;
pub use ik_layer::{
    Aim, AimError, AimGoal, EndRotation, Limb, LimbError, LimbGoal, NoEffector, PoseBridge,
    ReachError, ReachLayer,
};
pub use plane_affine::{PlaneDecomposition, interpolate_plane_affine};
pub use playback::Playback;
pub use pose::{
    Armature, ArmatureBone, ArmatureError, LocalError, LocalTransform, Pose, SizeMismatch,
};
pub use state_machine::{
    BlendClip, BlendDefinition, ConditionDefinition, Interruption, MotionDefinition,
    ParameterDefault, ParameterError, ParameterValue, StateDefinition, StateEvent, StateMachine,
    StateMachineDefinition, StateMachineError, StateMachineProblem, StateMachineRun,
    TransitionDefinition, TriggerWord,
};
