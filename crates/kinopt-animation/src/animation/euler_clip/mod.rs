//! Keyframes of bone angles.

mod interpolation;
mod sampling;

pub use interpolation::EulerInterpolation;

use glam::DVec3;

use crate::animation::ClipError;
use kinopt_kinematics::curve::KeyedCurve;
use kinopt_kinematics::skeleton::BoneId;

/// Angles of one bone at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EulerKey {
    /// Time, seconds.
    pub time: f64,
    /// Angles (θ₁, θ₂, θ₃) in radians: first twist, bend, second twist. They may be outside the bone's limits.
    pub angles: [f64; 3],
}

/// Keys of one bone, strictly increasing in time.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct EulerTrack {
    /// The animated bone.
    pub bone: BoneId,
    /// The keys; their times need not be evenly spaced.
    pub keys: Vec<EulerKey>,
}

/// Keyframes of a skeleton's bones; a bone without keys has no track.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(
    feature = "serde",
    serde(try_from = "EulerClipDocument", into = "EulerClipDocument")
)]
pub struct EulerClip {
    tracks: Vec<EulerTrack>,
    /// Interpolation of each track.
    interpolations: Vec<EulerInterpolation>,
    /// Sampled curve of each track.
    curves: Vec<KeyedCurve<DVec3>>,
    /// Bones whose tracks had no keys.
    keyless: Vec<BoneId>,
}

impl EulerClip {
    /// Clip of tracks in any order, with Catmull-Rom splines. Tracks without keys are omitted;
    /// [`keyless`](Self::keyless) returns their bones.
    ///
    /// # Errors
    /// A [`ClipError`]: two tracks for one bone, a number that is not finite, key times that do not strictly increase,
    /// or tangents beyond double precision.
    pub fn new(tracks: Vec<EulerTrack>) -> Result<Self, ClipError> {
        let mut bones = std::collections::BTreeSet::new();
        for (track, EulerTrack { bone, keys }) in tracks.iter().enumerate() {
            if !bones.insert(*bone) {
                let bone = bone.index();
                return Err(ClipError::DuplicateTrack { track, bone });
            }
            let mut previous = f64::NEG_INFINITY;
            for (key, &EulerKey { time, angles }) in keys.iter().enumerate() {
                if !time.is_finite() {
                    return Err(ClipError::NonFiniteKeyTime { track, key, time });
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
        let interpolations = vec![EulerInterpolation::default(); tracks.len()];
        let keyless = empty.iter().map(|track| track.bone).collect();
        Ok(Self {
            curves: EulerInterpolation::curves(&tracks, &interpolations)?,
            interpolations,
            keyless,
            tracks,
        })
    }

    /// Tracks sorted by bone, each with at least one key.
    #[must_use]
    pub fn tracks(&self) -> &[EulerTrack] {
        &self.tracks
    }

    /// Bones whose tracks had no keys and were omitted.
    #[must_use]
    pub fn keyless(&self) -> &[BoneId] {
        &self.keyless
    }

    /// Returns true if no bone has keys.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tracks.is_empty()
    }

    /// Keys of a bone; empty if it has none.
    #[must_use]
    pub fn keys(&self, bone: BoneId) -> &[EulerKey] {
        match self.tracks.binary_search_by_key(&bone, |track| track.bone) {
            Ok(index) => self.tracks.get(index).map_or(&[], |track| &track.keys),
            Err(_) => &[],
        }
    }

    /// First and last key time in seconds; `None` without keys.
    #[must_use]
    pub fn time_span(&self) -> Option<[f64; 2]> {
        let ends = |track: &EulerTrack| Some([track.keys.first()?.time, track.keys.last()?.time]);
        let ends = self.tracks.iter().filter_map(ends);
        ends.reduce(|[start, end], [s, e]| [start.min(s), end.max(e)])
    }
}

/// Serde form of a clip: each track with its interpolation. It is checked when read.
#[cfg(feature = "serde")]
type EulerClipDocument = Vec<(EulerTrack, EulerInterpolation)>;

#[cfg(feature = "serde")]
impl From<EulerClip> for EulerClipDocument {
    fn from(clip: EulerClip) -> Self {
        let keyless = clip.keyless.into_iter().map(|bone| {
            let keys = Vec::new();
            (EulerTrack { bone, keys }, EulerInterpolation::default())
        });
        let keyed = clip.tracks.into_iter().zip(clip.interpolations);
        keyed.chain(keyless).collect()
    }
}

#[cfg(feature = "serde")]
impl TryFrom<EulerClipDocument> for EulerClip {
    type Error = ClipError;

    fn try_from(tracks: EulerClipDocument) -> Result<Self, ClipError> {
        let (tracks, interpolations): (Vec<_>, Vec<_>) = tracks.into_iter().unzip();
        let by_bone: std::collections::BTreeMap<_, _> = tracks
            .iter()
            .map(|track| track.bone)
            .zip(interpolations)
            .collect();
        let chosen = |track: &EulerTrack| by_bone.get(&track.bone).cloned().unwrap_or_default();
        Self::new(tracks)?.interpolated(chosen)
    }
}
