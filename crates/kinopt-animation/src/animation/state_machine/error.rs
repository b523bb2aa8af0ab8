//! Errors of state machine definitions.

use crate::animation::ClipNameError;
use kinopt_kinematics::model::UnknownName;

/// Location in the definition and error there.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{path}: {problem}")]
#[non_exhaustive]
pub struct StateMachineError {
    /// Path such as `transitions[2].to`.
    pub path: String,
    /// The error at that path.
    #[source]
    pub problem: StateMachineProblem,
}

/// Error at a path of a state machine's definition.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StateMachineProblem {
    /// A state, parameter or clip that does not exist.
    #[error(transparent)]
    Unknown(UnknownName),
    /// A clip name that matches the end of several clip names.
    #[error(transparent)]
    ClipName(ClipNameError),
    /// Several of the given clips share a name.
    #[error("{clips} clips are named `{clip}`; names must be unique")]
    AmbiguousClip {
        /// The name.
        clip: String,
        /// Number of clips with the name.
        clips: usize,
    },
    /// The definition has no states.
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
    /// A duration that is negative or not finite.
    #[error("the duration {seconds} s must be finite and at least 0")]
    BadDuration {
        /// Duration, seconds.
        seconds: f64,
    },
    /// A speed, bound or default that is not finite.
    #[error("{value} is not finite")]
    NotFinite {
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
