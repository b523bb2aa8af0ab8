//! What can be wrong with a state machine's definition.

use crate::animation::ClipNameError;
use crate::model::UnknownName;

/// A place in the definition, and what is wrong there.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{path}: {problem}")]
#[non_exhaustive]
pub struct StateMachineError {
    /// A path such as `transitions[2].to`.
    pub path: String,
    /// What is wrong there.
    #[source]
    pub problem: StateMachineProblem,
}

/// What is wrong at a place in a state machine's definition.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StateMachineProblem {
    /// A state, parameter or clip that does not exist.
    #[error(transparent)]
    Unknown(UnknownName),
    /// A name that several clips' names end with.
    #[error(transparent)]
    ClipName(ClipNameError),
    /// A name that several of the clips given have.
    #[error("{clips} clips are named `{clip}`")]
    AmbiguousClip {
        /// The name.
        clip: String,
        /// How many clips have it.
        clips: usize,
    },
    /// There are no states.
    #[error("there are no states")]
    NoStates,
    /// Two states share a name.
    #[error("state name `{name}` is used twice")]
    DuplicateState {
        /// The name.
        name: String,
    },
    /// A blend without clips.
    #[error("the blend has no clips")]
    EmptyBlend,
    /// The numbers of a blend's clips are not in order.
    #[error("{at} does not lie above {before}, the number of the clip before it")]
    NotRising {
        /// The number.
        at: f32,
        /// The number of the clip before it.
        before: f32,
    },
    /// A duration that is negative or not finite.
    #[error("{seconds} s is not a finite duration of at least 0")]
    BadDuration {
        /// In seconds.
        seconds: f64,
    },
    /// A speed, bound or default that is not finite.
    #[error("{value} is not finite")]
    NotFinite {
        /// The number.
        value: f64,
    },
    /// A condition that no number meets.
    #[error("no number is above {above} and below {below}")]
    NoNumber {
        /// The lower bound.
        above: f32,
        /// The upper bound.
        below: f32,
    },
    /// A condition that does not suit its parameter.
    #[error("`{parameter}` is a {kind}; its condition must have {expected}")]
    WrongCondition {
        /// The parameter.
        parameter: String,
        /// Number, flag or trigger.
        kind: &'static str,
        /// What belongs there.
        expected: &'static str,
    },
    /// A transition that would happen always, from every state.
    #[error("a transition from every state needs a condition under `when`")]
    Unconditional,
    /// The clips are not all for one armature.
    #[error("clip `{clip}` is for {bones} bones, the first one for {expected}")]
    OtherArmature {
        /// The clip.
        clip: String,
        /// Its bones.
        bones: usize,
        /// The first clip's bones.
        expected: usize,
    },
}
