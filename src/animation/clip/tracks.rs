//! A clip's channels as they are sampled: the common kinds packed key by key, the others as curves.

use glam::{Quat, Vec3A, Vec4};

use super::arcs::{Arc, WIDTH, weights};
use super::timeline::{Place, TimelineId};
use crate::animation::curve::{KeyedCurve, lerp};
use crate::animation::rotation::RotationCurve;
use crate::animation::{EulerCurve, Pose};

/// All moving channels of a clip.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tracks {
    pub(super) translations: Vectors,
    pub(super) scales: Vectors,
    pub(super) slerps: Slerps,
    pub(super) rotations: Vec<Curved<RotationCurve>>,
    pub(super) eulers: Vec<Curved<EulerCurve>>,
    pub(super) morphs: Vec<Curved<KeyedCurve<f32>>>,
}

/// Which bone a packed track moves, where its keys start, and when they are.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Packed {
    bone: u32,
    timeline: TimelineId,
    first: u32,
}

/// A curve of a bone or a morph target.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curved<C> {
    target: usize,
    timeline: TimelineId,
    curve: C,
}

impl<C> Curved<C> {
    pub(super) fn new(target: usize, timeline: TimelineId, curve: C) -> Self {
        Self {
            target,
            timeline,
            curve,
        }
    }
}

/// Translations or scales.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Vectors {
    linear: Vec<Packed>,
    keys: Vec<Vec3A>,
    curved: Vec<Curved<KeyedCurve<Vec3A>>>,
}

/// Rotations at constant speed from key to key.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Slerps {
    /// A last group that is not full repeats its last track: cheaper than one by one.
    groups: Vec<[Packed; WIDTH]>,
    count: usize,
    keys: Vec<Quat>,
    /// From each key to the next; meaningless after a track's last.
    arcs: Vec<Arc>,
}

impl Packed {
    /// Where the track's key is, and how far on to the next.
    #[inline(always)]
    fn at(&self, places: &[Place]) -> (usize, f32) {
        let place = places[self.timeline.index()];
        ((self.first + place.key) as usize, place.u)
    }
}

impl Vectors {
    fn count(&self) -> usize {
        self.linear.len() + self.curved.len()
    }

    pub(super) fn add(&mut self, bone: usize, timeline: TimelineId, curve: KeyedCurve<Vec3A>) {
        if !curve.is_linear() {
            self.curved.push(Curved::new(bone, timeline, curve));
            return;
        }
        self.linear.push(Packed {
            bone: bone as u32,
            timeline,
            first: self.keys.len() as u32,
        });
        self.keys.extend_from_slice(curve.values());
    }

    fn sample(&self, places: &[Place], out: &mut [Vec3A]) {
        for track in &self.linear {
            let (key, u) = track.at(places);
            if let [from, to] = self.keys[key..key + 2] {
                out[track.bone as usize] = lerp(from, to, u);
            }
        }
        for track in &self.curved {
            let place = places[track.timeline.index()];
            out[track.target] = track.curve.within(place.key as usize, place.u);
        }
    }
}

impl Slerps {
    pub(super) fn add(&mut self, bone: usize, timeline: TimelineId, keys: &[Quat]) {
        let track = Packed {
            bone: bone as u32,
            timeline,
            first: self.keys.len() as u32,
        };
        match (self.count % WIDTH, self.groups.last_mut()) {
            (filled @ 1.., Some(group)) => group.iter_mut().skip(filled).for_each(|t| *t = track),
            _ => self.groups.push([track; WIDTH]),
        }
        self.count += 1;
        self.keys.extend_from_slice(keys);
        let arcs = keys.iter().zip(keys.iter().skip(1).chain(keys.last()));
        self.arcs
            .extend(arcs.map(|(&from, &to)| Arc::between(from, to)));
    }

    fn sample(&self, places: &[Place], out: &mut [Quat]) {
        for group in &self.groups {
            self.sample_group(group, places, out);
        }
    }

    #[inline(always)]
    fn sample_group(&self, group: &[Packed; WIDTH], places: &[Place], out: &mut [Quat]) {
        let at = group.each_ref().map(|track| track.at(places));
        let arcs = at.map(|(key, _)| self.arcs[key]);
        let to = weights(&at.map(|(_, u)| u), &arcs);
        let from = weights(&at.map(|(_, u)| 1.0 - u), &arcs);
        for lane in 0..WIDTH {
            let key = at[lane].0;
            if let [start, end] = self.keys[key..key + 2] {
                let sum = Vec4::from(start) * from[lane] + Vec4::from(end) * to[lane];
                out[group[lane].bone as usize] = Quat::from_vec4(sum);
            }
        }
    }
}

impl Tracks {
    /// Copies what the tracks do not write: nothing of a property that every bone has a track for.
    pub(super) fn fill_constant(&self, constant: &Pose, pose: &mut Pose) {
        let bones = constant.bones();
        if self.translations.count() < bones {
            pose.translations.copy_from_slice(&constant.translations);
        }
        if self.scales.count() < bones {
            pose.scales.copy_from_slice(&constant.scales);
        }
        if self.slerps.count + self.rotations.len() + self.eulers.len() < bones {
            pose.rotations.copy_from_slice(&constant.rotations);
        }
        if self.morphs.len() < constant.morph_weights.len() {
            pose.morph_weights.copy_from_slice(&constant.morph_weights);
        }
    }

    /// Writes every moving property into a pose of the clip's armature.
    pub(super) fn sample(&self, places: &[Place], pose: &mut Pose) {
        self.translations.sample(places, &mut pose.translations);
        self.scales.sample(places, &mut pose.scales);
        self.slerps.sample(places, &mut pose.rotations);
        for track in &self.rotations {
            let place = places[track.timeline.index()];
            pose.rotations[track.target] = track.curve.within(place.key as usize, place.u);
        }
        for track in &self.eulers {
            let place = places[track.timeline.index()];
            let angles = track.curve.angles.within(place.key as usize, place.u);
            pose.rotations[track.target] = track.curve.rotation(angles);
        }
        for track in &self.morphs {
            let place = places[track.timeline.index()];
            pose.morph_weights[track.target] = track.curve.within(place.key as usize, place.u);
        }
    }
}
