//! Translation and scale tracks with linear interpolation.

use glam::{Vec3A, Vec4, Vec4Swizzles};

use super::bones::Bones;
use super::timelines::{KeySegment, KeysPassed, Timelines, Track};
use kinopt_kinematics::curve::KeyedCurve;

/// Vector tracks of bones.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Vectors {
    timelines: Timelines,
    bones: Bones,
    keys: Vec<Vec3A>,
}

/// Segments between keys at which a cursor is.
#[derive(Clone, Debug, Default)]
pub(super) struct VectorSegments {
    progress: KeysPassed,
    segments: Vec<VectorSegment>,
}

/// Segment between two keys.
#[derive(Clone, Copy, Debug, Default)]
struct VectorSegment {
    /// Value at the start; w is the start time in seconds.
    start: Vec4,
    /// Change of the value; w is the reciprocal of the duration, 1/s.
    change: Vec4,
}

impl VectorSegment {
    #[inline(always)]
    fn new(segment: &KeySegment, start: Vec3A, end: Vec3A) -> Self {
        Self {
            start: start.extend(segment.start),
            change: (end - start).extend(segment.rate),
        }
    }

    /// Value at a time, which is repeated in all four lanes.
    #[inline(always)]
    fn at(&self, time: Vec4) -> Vec3A {
        let u = (time - self.start.wwww()) * self.change.wwww();
        let u = u.max(Vec4::ZERO).min(Vec4::ONE);
        Vec3A::from_vec4(self.start + self.change * u)
    }
}

impl Vectors {
    pub(super) fn new(tracks: Vec<Track<KeyedCurve<Vec3A>>>) -> Self {
        let (timelines, tracks) = Timelines::arrange(tracks, KeyedCurve::times);
        Self {
            keys: timelines.in_order(|track| tracks[track].curve.values()),
            bones: Bones::new(&tracks),
            timelines,
        }
    }

    pub(super) fn count(&self) -> usize {
        self.bones.list.len()
    }

    /// The tracks as curves.
    pub(super) fn tracks(&self) -> impl Iterator<Item = Track<KeyedCurve<Vec3A>>> + '_ {
        self.bones
            .tracks(&self.timelines, &self.keys, KeyedCurve::linear)
    }

    pub(super) fn start(&self) -> VectorSegments {
        VectorSegments {
            progress: KeysPassed::default(),
            segments: vec![VectorSegment::default(); self.count()],
        }
    }

    pub(super) fn sample(&self, time: f32, cursor: &mut VectorSegments, out: &mut [Vec3A]) {
        let VectorSegments { progress, segments } = cursor;
        self.timelines.follow(time, progress, |entered| {
            let entered_segments = &mut segments[entered.tracks.clone()];
            let (starts, ends) = self.keys[entered.values..].split_at(entered_segments.len());
            for ((segment, &start), &end) in entered_segments.iter_mut().zip(starts).zip(ends) {
                *segment = VectorSegment::new(entered, start, end);
            }
        });
        let time = Vec4::splat(time);
        if self.bones.is_prefix {
            for (segment, value) in segments.iter().zip(out) {
                *value = segment.at(time);
            }
            return;
        }
        for (segment, &bone) in segments.iter().zip(&self.bones.list) {
            out[bone as usize] = segment.at(time);
        }
    }
}
