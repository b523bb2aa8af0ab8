//! Keyframes of bone angles.

mod interpolation;
mod sampling;

pub use interpolation::EulerInterpolation;
pub use sampling::SampleError;

use glam::DVec3;

use crate::animation::curve::{KeyError, KeyedCurve};
use crate::skeleton::BoneId;

/// The angles of one bone at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EulerKey {
    /// In seconds.
    pub time: f64,
    /// (θ₁, θ₂, θ₃): first twist, bend, second twist, in radians. They need not be within the
    /// bone's limits.
    pub angles: [f64; 3],
}

/// The keys of one bone, strictly increasing in time.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EulerTrack {
    /// The bone they move.
    pub bone: BoneId,
    /// At times that need not be evenly spaced.
    pub keys: Vec<EulerKey>,
}

/// Keyframes for any of a skeleton's bones; a bone without keys has no track.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "serde", serde(try_from = "Tracks", into = "Tracks"))]
pub struct EulerClip {
    tracks: Vec<EulerTrack>,
    /// One for each track.
    between: Vec<EulerInterpolation>,
    /// What is sampled: one for each track, by what runs between its keys.
    curves: Vec<KeyedCurve<DVec3>>,
    /// Whose tracks had no keys.
    keyless: Vec<BoneId>,
}

/// What is wrong with keyframes. Tracks and keys are counted from 0 in the order given.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClipError {
    /// Two tracks for one bone.
    #[error("bone {bone} has a track already")]
    DuplicateBone {
        /// The second track.
        track: usize,
        /// The bone's index.
        bone: usize,
    },
    /// A time is NaN or infinite.
    #[error("the time {time} is not finite")]
    NonFiniteTime {
        /// Which track.
        track: usize,
        /// Which of its keys.
        key: usize,
        /// In seconds.
        time: f64,
    },
    /// An angle is NaN or infinite.
    #[error("the angles {angles:?} rad are not finite")]
    NonFiniteAngle {
        /// Which track.
        track: usize,
        /// Which of its keys.
        key: usize,
        /// In radians.
        angles: [f64; 3],
    },
    /// A key is not later than the one before.
    #[error("the time {time} s is not after the key before it, at {previous} s")]
    NotIncreasing {
        /// Which track.
        track: usize,
        /// Which of its keys.
        key: usize,
        /// Its time in seconds.
        time: f64,
        /// The time of the key before it.
        previous: f64,
    },
    /// There is not one set of Kochanek-Bartels controls for each key.
    #[error("bone {bone}: {given} sets of controls for {keys} keys")]
    ControlCount {
        /// The bone's index.
        bone: usize,
        /// How many sets were given.
        given: usize,
        /// How many keys the bone has.
        keys: usize,
    },
    /// Numbers so large, or so near to each other in time, that a tangent is beyond double precision.
    #[error("bone {bone}: {problem}")]
    Curve {
        /// The bone's index.
        bone: usize,
        /// What is wrong with the curve through its keys.
        problem: KeyError,
    },
    /// A tension, continuity or bias is NaN or infinite.
    #[error("bone {bone}, key {key}: tension, continuity and bias are not all finite")]
    NonFiniteControls {
        /// The bone's index.
        bone: usize,
        /// Which of its keys.
        key: usize,
    },
}

impl EulerClip {
    /// A clip of tracks in any order, with Catmull-Rom splines between keys. Tracks without keys are
    /// left out; [`keyless`](Self::keyless) tells whose.
    ///
    /// # Errors
    /// A [`ClipError`]: two tracks for one bone, a number that is not finite, key times that do not
    /// strictly increase, or tangents beyond double precision.
    pub fn new(tracks: Vec<EulerTrack>) -> Result<Self, ClipError> {
        let mut bones = std::collections::BTreeSet::new();
        for (track, EulerTrack { bone, keys }) in tracks.iter().enumerate() {
            if !bones.insert(*bone) {
                let bone = bone.index();
                return Err(ClipError::DuplicateBone { track, bone });
            }
            let mut previous = f64::NEG_INFINITY;
            for (key, &EulerKey { time, angles }) in keys.iter().enumerate() {
                if !time.is_finite() {
                    return Err(ClipError::NonFiniteTime { track, key, time });
                }
                if angles.iter().any(|angle| !angle.is_finite()) {
                    return Err(ClipError::NonFiniteAngle { track, key, angles });
                }
                if time <= previous {
                    return Err(ClipError::NotIncreasing {
                        track,
                        key,
                        time,
                        previous,
                    });
                }
                previous = time;
            }
        }
        let (empty, mut tracks): (Vec<_>, Vec<_>) =
            tracks.into_iter().partition(|track| track.keys.is_empty());
        tracks.sort_by_key(|track| track.bone);
        let between = vec![EulerInterpolation::default(); tracks.len()];
        let keyless = empty.iter().map(|track| track.bone).collect();
        Ok(Self {
            curves: EulerInterpolation::curves(&tracks, &between)?,
            between,
            keyless,
            tracks,
        })
    }

    getters! {
        /// The tracks, sorted by bone; each has at least one key.
        pub fn tracks(&self) -> &[EulerTrack] = &self.tracks;
        /// The bones whose tracks were given without keys and left out.
        pub fn keyless(&self) -> &[BoneId] = &self.keyless;
        /// Whether no bone has keys.
        pub fn is_empty(&self) -> bool = self.tracks.is_empty();
    }

    /// A bone's keys; empty when it has none.
    #[must_use]
    pub fn keys(&self, bone: BoneId) -> &[EulerKey] {
        match self.tracks.binary_search_by_key(&bone, |track| track.bone) {
            Ok(index) => self.tracks.get(index).map_or(&[], |track| &track.keys),
            Err(_) => &[],
        }
    }

    /// The first and last key times in seconds; `None` without keys.
    #[must_use]
    pub fn time_span(&self) -> Option<[f64; 2]> {
        let ends = |track: &EulerTrack| Some([track.keys.first()?.time, track.keys.last()?.time]);
        let ends = self.tracks.iter().filter_map(ends);
        ends.reduce(|[start, end], [s, e]| [start.min(s), end.max(e)])
    }
}

/// A clip as serde writes it: each track with what runs between its keys. One that is read is checked.
#[cfg(feature = "serde")]
type Tracks = Vec<(EulerTrack, EulerInterpolation)>;

#[cfg(feature = "serde")]
impl From<EulerClip> for Tracks {
    fn from(clip: EulerClip) -> Self {
        let keyless = clip.keyless.into_iter().map(|bone| {
            let keys = Vec::new();
            (EulerTrack { bone, keys }, EulerInterpolation::default())
        });
        let keyed = clip.tracks.into_iter().zip(clip.between);
        keyed.chain(keyless).collect()
    }
}

#[cfg(feature = "serde")]
impl TryFrom<Tracks> for EulerClip {
    type Error = ClipError;

    fn try_from(tracks: Tracks) -> Result<Self, ClipError> {
        let (tracks, between): (Vec<_>, Vec<_>) = tracks.into_iter().unzip();
        let by_bone: std::collections::BTreeMap<_, _> =
            tracks.iter().map(|track| track.bone).zip(between).collect();
        let chosen = |track: &EulerTrack| by_bone.get(&track.bone).cloned().unwrap_or_default();
        Self::new(tracks)?.interpolated(chosen)
    }
}
