//! Which bones a kind's tracks move.

use super::timelines::{Timelines, Track};
use crate::animation::curve::KeyError;

/// The bone of each track.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Bones {
    pub(super) list: Vec<u32>,
    /// Whether they are the first bones in their order: no need to look them up.
    pub(super) are_first: bool,
}

impl Bones {
    pub(super) fn of<C>(tracks: &[Track<C>]) -> Self {
        Self {
            list: tracks.iter().map(|track| track.target as u32).collect(),
            are_first: (0..).zip(tracks).all(|(k, track)| track.target == k),
        }
    }

    /// The tracks again, each by what makes a curve of its times and keys.
    pub(super) fn tracks<V: Copy, C>(
        &self,
        timelines: &Timelines,
        keys: &[V],
        curve: impl Fn(Vec<f32>, Vec<V>) -> Result<C, KeyError>,
    ) -> impl Iterator<Item = Track<C>> {
        let bones = self.list.iter().zip(timelines.by_track(keys));
        bones.filter_map(move |(&bone, (times, keys))| {
            // They passed the same check before.
            let curve = curve(times, keys).ok()?;
            let target = bone as usize;
            Some(Track { target, curve })
        })
    }
}
