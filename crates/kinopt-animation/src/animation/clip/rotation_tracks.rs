//! Rotation tracks with constant angular speed between keys.

use glam::{Quat, Vec4};

use super::bones::Bones;
use super::slerp_arcs::{Arc, weights};
use super::timelines::{KeySegment, KeysPassed, Timelines, Track};
use crate::animation::rotation::RotationCurve;

/// Number of tracks sampled at once.
const WIDTH: usize = 4;

/// Rotation tracks of bones.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Slerps {
    timelines: Timelines,
    bones: Bones,
    keys: Vec<Quat>,
    /// Arc from each key to the next of the track; unused at the last key.
    arcs: Vec<Arc>,
}

/// Segments between keys at which a cursor is.
#[derive(Clone, Debug, Default)]
pub(super) struct SlerpSegments {
    progress: KeysPassed,
    groups: Vec<ArcGroup>,
}

/// Arcs between two keys for a group of tracks.
#[derive(Clone, Copy, Debug, Default)]
struct ArcGroup {
    /// Start times, seconds.
    start: [f32; WIDTH],
    /// Reciprocal durations, 1/s.
    rate: [f32; WIDTH],
    squared: [f32; WIDTH],
    ratio: [f32; WIDTH],
    from: [Quat; WIDTH],
    to: [Quat; WIDTH],
}

impl ArcGroup {
    #[inline(always)]
    fn enter(&mut self, lane: usize, segment: &KeySegment, from: Quat, to: Quat, arc: Arc) {
        self.start[lane] = segment.start;
        self.rate[lane] = segment.rate;
        self.squared[lane] = arc.squared;
        self.ratio[lane] = arc.ratio;
        self.from[lane] = from;
        self.to[lane] = to;
    }

    /// Rotations at a time, which is repeated in all four lanes.
    #[inline(always)]
    fn at(&self, time: Vec4) -> [Quat; WIDTH] {
        let [start, rate] = [self.start, self.rate].map(Vec4::from_array);
        let [squared, ratio] = [self.squared, self.ratio].map(Vec4::from_array);
        let u = (time - start) * rate;
        let u = u.max(Vec4::ZERO).min(Vec4::ONE);
        let from = weights(Vec4::ONE - u, squared, ratio).to_array();
        let to = weights(u, squared, ratio).to_array();
        std::array::from_fn(|lane| {
            let [start, end] = [self.from[lane], self.to[lane]].map(Vec4::from);
            Quat::from_vec4(start * from[lane] + end * to[lane])
        })
    }
}

impl Slerps {
    pub(super) fn new(tracks: Vec<Track<RotationCurve>>) -> Self {
        let (timelines, tracks) = Timelines::arrange(tracks, RotationCurve::times);
        let arcs: Vec<Vec<Arc>> = tracks.iter().map(|track| arcs(&track.curve)).collect();
        Self {
            bones: Bones::new(&tracks),
            keys: timelines.in_order(|track| tracks[track].curve.rotations()),
            arcs: timelines.in_order(|track| &arcs[track]),
            timelines,
        }
    }

    pub(super) fn count(&self) -> usize {
        self.bones.list.len()
    }

    /// The tracks as curves.
    pub(super) fn tracks(&self) -> impl Iterator<Item = Track<RotationCurve>> + '_ {
        self.bones
            .tracks(&self.timelines, &self.keys, RotationCurve::slerp)
    }

    pub(super) fn start(&self) -> SlerpSegments {
        SlerpSegments {
            progress: KeysPassed::default(),
            groups: vec![ArcGroup::default(); self.bones.list.len().div_ceil(WIDTH)],
        }
    }

    pub(super) fn sample(&self, time: f32, cursor: &mut SlerpSegments, out: &mut [Quat]) {
        let SlerpSegments { progress, groups } = cursor;
        self.timelines.follow(time, progress, |entered| {
            let tracks = entered.tracks.clone();
            let arcs = &self.arcs[entered.values..];
            let (from, to) = self.keys[entered.values..].split_at(tracks.len());
            for (((track, &from), &to), &arc) in tracks.zip(from).zip(to).zip(arcs) {
                groups[track / WIDTH].enter(track % WIDTH, entered, from, to, arc);
            }
        });
        let time = Vec4::splat(time);
        let in_place = match self.bones.is_prefix {
            true => self.count() / WIDTH,
            false => 0,
        };
        let chunks = out.chunks_exact_mut(WIDTH).take(in_place);
        for (group, rotations) in groups.iter().zip(chunks) {
            rotations.copy_from_slice(&group.at(time));
        }
        let bones = self.bones.list.chunks(WIDTH);
        for (group, bones) in groups.iter().zip(bones).skip(in_place) {
            for (&bone, rotation) in bones.iter().zip(group.at(time)) {
                out[bone as usize] = rotation;
            }
        }
    }
}

/// Arcs from each key to the next; a placeholder at the last key.
fn arcs(curve: &RotationCurve) -> Vec<Arc> {
    let keys = curve.rotations();
    let ends = keys.iter().skip(1).chain(keys.last());
    let pairs = keys.iter().zip(ends);
    pairs.map(|(&from, &to)| Arc::between(from, to)).collect()
}
