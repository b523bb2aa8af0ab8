//! Bones moved by the tracks of one property.

use super::timelines::{Timelines, Track};
use crate::curve::KeyError;

/// Bone of each track.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Bones {
    pub(super) list: Vec<u32>,
    /// The bones are the first of the armature, in order; no lookup is needed.
    pub(super) is_prefix: bool,
}

impl Bones {
    pub(super) fn new<C>(tracks: &[Track<C>]) -> Self {
        Self {
            list: tracks.iter().map(|track| track.target as u32).collect(),
            is_prefix: (0..).zip(tracks).all(|(k, track)| track.target == k),
        }
    }

    /// The tracks, with a curve built from times and keys by `curve`.
    pub(super) fn tracks<V: Copy, C>(
        &self,
        timelines: &Timelines,
        keys: &[V],
        curve: impl Fn(Vec<f32>, Vec<V>) -> Result<C, KeyError>,
    ) -> impl Iterator<Item = Track<C>> {
        let bones = self.list.iter().zip(timelines.by_track(keys));
        bones.filter_map(move |(&bone, (times, keys))| {
            // The keys passed this check when the clip was built.
            let curve = curve(times, keys).ok()?;
            let target = bone as usize;
            Some(Track { target, curve })
        })
    }
}
