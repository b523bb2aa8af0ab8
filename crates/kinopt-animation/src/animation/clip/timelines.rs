//! Key times, and the order in which playback passes them.
//!
//! Tracks with common key times share a timeline. The transitions between segments of all timelines are stored in one
//! list, ordered by time. A frame only visits the transitions it passes; a track between its keys costs nothing here.

use std::collections::BTreeMap;
use std::ops::Range;

/// Timelines of all tracks of one kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Timelines {
    timelines: Vec<Timeline>,
    /// Key times of all timelines, concatenated.
    times: Vec<f32>,
    /// Times of all keys that are neither first nor last on their timeline, sorted.
    inner_times: Vec<f32>,
    /// The key at each of these times.
    keys: Vec<TimelineKey>,
}

#[derive(Clone, Debug, PartialEq)]
struct Timeline {
    first: TimelineKey,
    /// Number of keys, at least two.
    keys: usize,
}

/// Key of all tracks of a timeline. The fields are 32 bits wide, to keep the list compact.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TimelineKey {
    /// Index on the timeline.
    key: u32,
    /// Index of the time.
    time: u32,
    /// Index of the values, one for each track; those of the next key follow.
    values: u32,
    /// First track of the timeline; its tracks are consecutive.
    first_track: u32,
    tracks: u32,
}

/// Segment between two adjacent keys, for all tracks of a timeline.
#[derive(Clone, Debug)]
pub(super) struct KeySegment {
    pub(super) tracks: Range<usize>,
    /// Index on the timeline of the key at the start.
    pub(super) key: usize,
    /// Index in [`Timelines::in_order`] of the values at the start, one for each track; those at the end follow.
    pub(super) values: usize,
    /// Start time, seconds.
    pub(super) start: f32,
    /// Reciprocal of the duration, 1/s.
    pub(super) rate: f32,
}

/// Number of key times that a cursor has passed; `None` before its first sample.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct KeysPassed(Option<usize>);

/// Animated property with a curve of at least two keys.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Track<C> {
    /// Index of the bone or morph target.
    pub(super) target: usize,
    pub(super) curve: C,
}

impl TimelineKey {
    /// The key that is `keys` later on the timeline.
    fn advanced(self, keys: usize) -> Self {
        let keys = keys as u32;
        Self {
            key: self.key + keys,
            time: self.time + keys,
            values: self.values + keys * self.tracks,
            ..self
        }
    }

    #[inline]
    fn previous(self) -> Self {
        Self {
            key: self.key - 1,
            time: self.time - 1,
            values: self.values - self.tracks,
            ..self
        }
    }
}

impl Timelines {
    /// Orders tracks such that tracks with common key times are adjacent.
    pub(super) fn arrange<C>(
        mut tracks: Vec<Track<C>>,
        times: impl Fn(&C) -> &[f32],
    ) -> (Self, Vec<Track<C>>) {
        tracks.sort_by_key(|track| track.target);
        let mut order = BTreeMap::new();
        let mut groups: Vec<Vec<Track<C>>> = Vec::new();
        for track in tracks {
            let bits: Vec<u32> = times(&track.curve).iter().map(|t| t.to_bits()).collect();
            let index = *order.entry(bits).or_insert(groups.len());
            if index == groups.len() {
                groups.push(Vec::new());
            }
            groups[index].push(track);
        }
        let mut timelines = Self::default();
        for tracks in &groups {
            timelines.add(times(&tracks[0].curve), tracks.len());
        }
        timelines.sort_inner_keys();
        (timelines, groups.into_iter().flatten().collect())
    }

    fn add(&mut self, times: &[f32], tracks: usize) {
        let after = self
            .timelines
            .last()
            .map(|last| last.first.advanced(last.keys));
        let first = TimelineKey {
            key: 0,
            time: self.times.len() as u32,
            values: after.map_or(0, |key| key.values),
            first_track: after.map_or(0, |key| key.first_track + key.tracks),
            tracks: tracks as u32,
        };
        let keys = times.len();
        self.timelines.push(Timeline { first, keys });
        self.times.extend_from_slice(times);
    }

    fn sort_inner_keys(&mut self) {
        let inner = self.timelines.iter();
        let inner = inner
            .flat_map(|timeline| (1..timeline.keys - 1).map(|key| timeline.first.advanced(key)));
        self.keys = inner.collect();
        let time = |key: &TimelineKey| self.times[key.time as usize];
        self.keys.sort_by(|a, b| time(a).total_cmp(&time(b)));
        self.inner_times = self.keys.iter().map(time).collect();
    }

    /// Advances to `time` and calls `enter` for each segment that begins, or ends in backward playback, on the way. The
    /// last segment entered on each timeline contains `time` or is nearest to it.
    #[inline]
    pub(super) fn follow(
        &self,
        time: f32,
        progress: &mut KeysPassed,
        mut enter: impl FnMut(&KeySegment),
    ) {
        let Some(from) = progress.0.filter(|&from| self.is_near(from, time)) else {
            progress.0 = Some(self.search(time, enter));
            return;
        };
        let forward = self.inner_times[from..].iter();
        let forward = from + forward.take_while(|&&key_time| key_time <= time).count();
        for key in &self.keys[from..forward] {
            enter(&self.segment(*key));
        }
        let current = self.inner_times[..forward].iter().rev();
        let current = forward - current.take_while(|&&key_time| key_time > time).count();
        for key in self.keys[current..forward].iter().rev() {
            enter(&self.segment(key.previous()));
        }
        progress.0 = Some(current);
    }

    /// True if following is cheaper than searching.
    fn is_near(&self, from: usize, time: f32) -> bool {
        let max_steps = 4 * self.timelines.len();
        let is_beyond = self
            .inner_times
            .get(from + max_steps)
            .is_some_and(|&m| m <= time);
        let before = from
            .checked_sub(max_steps + 1)
            .map(|index| self.inner_times[index]);
        !(is_beyond || before.is_some_and(|key_time| key_time > time))
    }

    /// Enters the segment at `time` of each timeline, by binary search.
    #[cold]
    fn search(&self, time: f32, mut enter: impl FnMut(&KeySegment)) -> usize {
        for timeline in &self.timelines {
            let start = timeline.first.time as usize;
            let inner = &self.times[start + 1..start + timeline.keys - 1];
            let key = inner.partition_point(|&key| key <= time);
            enter(&self.segment(timeline.first.advanced(key)));
        }
        self.inner_times
            .partition_point(|&key_time| key_time <= time)
    }

    #[inline]
    fn segment(&self, key: TimelineKey) -> KeySegment {
        let first_track = key.first_track as usize;
        let start = self.times[key.time as usize];
        KeySegment {
            tracks: first_track..first_track + key.tracks as usize,
            key: key.key as usize,
            values: key.values as usize,
            start,
            rate: 1.0 / (self.times[key.time as usize + 1] - start),
        }
    }

    /// Key times and values of each track, extracted from values [in order](Self::in_order).
    pub(super) fn by_track<V: Copy>(&self, values: &[V]) -> Vec<(Vec<f32>, Vec<V>)> {
        let timelines = self.timelines.iter();
        let tracks = timelines.flat_map(|timeline| {
            let key = timeline.first;
            let [time, first, tracks] =
                [key.time, key.values, key.tracks].map(|index| index as usize);
            let times = &self.times[time..time + timeline.keys];
            let timeline_values = &values[first..first + timeline.keys * tracks];
            (0..tracks).map(move |track| {
                let keys = timeline_values.iter().skip(track).step_by(tracks).copied();
                (times.to_vec(), keys.collect())
            })
        });
        tracks.collect()
    }

    /// Orders the keys of [arranged](Self::arrange) tracks as counted by [`KeySegment::values`]: values of one time are
    /// adjacent.
    pub(super) fn in_order<'a, V: Copy + 'a>(&self, keys: impl Fn(usize) -> &'a [V]) -> Vec<V> {
        let timelines = self.timelines.iter();
        let entries = timelines.flat_map(|timeline| {
            let key = timeline.first;
            let tracks = key.first_track..key.first_track + key.tracks;
            (0..timeline.keys).flat_map(move |key| tracks.clone().map(move |track| (track, key)))
        });
        entries
            .map(|(track, key)| keys(track as usize)[key])
            .collect()
    }
}
