//! Errors of animation layers: IK, blending, masks and state machines.

use super::NoEffector;
use crate::animation::ClipError;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::model::{ModelError, UnknownName};
use kinopt_solver::ik::SolveError;

/// Error of a limb, an aim, an IK layer, a blend, a mask, or a state machine and its parameters.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LayerError {
    /// A bone of another armature.
    #[error("bone {bone} does not exist; the armature has {bones} bones")]
    UnknownBone {
        /// Index of the bone.
        bone: usize,
        /// Number of bones.
        bones: usize,
    },
    /// The lower bone is not a descendant of the upper one, or the end not one of the lower bone.
    #[error("bone `{lower}` must be a descendant of bone `{upper}`")]
    NotAbove {
        /// Name of the lower bone.
        lower: String,
        /// Name of the upper bone.
        upper: String,
    },
    /// An end point of a limb that is not finite.
    #[error("the end of the limb must be finite")]
    BadEnd,
    /// A hinge axis that is not finite or zero.
    #[error("the hinge axis must be finite and not zero")]
    BadHinge,
    /// A softening fraction outside [0, 1].
    #[error("the softening {share} is outside [0, 1]")]
    BadSoftening {
        /// The fraction given.
        share: f32,
    },
    /// An axis of an aim that is not finite or zero.
    #[error("the {axis} axis must be finite and not zero")]
    BadAxis {
        /// `forward` or `up`.
        axis: &'static str,
    },
    /// Forward and up axis of an aim are parallel.
    #[error("the up axis is parallel to the forward axis; the two must differ")]
    UpIsForward,
    /// An offset of an aim that is not finite.
    #[error("the offset must be finite")]
    BadOffset,
    /// A pose or a mask is of another armature.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// A bone for which the layer has no task of this kind.
    #[error(transparent)]
    NoEffector(#[from] NoEffector),
    /// A target or rotation that is zero or not finite.
    #[error("bone `{bone}`: its {what}")]
    NotFinite {
        /// Name of the bone.
        bone: String,
        /// The value and its defect.
        what: &'static str,
    },
    /// Angles or a configuration of another length or not finite.
    #[error(transparent)]
    Configuration(#[from] ModelError),
    /// The solve did not start.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// A weight of a pose that is negative or not finite.
    #[error("pose {pose}: the weight {weight} must be finite and at least 0")]
    BadWeight {
        /// Index of the pose.
        pose: usize,
        /// The weight given.
        weight: f32,
    },
    /// No pose has a weight above 0.
    #[error("no pose has a weight above 0; at least one must")]
    NoWeight,
    /// A bone or morph target of another armature.
    #[error("{what} {index} does not exist; there are {count}")]
    UnknownIndex {
        /// `bone` or `morph target`.
        what: &'static str,
        /// Index, from 0.
        index: usize,
        /// Number of bones or morph targets.
        count: usize,
    },
    /// A mask weight outside [0, 1].
    #[error("{what} {index}: the mask weight {share} is outside [0, 1]")]
    BadShare {
        /// `bone` or `morph target`.
        what: &'static str,
        /// Index, from 0.
        index: usize,
        /// The weight given.
        share: f32,
    },
    /// No state, parameter or clip has the name.
    #[error(transparent)]
    UnknownName(UnknownName),
    /// A value of a parameter that is NaN or infinite.
    #[error("parameter `{parameter}`: {value} is not finite")]
    NonFiniteParameter {
        /// Name of the parameter.
        parameter: String,
        /// The number.
        value: f32,
    },
    /// A clip name that matches the end of several clip names.
    #[error(transparent)]
    ClipName(ClipError),
    /// Several of the given clips share a name.
    #[error("{clips} clips are named `{clip}`; names must be unique")]
    AmbiguousClip {
        /// The name.
        clip: String,
        /// Number of clips with the name.
        clips: usize,
    },
    /// The state machine has no states.
    #[error("no states; at least one is needed")]
    NoStates,
    /// Two states share a name.
    #[error("state name `{name}` is used twice; names must be unique")]
    DuplicateState {
        /// The name.
        name: String,
    },
    /// A blend without clips.
    #[error("the blend has no clips; at least one is needed")]
    EmptyBlend,
    /// The numbers of a blend's clips do not increase.
    #[error("{at} must be above {before}, the number of the previous clip")]
    NotRising {
        /// The number of the clip.
        at: f32,
        /// The number of the previous clip.
        before: f32,
    },
    /// A duration in a state machine that is negative or not finite.
    #[error("the duration {seconds} s must be finite and at least 0")]
    BadDuration {
        /// Duration, seconds.
        seconds: f64,
    },
    /// A speed, bound or default in a state machine that is not finite.
    #[error("{value} is not finite")]
    NonFiniteNumber {
        /// The number.
        value: f64,
    },
    /// A condition that no number satisfies.
    #[error("no number is above {above} and below {below}; `above` must be less than `below`")]
    NoNumber {
        /// The lower bound.
        above: f32,
        /// The upper bound.
        below: f32,
    },
    /// A condition that does not match the kind of its parameter.
    #[error("`{parameter}` is a {kind}; its condition must have {expected}")]
    WrongCondition {
        /// Name of the parameter.
        parameter: String,
        /// `number`, `flag` or `trigger`.
        kind: &'static str,
        /// Allowed fields of the condition.
        expected: &'static str,
    },
    /// A transition from every state without a condition.
    #[error("a transition from every state needs a condition under `when`")]
    Unconditional,
    /// The clips are for armatures of different sizes.
    #[error("clip `{clip}` is for {bones} bones; the first clip is for {expected}")]
    OtherArmature {
        /// Name of the clip.
        clip: String,
        /// Number of bones of the clip.
        bones: usize,
        /// Number of bones of the first clip.
        expected: usize,
    },
}
