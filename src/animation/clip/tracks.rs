//! Sampling form of a clip's channels, by kind.

use glam::Vec3A;

use super::Channel;
use super::curved::{CurveSegments, Curved};
use super::rotation_tracks::{SlerpSegments, Slerps};
use super::timelines::Track;
use super::vector_tracks::{VectorSegments, Vectors};
use crate::animation::rotation::RotationCurve;
use crate::animation::{EulerCurve, Pose};
use crate::curve::KeyedCurve;
use crate::skeleton::BoneId;

/// All moving channels of a clip.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tracks {
    translations: Vectors,
    scales: Vectors,
    slerps: Slerps,
    curved_translations: Curved<KeyedCurve<Vec3A>>,
    curved_scales: Curved<KeyedCurve<Vec3A>>,
    curved_rotations: Curved<RotationCurve>,
    eulers: Curved<EulerCurve>,
    morphs: Curved<KeyedCurve<f32>>,
}

/// Segments of all channels at which a cursor is.
#[derive(Clone, Debug, Default)]
pub(super) struct Segments {
    translations: VectorSegments,
    scales: VectorSegments,
    slerps: SlerpSegments,
    curved_translations: CurveSegments,
    curved_scales: CurveSegments,
    curved_rotations: CurveSegments,
    eulers: CurveSegments,
    morphs: CurveSegments,
}

/// Curves with at least two keys, by property.
#[derive(Debug, Default)]
pub(super) struct Curves {
    pub(super) translations: Vec<Track<KeyedCurve<Vec3A>>>,
    pub(super) scales: Vec<Track<KeyedCurve<Vec3A>>>,
    pub(super) rotations: Vec<Track<RotationCurve>>,
    pub(super) eulers: Vec<Track<EulerCurve>>,
    pub(super) morphs: Vec<Track<KeyedCurve<f32>>>,
}

impl Curves {
    /// Channels of bones, by property.
    pub(super) fn channels(self) -> impl Iterator<Item = (BoneId, Channel)> {
        fn channels_of<C>(
            tracks: Vec<Track<C>>,
            channel: fn(C) -> Channel,
        ) -> impl Iterator<Item = (BoneId, Channel)> {
            let tracks = tracks.into_iter();
            tracks.map(move |track| (BoneId::new(track.target), channel(track.curve)))
        }
        channels_of(self.translations, Channel::Translation)
            .chain(channels_of(self.rotations, Channel::Rotation))
            .chain(channels_of(self.eulers, Channel::Euler))
            .chain(channels_of(self.scales, Channel::Scale))
    }
}

impl Tracks {
    pub(super) fn new(curves: Curves) -> Self {
        let is_straight = |track: &Track<KeyedCurve<Vec3A>>| track.curve.is_linear();
        let (translations, curved_translations) =
            curves.translations.into_iter().partition(is_straight);
        let (scales, curved_scales) = curves.scales.into_iter().partition(is_straight);
        let rotations = curves.rotations.into_iter();
        let (slerps, curved_rotations) = rotations.partition(|track| track.curve.is_slerp());
        Self {
            translations: Vectors::new(translations),
            scales: Vectors::new(scales),
            slerps: Slerps::new(slerps),
            curved_translations: Curved::new(curved_translations, KeyedCurve::times),
            curved_scales: Curved::new(curved_scales, KeyedCurve::times),
            curved_rotations: Curved::new(curved_rotations, RotationCurve::times),
            eulers: Curved::new(curves.eulers, |curve| curve.angles.times()),
            morphs: Curved::new(curves.morphs, KeyedCurve::times),
        }
    }

    /// The tracks as curves.
    pub(super) fn curves(&self) -> Curves {
        let vectors = |straight: &Vectors, curved: &Curved<KeyedCurve<Vec3A>>| {
            let curved = curved.tracks().iter().cloned();
            straight.tracks().chain(curved).collect()
        };
        let curved = self.curved_rotations.tracks().iter().cloned();
        Curves {
            translations: vectors(&self.translations, &self.curved_translations),
            scales: vectors(&self.scales, &self.curved_scales),
            rotations: self.slerps.tracks().chain(curved).collect(),
            eulers: self.eulers.tracks().to_vec(),
            morphs: self.morphs.tracks().to_vec(),
        }
    }

    /// Segments of a cursor before its first sample.
    pub(super) fn start(&self) -> Segments {
        Segments {
            translations: self.translations.start(),
            scales: self.scales.start(),
            slerps: self.slerps.start(),
            curved_translations: self.curved_translations.start(),
            curved_scales: self.curved_scales.start(),
            curved_rotations: self.curved_rotations.start(),
            eulers: self.eulers.start(),
            morphs: self.morphs.start(),
        }
    }

    /// Copies the constant values; skips a property if every bone has a track for it.
    pub(super) fn fill_constant(&self, constant: &Pose, pose: &mut Pose) {
        let bones = constant.bones();
        if self.translations.count() + self.curved_translations.count() < bones {
            pose.translations.copy_from_slice(&constant.translations);
        }
        if self.scales.count() + self.curved_scales.count() < bones {
            pose.scales.copy_from_slice(&constant.scales);
        }
        if self.slerps.count() + self.curved_rotations.count() + self.eulers.count() < bones {
            pose.rotations.copy_from_slice(&constant.rotations);
        }
        if self.morphs.count() < constant.morph_weights.len() {
            pose.morph_weights.copy_from_slice(&constant.morph_weights);
        }
    }

    /// Writes every moving property into a pose of the clip's armature.
    pub(super) fn sample(&self, time: f32, segments: &mut Segments, pose: &mut Pose) {
        let (translations, rotations, scales) = (
            &mut pose.translations,
            &mut pose.rotations,
            &mut pose.scales,
        );
        self.translations
            .sample(time, &mut segments.translations, translations);
        self.scales.sample(time, &mut segments.scales, scales);
        self.slerps.sample(time, &mut segments.slerps, rotations);
        let vector = KeyedCurve::within;
        let curved = &self.curved_translations;
        curved.sample(
            time,
            &mut segments.curved_translations,
            translations,
            vector,
        );
        self.curved_scales
            .sample(time, &mut segments.curved_scales, scales, vector);
        let curved = &self.curved_rotations;
        curved.sample(
            time,
            &mut segments.curved_rotations,
            rotations,
            RotationCurve::within,
        );
        let euler = |curve: &EulerCurve, key, u| curve.rotation(curve.angles.within(key, u));
        self.eulers
            .sample(time, &mut segments.eulers, rotations, euler);
        let morphs = &mut pose.morph_weights;
        self.morphs
            .sample(time, &mut segments.morphs, morphs, KeyedCurve::within);
    }
}
