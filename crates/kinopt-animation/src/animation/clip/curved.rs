//! Curves sampled one by one: steps, cubics, Euler angles and morph weights.

use super::timelines::{KeysPassed, Timelines, Track};

/// Curves of one type.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curved<C> {
    timelines: Timelines,
    tracks: Vec<Track<C>>,
}

/// Segments between keys at which a cursor is.
#[derive(Clone, Debug, Default)]
pub(super) struct CurveSegments {
    progress: KeysPassed,
    segments: Vec<CurveSegment>,
}

#[derive(Clone, Copy, Debug, Default)]
struct CurveSegment {
    key: usize,
    /// Start time, seconds.
    start: f32,
    /// Reciprocal of the duration, 1/s.
    rate: f32,
}

impl<C> Default for Curved<C> {
    fn default() -> Self {
        Self {
            timelines: Timelines::default(),
            tracks: Vec::new(),
        }
    }
}

impl<C> Curved<C> {
    pub(super) fn new(tracks: Vec<Track<C>>, times: impl Fn(&C) -> &[f32]) -> Self {
        let (timelines, tracks) = Timelines::arrange(tracks, times);
        Self { timelines, tracks }
    }

    #[must_use]
    pub(super) fn count(&self) -> usize {
        self.tracks.len()
    }

    #[must_use]
    pub(super) fn tracks(&self) -> &[Track<C>] {
        &self.tracks
    }

    pub(super) fn start(&self) -> CurveSegments {
        CurveSegments {
            progress: KeysPassed::default(),
            segments: vec![CurveSegment::default(); self.count()],
        }
    }

    /// Writes `value` of each curve at a key and u in [0, 1] towards the next key.
    pub(super) fn sample<V>(
        &self,
        time: f32,
        cursor: &mut CurveSegments,
        out: &mut [V],
        value: impl Fn(&C, usize, f32) -> V,
    ) {
        let CurveSegments { progress, segments } = cursor;
        self.timelines.follow(time, progress, |entered| {
            segments[entered.tracks.clone()].fill(CurveSegment {
                key: entered.key,
                start: entered.start,
                rate: entered.rate,
            });
        });
        for (track, segment) in self.tracks.iter().zip(segments) {
            let u = (time - segment.start) * segment.rate;
            // `clamp` would keep the NaN of a segment whose reciprocal duration overflows.
            let u = if u > 0.0 { u.min(1.0) } else { 0.0 };
            out[track.target] = value(&track.curve, segment.key, u);
        }
    }
}
