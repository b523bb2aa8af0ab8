//! Key times, each list of them once: a clip whose bones are keyed together has one timeline.

use std::collections::BTreeMap;

/// Which of a clip's timelines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct TimelineId(u32);

impl TimelineId {
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

/// All timelines of a clip, end to end. Each has at least two keys.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Timelines {
    times: Vec<f32>,
    /// 1 / (t_{i+1} − t_i); 0 at the end of a timeline.
    rates: Vec<f32>,
    spans: Vec<std::ops::Range<usize>>,
}

/// Where a time is on a timeline.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Place {
    /// The last key that is not after the time, but never the last of all.
    pub(super) key: u32,
    /// How far on to the next one, in [0, 1].
    pub(super) u: f32,
}

/// Collects timelines and finds those that are there already.
#[derive(Debug, Default)]
pub(super) struct TimelineSet {
    timelines: Timelines,
    known: BTreeMap<Vec<u32>, TimelineId>,
}

impl TimelineSet {
    /// The timeline of these times: strictly increasing, at least two.
    pub(super) fn add(&mut self, times: &[f32]) -> TimelineId {
        let bits: Vec<u32> = times.iter().map(|time| time.to_bits()).collect();
        let timelines = &mut self.timelines;
        *self.known.entry(bits).or_insert_with(|| {
            let start = timelines.times.len();
            timelines.times.extend_from_slice(times);
            let steps = times.windows(2).map(|pair| 1.0 / (pair[1] - pair[0]));
            timelines.rates.extend(steps.chain([0.0]));
            timelines.spans.push(start..start + times.len());
            TimelineId(timelines.spans.len() as u32 - 1)
        })
    }

    pub(super) fn finish(self) -> Timelines {
        self.timelines
    }
}

/// How many keys a cursor walks before it searches.
const STEPS: usize = 4;

impl Timelines {
    pub(super) fn count(&self) -> usize {
        self.spans.len()
    }

    /// Where `time` is on every timeline; `places` also says where to start looking.
    pub(super) fn locate(&self, time: f32, places: &mut [Place]) {
        for (span, place) in self.spans.iter().zip(places) {
            let times = &self.times[span.clone()];
            let rates = &self.rates[span.clone()];
            let key = nearby(times, place.key as usize, time);
            let u = (time - times[key]) * rates[key];
            *place = Place {
                key: key as u32,
                // Not `clamp`, which would keep a NaN.
                u: if u > 0.0 { u.min(1.0) } else { 0.0 },
            };
        }
    }
}

/// The segment that a time is in, looking near `hint` first: playback moves on by a key or none.
#[inline]
fn nearby(times: &[f32], hint: usize, time: f32) -> usize {
    let last = times.len() - 2;
    let mut key = hint.min(last);
    for _ in 0..STEPS {
        if time < times[key] {
            match key.checked_sub(1) {
                Some(before) => key = before,
                None => return 0,
            }
        } else if key < last && time >= times[key + 1] {
            key += 1;
        } else {
            return key;
        }
    }
    let after = times.partition_point(|&key| key <= time);
    after.saturating_sub(1).min(last)
}
