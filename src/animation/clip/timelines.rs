//! Key times, and the order in which playback comes to them.
//!
//! Tracks keyed together share a timeline. Where playback leaves one segment between keys for the
//! next is written down once for all timelines, in order of time, so that a frame looks only at what
//! changes in it: the cost of a track that stays between its keys is nothing here.

use std::collections::BTreeMap;
use std::ops::Range;

/// The timelines of all tracks of one kind.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Timelines {
    timelines: Vec<Timeline>,
    /// The key times of all timelines, end to end.
    times: Vec<f32>,
    /// When playback comes to a key that is neither first nor last on its timeline, in order.
    moments: Vec<f32>,
    /// Which key that is.
    keys: Vec<TimelineKey>,
}

#[derive(Clone, Debug, PartialEq)]
struct Timeline {
    first: TimelineKey,
    /// At least two.
    keys: usize,
}

/// A key time of all tracks of a timeline. Its numbers are narrow, as there is one for each time.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TimelineKey {
    /// Counted on its timeline.
    key: u32,
    /// Where its time is.
    time: u32,
    /// Where its values are, one for each track, and those of the next key after them.
    values: u32,
    /// The timeline's tracks, which follow one another.
    first_track: u32,
    tracks: u32,
}

/// The way from a key to the next, for all tracks of a timeline.
#[derive(Clone, Debug)]
pub(super) struct Segment {
    pub(super) tracks: Range<usize>,
    /// The key it starts at, counted on its timeline.
    pub(super) key: usize,
    /// Where the values at its start are in [`Timelines::in_order`], one for each track; those at
    /// its end follow them.
    pub(super) values: usize,
    /// When it starts, in seconds.
    pub(super) start: f32,
    /// One over how long it lasts.
    pub(super) rate: f32,
}

/// How many moments a cursor has passed; `None` before its first look.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Progress(Option<usize>);

/// Something that moves along a curve with at least two keys.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Track<C> {
    /// The bone's index, or the morph target's.
    pub(super) target: usize,
    pub(super) curve: C,
}

impl TimelineKey {
    /// The timeline's key so many after this one.
    fn on(self, keys: usize) -> Self {
        let keys = keys as u32;
        Self {
            key: self.key + keys,
            time: self.time + keys,
            values: self.values + keys * self.tracks,
            ..self
        }
    }

    #[inline]
    fn before(self) -> Self {
        Self {
            key: self.key - 1,
            time: self.time - 1,
            values: self.values - self.tracks,
            ..self
        }
    }
}

impl Timelines {
    /// Puts tracks that share their key times next to one another.
    pub(super) fn arrange<C>(
        mut tracks: Vec<Track<C>>,
        times: impl Fn(&C) -> &[f32],
    ) -> (Self, Vec<Track<C>>) {
        tracks.sort_by_key(|track| track.target);
        let mut order = BTreeMap::new();
        let mut together: Vec<Vec<Track<C>>> = Vec::new();
        for track in tracks {
            let bits: Vec<u32> = times(&track.curve).iter().map(|t| t.to_bits()).collect();
            let place = *order.entry(bits).or_insert(together.len());
            if place == together.len() {
                together.push(Vec::new());
            }
            together[place].push(track);
        }
        let mut timelines = Self::default();
        for tracks in &together {
            timelines.add(times(&tracks[0].curve), tracks.len());
        }
        timelines.sort_moments();
        (timelines, together.into_iter().flatten().collect())
    }

    fn add(&mut self, times: &[f32], tracks: usize) {
        let after = self.timelines.last().map(|last| last.first.on(last.keys));
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

    fn sort_moments(&mut self) {
        let inner = self.timelines.iter();
        let inner = inner.flat_map(|line| (1..line.keys - 1).map(|key| line.first.on(key)));
        self.keys = inner.collect();
        let time = |key: &TimelineKey| self.times[key.time as usize];
        self.keys.sort_by(|a, b| time(a).total_cmp(&time(b)));
        self.moments = self.keys.iter().map(time).collect();
    }

    /// Goes on to `time` and enters, in turn, the segments that begin (or, backwards, end) on the
    /// way. The last one entered of each timeline is the one that `time` is in, or the nearest.
    #[inline]
    pub(super) fn follow(
        &self,
        time: f32,
        progress: &mut Progress,
        mut enter: impl FnMut(&Segment),
    ) {
        let Some(from) = progress.0.filter(|&from| self.is_near(from, time)) else {
            progress.0 = Some(self.search(time, enter));
            return;
        };
        let on = self.moments[from..].iter();
        let on = from + on.take_while(|&&moment| moment <= time).count();
        for key in &self.keys[from..on] {
            enter(&self.segment(*key));
        }
        let back = self.moments[..on].iter().rev();
        let back = on - back.take_while(|&&moment| moment > time).count();
        for key in self.keys[back..on].iter().rev() {
            enter(&self.segment(key.before()));
        }
        progress.0 = Some(back);
    }

    /// Whether following is cheaper than searching.
    fn is_near(&self, from: usize, time: f32) -> bool {
        let few = 4 * self.timelines.len();
        let is_beyond = self.moments.get(from + few).is_some_and(|&m| m <= time);
        let before = from.checked_sub(few + 1).map(|at| self.moments[at]);
        !(is_beyond || before.is_some_and(|moment| moment > time))
    }

    /// Enters the segment of each timeline, wherever it is.
    #[cold]
    fn search(&self, time: f32, mut enter: impl FnMut(&Segment)) -> usize {
        for timeline in &self.timelines {
            let start = timeline.first.time as usize;
            let inner = &self.times[start + 1..start + timeline.keys - 1];
            let key = inner.partition_point(|&key| key <= time);
            enter(&self.segment(timeline.first.on(key)));
        }
        self.moments.partition_point(|&moment| moment <= time)
    }

    #[inline]
    fn segment(&self, key: TimelineKey) -> Segment {
        let first_track = key.first_track as usize;
        let start = self.times[key.time as usize];
        Segment {
            tracks: first_track..first_track + key.tracks as usize,
            key: key.key as usize,
            values: key.values as usize,
            start,
            rate: 1.0 / (self.times[key.time as usize + 1] - start),
        }
    }

    /// The key times of each track, and out of values [in order](Self::in_order) its own.
    pub(super) fn by_track<V: Copy>(&self, values: &[V]) -> Vec<(Vec<f32>, Vec<V>)> {
        let timelines = self.timelines.iter();
        let tracks = timelines.flat_map(|timeline| {
            let key = timeline.first;
            let [time, first, tracks] = [key.time, key.values, key.tracks].map(|at| at as usize);
            let times = &self.times[time..time + timeline.keys];
            let own = &values[first..first + timeline.keys * tracks];
            (0..tracks).map(move |track| {
                let keys = own.iter().skip(track).step_by(tracks).copied();
                (times.to_vec(), keys.collect())
            })
        });
        tracks.collect()
    }

    /// Puts the keys of tracks that were [arranged](Self::arrange) in the order that
    /// [`Segment::values`] counts in: those of one moment side by side.
    pub(super) fn in_order<'a, V: Copy + 'a>(&self, keys: impl Fn(usize) -> &'a [V]) -> Vec<V> {
        let timelines = self.timelines.iter();
        let places = timelines.flat_map(|timeline| {
            let key = timeline.first;
            let tracks = key.first_track..key.first_track + key.tracks;
            (0..timeline.keys).flat_map(move |key| tracks.clone().map(move |track| (track, key)))
        });
        places
            .map(|(track, key)| keys(track as usize)[key])
            .collect()
    }
}
