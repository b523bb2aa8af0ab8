//! What can be wrong with the parts of a clip.

use super::Property;
use crate::SizeMismatch;
use crate::animation::curve::KeyError;

/// Why parts do not make a clip.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChannelError {
    /// Two channels move one property of one bone.
    #[error("bone `{bone}` has a {property} channel already")]
    Duplicate {
        /// The bone.
        bone: String,
        /// The property.
        property: Property,
    },
    /// Two channels move one morph target.
    #[error("morph target `{target}` has a channel already")]
    DuplicateTarget {
        /// The target.
        target: String,
    },
    /// A bone of another armature.
    #[error("bone {bone} does not exist; the armature has {bones}")]
    UnknownBone {
        /// The bone's index.
        bone: usize,
        /// How many bones there are.
        bones: usize,
    },
    /// A morph target that does not exist.
    #[error("morph target {target} does not exist; the armature has {targets}")]
    UnknownTarget {
        /// The target's index.
        target: usize,
        /// How many there are.
        targets: usize,
    },
    /// Values for several morph targets that are not one for each key and target.
    #[error("{given} morph weights for {keys} keys of {targets} targets")]
    WeightCount {
        /// How many weights were given.
        given: usize,
        /// How many key times.
        keys: usize,
        /// How many morph targets.
        targets: usize,
    },
    /// The keys of a channel.
    #[error(transparent)]
    Keys(#[from] KeyError),
    /// The keys of a bone's angles.
    #[error("bone `{bone}`: {problem}")]
    BoneKeys {
        /// The bone.
        bone: String,
        /// What is wrong with them.
        #[source]
        problem: KeyError,
    },
    /// The keys of a morph target's weight.
    #[error("morph target `{target}`: {problem}")]
    TargetKeys {
        /// The target.
        target: String,
        /// What is wrong with them.
        #[source]
        problem: KeyError,
    },
    /// The rotation before an Euler channel's angles is not one.
    #[error("bone `{bone}`: the rotation before the angles is not of unit length")]
    BadRotation {
        /// The bone.
        bone: String,
    },
    /// A pose of another armature.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// So many keys a second that there would be none or millions.
    #[error(
        "{keys_per_second} keys a second; it must be a number above 0 that makes fewer than four million keys"
    )]
    BadRate {
        /// What was asked for.
        keys_per_second: f64,
    },
    /// Seconds that are not within a clip.
    #[error(
        "{given} s of a clip that lasts {duration} s; it must be a number above 0 and no more than that"
    )]
    NotWithin {
        /// What was asked for.
        given: f64,
        /// How long the clip lasts.
        duration: f64,
    },
    /// An axis without a direction.
    #[error("the axis up, {up:?}, is not finite or has no direction")]
    BadUp {
        /// What was given.
        up: [f32; 3],
    },
    /// An event at a time that is not finite.
    #[error("event `{event}`: the time {time} is not finite")]
    EventTime {
        /// Its name.
        event: String,
        /// In seconds.
        time: f32,
    },
    /// A span of time that is not one.
    #[error("the span from {start} s to {end} s is not finite or ends before it starts")]
    BadSpan {
        /// In seconds.
        start: f32,
        /// In seconds.
        end: f32,
    },
}
