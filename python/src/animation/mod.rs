//! Animation: keyframes, interpolation, and poses.

mod aim;
mod armature;
mod blend;
mod bones_and_poses;
mod clip;
mod clip_builder;
mod clip_ik;
mod crowd;
mod curve;
mod euler_clip;
mod limb;
mod mask;
mod playhead;
mod pose;
mod pose_parts;
mod poses;
mod reach;
mod root_motion;
mod state_machine;

use pyo3::prelude::*;

pub(crate) use self::bones_and_poses::{Armature, Pose, poses_of};
pub(crate) use self::clip::Clip;
pub(crate) use self::euler_clip::EulerClip;

/// Animation: keyframes, interpolation, and poses.
#[pymodule(submodule)]
pub(crate) mod animation {
    #[pymodule_export]
    use super::aim::{Aim, AimGoal};
    #[pymodule_export]
    use super::blend::{Layer, blend_poses};
    #[pymodule_export]
    use super::bones_and_poses::{Armature, Pose, Poses};
    #[pymodule_export]
    use super::clip::Clip;
    #[pymodule_export]
    use super::clip_builder::ClipBuilder;
    #[pymodule_export]
    use super::clip_ik::{EditReport, EditedClip, FootPlant, ReachResult};
    #[pymodule_export]
    use super::crowd::{Crowd, PlayingClip};
    #[pymodule_export]
    use super::curve::easing::easing;
    #[pymodule_export]
    use super::curve::{EulerCurve, KeyedCurve, RotationCurve};
    #[pymodule_export]
    use super::euler_clip::EulerClip;
    #[pymodule_export]
    use super::limb::{Limb, LimbGoal};
    #[pymodule_export]
    use super::mask::BoneMask;
    #[pymodule_export]
    use super::playhead::{Passage, Playhead};
    #[pymodule_export]
    use super::reach::{EulerPoseMap, ReachLayer};
    #[pymodule_export]
    use super::root_motion::RootMotion;
    #[pymodule_export]
    use super::state_machine::{StateMachine, StateMachineRun};
}
