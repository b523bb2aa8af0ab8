//! Insertion of solved keys into a clip.

use std::ops::Range;

use glam::{Quat, Vec3A};

use super::ClipIkError;
use crate::animation::rotation::RotationCurve;
use crate::animation::{Armature, Channel, Clip, Cursor, Playback, Property};
use crate::curve::KeyedCurve;
use crate::skeleton::BoneId;

/// New values of the bones at the solved sample times.
#[derive(Clone, Debug, Default)]
pub(super) struct NewKeys {
    /// Seconds in the clip.
    pub(super) times: Vec<f32>,
    pub(super) rotations: Vec<(BoneId, Vec<Quat>)>,
    pub(super) translations: Vec<(BoneId, Vec<Vec3A>)>,
}

/// Returns a clip with new keys within the frames of `runs`. The first and last keys of a run equal the clip, except at
/// the ends of the clip.
///
/// Linear channels keep their keys outside the runs. Other channels become linear, with keys at their own times and at
/// all `times` of the frames.
pub(super) fn spliced(
    clip: &Clip,
    armature: &Armature,
    times: &[f32],
    runs: &[Range<usize>],
    new: NewKeys,
) -> Result<Clip, ClipIkError> {
    let mut builder = Clip::builder(clip.name(), armature);
    let channels = clip.channels(armature)?;
    let channel_of = |bone: BoneId, property: Property| {
        let mut channels = channels.iter();
        let entry =
            channels.find(|(other, channel)| *other == bone && channel.property() == property);
        entry.map(|(_, channel)| channel)
    };
    let sampler = ChannelSampler {
        clip,
        armature,
        times,
        runs,
    };
    let mut replaced = Vec::new();
    for (bone, values) in new.rotations {
        let (original_times, is_linear) = match channel_of(bone, Property::Rotation) {
            None => (&[][..], true),
            Some(Channel::Rotation(curve)) => (curve.times(), curve.is_slerp()),
            Some(other) => (other.times(), false),
        };
        let original_keys = sampler.keys(original_times, is_linear, |pose| {
            pose.rotations()[bone.index()]
        })?;
        let (times, values) = merged(original_keys, &new.times, values);
        let curve = RotationCurve::slerp(times, values)?;
        builder.channel(bone, Channel::Rotation(curve))?;
        replaced.push((bone, Property::Rotation));
    }
    for (bone, values) in new.translations {
        let (original_times, is_linear) = match channel_of(bone, Property::Translation) {
            None => (&[][..], true),
            Some(Channel::Translation(curve)) => (curve.times(), curve.is_linear()),
            Some(other) => (other.times(), false),
        };
        let original_keys = sampler.keys(original_times, is_linear, |pose| {
            pose.translations()[bone.index()]
        })?;
        let (times, values) = merged(original_keys, &new.times, values);
        let curve = KeyedCurve::linear(times, values)?;
        builder.channel(bone, Channel::Translation(curve))?;
        replaced.push((bone, Property::Translation));
    }
    for (bone, channel) in channels {
        if !replaced.contains(&(bone, channel.property())) {
            builder.channel(bone, channel)?;
        }
    }
    for (target, curve) in clip.morph_channels(armature)? {
        builder.morph_weight(target, curve)?;
    }
    let [start, end] = clip.span();
    builder.span(start, end)?;
    for event in clip.events() {
        builder.event(event.time, event.name.clone())?;
    }
    Ok(builder.build())
}

/// Inputs for the keys of a channel outside the solved runs.
struct ChannelSampler<'a> {
    clip: &'a Clip,
    armature: &'a Armature,
    times: &'a [f32],
    runs: &'a [Range<usize>],
}

impl ChannelSampler<'_> {
    /// Returns the keys of a channel outside the solved runs.
    fn keys<V>(
        &self,
        key_times: &[f32],
        is_linear: bool,
        value: impl Fn(&crate::animation::Pose) -> V,
    ) -> Result<Vec<(f32, V)>, ClipIkError> {
        let mut times = key_times.to_vec();
        if !is_linear {
            times.extend(self.times);
            times.sort_by(f32::total_cmp);
            times.dedup();
        }
        times.retain(|time| {
            let mut runs = self.runs.iter();
            !runs.any(|run| (self.times[run.start]..=self.times[run.end - 1]).contains(time))
        });
        // A single key is a constant value.
        if key_times.len() < 2 {
            times.clear();
        }
        let mut cursor = Cursor::new();
        let mut pose = self.armature.rest().clone();
        let keys = times.into_iter().map(|time| {
            let seconds = f64::from(time);
            self.clip
                .sample(seconds, Playback::Hold, &mut cursor, &mut pose)?;
            Ok((time, value(&pose)))
        });
        keys.collect()
    }
}

fn merged<V>(original: Vec<(f32, V)>, solved: &[f32], values: Vec<V>) -> (Vec<f32>, Vec<V>) {
    let new = solved.iter().copied().zip(values);
    let mut keys: Vec<(f32, V)> = original.into_iter().chain(new).collect();
    keys.sort_by(|first, second| first.0.total_cmp(&second.0));
    keys.into_iter().unzip()
}
