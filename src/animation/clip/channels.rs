//! Recovery of a clip's channels.

use super::{Channel, Clip};
use crate::animation::rotation::RotationCurve;
use crate::animation::{Armature, SizeMismatch};
use crate::curve::KeyedCurve;
use crate::skeleton::BoneId;

impl Clip {
    /// The channels of the clip, by bone: one for each property that differs from rest at any time. A constant property
    /// has a single key at the start of the clip. A builder that gets these channels and the span builds an equal clip.
    ///
    /// # Errors
    /// The armature is not of the clip's size.
    pub fn channels(&self, armature: &Armature) -> Result<Vec<(BoneId, Channel)>, SizeMismatch> {
        self.check_armature(armature)?;
        let mut channels: Vec<(BoneId, Channel)> = self.tracks.curves().channels().collect();
        let bone = BoneId::new;
        let moving: std::collections::BTreeSet<_> = channels
            .iter()
            .map(|(bone, channel)| (*bone, channel.property()))
            .collect();
        let start_time = || vec![self.span()[0]];
        let (constant, rest) = (&self.constant, armature.rest());
        for index in 0..constant.bones() {
            let (current, at_rest) = (constant.local_of(bone(index)), rest.local_of(bone(index)));
            // Finite values at one finite time always make a curve.
            let translation = KeyedCurve::step(start_time(), vec![current.translation]).ok();
            let rotation = RotationCurve::step(start_time(), vec![current.rotation]).ok();
            let scale = KeyedCurve::step(start_time(), vec![current.scale]).ok();
            let candidates = [
                translation
                    .filter(|_| current.translation != at_rest.translation)
                    .map(Channel::Translation),
                rotation
                    .filter(|_| current.rotation != at_rest.rotation)
                    .map(Channel::Rotation),
                scale
                    .filter(|_| current.scale != at_rest.scale)
                    .map(Channel::Scale),
            ];
            for channel in candidates.into_iter().flatten() {
                if !moving.contains(&(bone(index), channel.property())) {
                    channels.push((bone(index), channel));
                }
            }
        }
        channels.sort_by_key(|(bone, channel)| (*bone, channel.property()));
        Ok(channels)
    }

    /// The channels of morph target weights, by target. Constant weights have a single key, as in
    /// [`channels`](Self::channels).
    ///
    /// # Errors
    /// The armature is not of the clip's size.
    pub fn morph_channels(
        &self,
        armature: &Armature,
    ) -> Result<Vec<(usize, KeyedCurve<f32>)>, SizeMismatch> {
        self.check_armature(armature)?;
        let tracks = self.tracks.curves().morphs.into_iter();
        let mut channels: Vec<(usize, KeyedCurve<f32>)> =
            tracks.map(|track| (track.target, track.curve)).collect();
        let weights = self.constant.morph_weights().iter();
        let constant = weights.zip(armature.rest().morph_weights()).enumerate();
        for (target, (&current, &at_rest)) in constant {
            if current != at_rest && channels.iter().all(|(moving, _)| *moving != target) {
                let curve = KeyedCurve::step(vec![self.span()[0]], vec![current]);
                channels.extend(curve.ok().map(|curve| (target, curve)));
            }
        }
        channels.sort_by_key(|(target, _)| *target);
        Ok(channels)
    }

    /// The clip for an armature with the same bones and another rest pose, such as from [`Armature::at_rest_in`].
    /// Channels and events are unchanged; properties without a channel take the new rest pose.
    ///
    /// # Errors
    /// One of the armatures is not of the clip's size.
    pub fn at_rest_in(&self, armature: &Armature, other: &Armature) -> Result<Self, SizeMismatch> {
        self.rebuilt([armature, other], |channel| channel, |weight| weight)
    }

    /// The clip with other curves, for its own armature or another one of its size.
    pub(in crate::animation) fn rebuilt(
        &self,
        [from, to]: [&Armature; 2],
        map_channel: impl Fn(Channel) -> Channel,
        map_weight: impl Fn(KeyedCurve<f32>) -> KeyedCurve<f32>,
    ) -> Result<Self, SizeMismatch> {
        let (channels, morphs) = (self.channels(from)?, self.morph_channels(from)?);
        self.check_armature(to)?;
        let mut builder = Self::builder(self.name.clone(), to);
        // Bones and targets are those of this clip, each once, so no channel is rejected.
        for (bone, channel) in channels {
            let _ = builder.channel(bone, map_channel(channel));
        }
        for (target, curve) in morphs {
            let _ = builder.morph_weight(target, map_weight(curve));
        }
        let mut rebuilt = builder.build().with_events_of(self);
        // An empty clip stays empty.
        rebuilt.span = self.span;
        Ok(rebuilt)
    }

    /// The clip with the events of another clip.
    pub(in crate::animation) fn with_events_of(mut self, other: &Self) -> Self {
        self.events.clone_from(&other.events);
        self
    }
}
