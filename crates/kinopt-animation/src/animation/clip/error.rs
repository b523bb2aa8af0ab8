//! Errors of clips and their parts.

use super::Property;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::curve::KeyError;

/// Error of a clip or of one of its parts.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ChannelError {
    /// Two channels for one property of one bone.
    #[error("bone `{bone}`: a {property} channel exists already; a bone takes one")]
    Duplicate {
        /// Name of the bone.
        bone: String,
        /// The property.
        property: Property,
    },
    /// Two channels for one morph target.
    #[error("morph target `{target}`: a channel exists already; a target takes one")]
    DuplicateTarget {
        /// Name of the target.
        target: String,
    },
    /// Bone of another armature.
    #[error("bone {bone} does not exist; the armature has {bones} bones")]
    UnknownBone {
        /// Index of the bone.
        bone: usize,
        /// Number of bones.
        bones: usize,
    },
    /// Morph target of another armature.
    #[error("morph target {target} does not exist; the armature has {targets} targets")]
    UnknownTarget {
        /// Index of the target.
        target: usize,
        /// Number of morph targets.
        targets: usize,
    },
    /// The number of morph weights is not keys × targets.
    #[error("{given} morph weights; {keys} keys of {targets} targets need one weight each")]
    WeightCount {
        /// Number of weights given.
        given: usize,
        /// Number of key times.
        keys: usize,
        /// Number of morph targets.
        targets: usize,
    },
    /// Invalid keys of a channel.
    #[error(transparent)]
    Keys(#[from] KeyError),
    /// Invalid keys of a bone's Euler angles.
    #[error("bone `{bone}`: {problem}")]
    BoneKeys {
        /// Name of the bone.
        bone: String,
        /// The error of the keys.
        #[source]
        problem: KeyError,
    },
    /// Invalid keys of a morph target's weight.
    #[error("morph target `{target}`: {problem}")]
    TargetKeys {
        /// Name of the target.
        target: String,
        /// The error of the keys.
        #[source]
        problem: KeyError,
    },
    /// The rotation before an Euler channel's angles is not a unit quaternion.
    #[error("bone `{bone}`: the rotation before the angles must be a unit quaternion")]
    BadRotation {
        /// Name of the bone.
        bone: String,
    },
    /// Pose of another armature.
    #[error(transparent)]
    Size(#[from] SizeMismatch),
    /// Number of keys per second that results in no key or in too many.
    #[error(
        "sample rate {keys_per_second} keys/s: it must be above 0 and give fewer than four million keys"
    )]
    BadRate {
        /// Requested keys per second.
        keys_per_second: f64,
    },
    /// Time that is not within the clip.
    #[error("time {given} s is outside (0, {duration}] s, the length of the clip")]
    NotWithin {
        /// Requested time, seconds.
        given: f64,
        /// Duration of the clip, seconds.
        duration: f64,
    },
    /// Up axis without a direction.
    #[error("up axis {up:?}: it must be finite and not zero")]
    BadUp {
        /// The vector given.
        up: [f32; 3],
    },
    /// Event at a time that is NaN or infinite.
    #[error("event `{event}`: the time {time} s is not finite")]
    EventTime {
        /// Name of the event.
        event: String,
        /// Time, seconds.
        time: f32,
    },
    /// Span that is not finite or ends before it starts.
    #[error("span [{start}, {end}] s: both times must be finite and the end not before the start")]
    BadSpan {
        /// Start, seconds.
        start: f32,
        /// End, seconds.
        end: f32,
    },
}
