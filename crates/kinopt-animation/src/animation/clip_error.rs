//! Errors of armatures, poses and clips.

use super::Property;
use super::curve::KeyError;
use kinopt_kinematics::SizeMismatch;
use kinopt_kinematics::model::UnknownName;

/// Error of an armature, a pose, a clip, or Euler keyframes.
///
/// Tracks and keys are counted from 0 in the given order. Bones of poses and Euler keyframes are given by index.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClipError {
    /// A parent does not precede its child, as in a cycle.
    #[error("bone `{bone}`: its parent must precede it in the list")]
    ParentNotBefore {
        /// Name of the child.
        bone: String,
    },
    /// Two bones or two morph targets share a name.
    #[error("{kind} name `{name}` is used twice; names must be unique")]
    DuplicateName {
        /// `bone` or `morph target`.
        kind: &'static str,
        /// The name.
        name: String,
    },
    /// A rest transform that is not finite or has an invalid rotation.
    #[error("bone `{bone}`: the rest transform must be finite, with a unit quaternion as rotation")]
    BadRest {
        /// Name of the bone.
        bone: String,
    },
    /// Number of bones above the maximum.
    #[error("{given} bones; an armature has at most {most}")]
    TooManyBones {
        /// Number of bones given.
        given: usize,
        /// Largest number of bones.
        most: usize,
    },
    /// A bone of another armature than the pose's.
    #[error("bone {bone} does not exist; the pose has {bones} bones")]
    UnknownPoseBone {
        /// Index of the bone.
        bone: usize,
        /// Number of bones.
        bones: usize,
    },
    /// A local transform with a number that is NaN or infinite.
    #[error("bone {bone}: the local transform must be finite")]
    NonFiniteTransform {
        /// Index of the bone.
        bone: usize,
    },
    /// The transform of the bone's parent is singular, so no local transform gives the requested one.
    #[error("bone {bone}: the transform of its parent is singular; it must have a volume")]
    Flattened {
        /// Index of the bone.
        bone: usize,
    },
    /// A model transform that has no scale, rotation and translation in the parent.
    #[error("bone {bone}: its local transform must not shear or have zero size")]
    Sheared {
        /// Index of the bone.
        bone: usize,
    },
    /// A local rotation that is a zero quaternion.
    #[error("bone {bone}: the quaternion is zero; a rotation needs a non-zero quaternion")]
    ZeroRotation {
        /// Index of the bone.
        bone: usize,
    },
    /// Two channels for one property of one bone.
    #[error("bone `{bone}`: a {property} channel exists already; a bone takes one")]
    DuplicateChannel {
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
    /// Pose or clip of another armature.
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
    /// No clip name equals or ends with the name.
    #[error(transparent)]
    UnknownName(#[from] UnknownName),
    /// Several clip names end with the name.
    #[error("clip name `{name}` may mean {}", clips.join(" or "))]
    AmbiguousName {
        /// The requested name.
        name: String,
        /// Full names of the matching clips, in their order.
        clips: Vec<String>,
    },
    /// Two tracks of Euler keyframes for one bone.
    #[error("bone {bone}: a track exists already; a bone takes one")]
    DuplicateTrack {
        /// Index of the second track.
        track: usize,
        /// Index of the bone.
        bone: usize,
    },
    /// A time of an Euler keyframe is NaN or infinite.
    #[error("the time {time} s is not finite")]
    NonFiniteKeyTime {
        /// Index of the track.
        track: usize,
        /// Index of the key.
        key: usize,
        /// Time, seconds.
        time: f64,
    },
    /// An angle of an Euler keyframe is NaN or infinite.
    #[error("the angles {angles:?} rad are not finite")]
    NonFiniteAngle {
        /// Index of the track.
        track: usize,
        /// Index of the key.
        key: usize,
        /// Angles, radians.
        angles: [f64; 3],
    },
    /// A time of an Euler keyframe is not after the previous one.
    #[error("the time {time} s is not after the key before it, at {previous} s")]
    NotIncreasing {
        /// Index of the track.
        track: usize,
        /// Index of the key.
        key: usize,
        /// Time, seconds.
        time: f64,
        /// Time of the previous key, seconds.
        previous: f64,
    },
    /// The number of Kochanek-Bartels control sets is not the number of keys.
    #[error(
        "bone {bone}: {given} sets of controls for {keys} keys; there must be one for each key"
    )]
    ControlCount {
        /// Index of the bone.
        bone: usize,
        /// Number of sets given.
        given: usize,
        /// Number of keys of the bone.
        keys: usize,
    },
    /// Values too large, or times too close, for a tangent in double precision.
    #[error("bone {bone}: {problem}")]
    Curve {
        /// Index of the bone.
        bone: usize,
        /// The error of the curve.
        problem: KeyError,
    },
    /// A tension, continuity or bias is NaN or infinite.
    #[error("bone {bone}, key {key}: tension, continuity and bias must be finite")]
    NonFiniteControls {
        /// Index of the bone.
        bone: usize,
        /// Index of the key.
        key: usize,
    },
    /// The time at which an Euler clip is sampled is NaN or infinite.
    #[error("the time {time} s is not finite")]
    NonFiniteSampleTime {
        /// Time, seconds.
        time: f64,
    },
    /// The clip moves a bone that the configuration does not contain.
    #[error("the configuration has {angles} angles, too few for bone {bone} of the clip")]
    TooFewAngles {
        /// Index of the bone.
        bone: usize,
        /// Number of angles of the configuration.
        angles: usize,
    },
}
