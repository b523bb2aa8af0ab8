//! Animation clips: keyed channels of many bones, sampled one pose at a time.

mod bones;
mod builder;
mod channel;
mod channels;
mod cursor;
mod curved;
mod events;
pub(crate) mod named;
mod playback;
mod playhead;
mod rotation_tracks;
#[cfg(feature = "serde")]
mod serialised;
mod slerp_arcs;
mod timelines;
mod tracks;
mod vector_tracks;

pub use builder::ClipBuilder;
#[cfg(feature = "gltf")]
pub(crate) use builder::keyed_span;
pub use channel::{Channel, EulerCurve, Property};
pub use cursor::Cursor;
pub use events::{Event, Fired};
pub use playback::Playback;
pub use playhead::{Passage, Playhead};

use std::sync::Arc;

use self::tracks::Tracks;
use super::{Armature, Pose, SizeMismatch};

/// Motion of an armature's bones and morph targets over a span of time. Properties without a channel are at rest.
///
/// ```
/// use glam::{Quat, Vec3A};
/// use kinopt::animation::curve::KeyedCurve;
/// use kinopt::animation::rotation::RotationCurve;
/// use kinopt::animation::{
///     Armature, ArmatureBone, Channel, Clip, Cursor, LocalTransform, Playback,
/// };
///
/// let bone = |name: &str, parent| ArmatureBone {
///     name: name.into(),
///     parent,
///     rest: LocalTransform { translation: Vec3A::X, ..LocalTransform::IDENTITY },
/// };
/// let armature = Armature::new(vec![bone("upper", None), bone("lower", Some(0))], Vec::new())?;
/// let nod = RotationCurve::slerp(
///     vec![0.0, 1.0],
///     vec![Quat::IDENTITY, Quat::from_rotation_z(1.0)],
/// )?;
/// let mut builder = Clip::builder("nod", &armature);
/// builder.channel(armature.bone("lower")?, Channel::Rotation(nod))?;
/// let clip = builder.build();
///
/// let (mut pose, mut cursor) = (armature.rest().clone(), Cursor::new());
/// clip.sample(0.5, Playback::Loop, &mut cursor, &mut pose)?;
/// let half = Quat::from_rotation_z(0.5);
/// assert!(pose.rotations()[1].abs_diff_eq(half, 1e-6));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(
        try_from = "serialised::KeyframeClipDocument",
        into = "serialised::KeyframeClipDocument"
    )
)]
pub struct Clip {
    name: String,
    /// `None` for a motion without frames.
    span: Option<[f32; 2]>,
    tracks: Arc<Tracks>,
    /// Values of properties that do not move.
    constant: Pose,
    events: Vec<Event>,
}

impl Clip {
    /// Starts a clip for an armature.
    #[must_use]
    pub fn builder(name: impl Into<String>, armature: &Armature) -> ClipBuilder<'_> {
        ClipBuilder::new(name.into(), armature)
    }

    /// Name of the clip.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// First and last time in seconds; both 0 if the clip [is empty](Self::is_empty).
    #[must_use]
    pub fn span(&self) -> [f32; 2] {
        self.span.unwrap_or_default()
    }

    /// True if the clip has no frames, like a motion capture file without samples. Sampling an empty clip gives the
    /// rest pose.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.span.is_none()
    }

    /// Number of bones.
    #[must_use]
    pub fn bones(&self) -> usize {
        self.constant.bones()
    }

    /// The clip, marked as having no frames.
    pub(crate) fn without_frames(mut self) -> Self {
        self.span = None;
        self
    }

    /// First time of the clip in seconds, as stored in the file.
    #[must_use]
    pub fn start(&self) -> f64 {
        self.span()[0].into()
    }

    /// Duration, seconds.
    #[must_use]
    pub fn duration(&self) -> f64 {
        // Single precision would round the duration and merge the end of a loop with its start.
        f64::from(self.span()[1]) - self.start()
    }

    /// The clip under another name.
    #[must_use]
    pub fn renamed(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Checks that the armature is of the clip's size.
    pub(in crate::animation) fn check_armature(
        &self,
        armature: &Armature,
    ) -> Result<(), SizeMismatch> {
        armature.rest().check_same_size(&self.constant)
    }

    /// Writes the pose at `time`, in seconds of the file as in [`span`](Self::span) and [`events`](Self::events).
    ///
    /// `playback` maps the time into the span; NaN counts as the start. Rotations between linear keys have constant
    /// angular speed (slerp, not nlerp). Values at key times equal the keys up to rounding.
    ///
    /// # Errors
    /// The pose is of another armature's size.
    pub fn sample(
        &self,
        time: f64,
        playback: Playback,
        cursor: &mut Cursor,
        pose: &mut Pose,
    ) -> Result<(), SizeMismatch> {
        self.constant.check_same_size(pose)?;
        let time = playback.within(time, self.span().map(f64::from)) as f32;
        self.tracks.fill_constant(&self.constant, pose);
        self.tracks
            .sample(time, cursor.segments_for(&self.tracks), pose);
        Ok(())
    }
}
