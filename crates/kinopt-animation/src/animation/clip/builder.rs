//! Builder of clips: collects channels and compiles them.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::Vec3A;

use super::events::Event;
use super::timelines::Track;
use super::tracks::{Curves, Tracks};
use super::{Channel, Clip, Property};
use crate::animation::rotation::EulerOrder;
use crate::animation::{Armature, ClipError, EulerClip, EulerCurve, Pose};
use kinopt_kinematics::curve::{KeyError, KeyedCurve};
use kinopt_kinematics::skeleton::BoneId;

/// Collects the channels and events of a clip for one armature.
#[derive(Clone, Debug)]
pub struct ClipBuilder<'a> {
    armature: &'a Armature,
    name: String,
    channels: Vec<(BoneId, Channel)>,
    keyed_properties: BTreeSet<(BoneId, Property)>,
    morphs: Vec<(usize, KeyedCurve<f32>)>,
    events: Vec<Event>,
    span: Option<[f32; 2]>,
}

impl<'a> ClipBuilder<'a> {
    pub(super) fn new(name: String, armature: &'a Armature) -> Self {
        Self {
            armature,
            name,
            channels: Vec::new(),
            keyed_properties: BTreeSet::new(),
            morphs: Vec::new(),
            events: Vec::new(),
            span: None,
        }
    }

    /// Adds a channel of a bone.
    ///
    /// # Errors
    /// - The bone belongs to another armature.
    /// - The property has a channel already.
    /// - `before` of an Euler channel is not a unit quaternion.
    pub fn channel(&mut self, bone: BoneId, channel: Channel) -> Result<&mut Self, ClipError> {
        let bones = self.armature.bones();
        let Some(name) = self.armature.names().get(bone.index()) else {
            let bone = bone.index();
            return Err(ClipError::UnknownBone { bone, bones });
        };
        let property = channel.property();
        let name = || name.clone();
        if let Channel::Euler(curve) = &channel {
            if !curve.before.is_normalized() {
                return Err(ClipError::BadRotation { bone: name() });
            }
        }
        if !self.keyed_properties.insert((bone, property)) {
            let bone = name();
            return Err(ClipError::DuplicateChannel { bone, property });
        }
        self.channels.push((bone, channel));
        Ok(self)
    }

    /// Adds the weight of one morph target.
    ///
    /// # Errors
    /// The target does not exist or has a channel already.
    pub fn morph_weight(
        &mut self,
        target: usize,
        weights: KeyedCurve<f32>,
    ) -> Result<&mut Self, ClipError> {
        let names = self.armature.morph_targets();
        let targets = names.len();
        let Some(name) = names.get(target) else {
            return Err(ClipError::UnknownTarget { target, targets });
        };
        if self.morphs.iter().any(|(other, _)| *other == target) {
            let target = name.clone();
            return Err(ClipError::DuplicateTarget { target });
        }
        self.morphs.push((target, weights));
        Ok(self)
    }

    /// Adds the weights of all morph targets with common keys and linear interpolation. The weights are ordered by key,
    /// then by target, as in glTF.
    ///
    /// # Errors
    /// - The number of weights is not keys × targets.
    /// - The keys are invalid.
    /// - A target has a channel already.
    pub fn morph_weights(
        &mut self,
        times: &[f32],
        weights: &[f32],
    ) -> Result<&mut Self, ClipError> {
        let targets = self.armature.morph_targets().len();
        let (given, keys) = (weights.len(), times.len());
        if given != keys * targets {
            return Err(ClipError::WeightCount {
                given,
                keys,
                targets,
            });
        }
        for (target, name) in self.armature.morph_targets().iter().enumerate() {
            let target_weights = weights.iter().skip(target).step_by(targets);
            let curve = KeyedCurve::linear(times.to_vec(), target_weights.copied().collect());
            let curve = curve.map_err(|problem| ClipError::TargetKeys {
                target: name.clone(),
                problem,
            })?;
            self.morph_weight(target, curve)?;
        }
        Ok(self)
    }

    /// Adds the tracks of a rig's keyframes as Euler channels with the interpolation of the clip. The armature must be
    /// made [of the rig's skeleton](Armature::of_skeleton).
    ///
    /// # Errors
    /// - A bone belongs to another armature or has a rotation channel already.
    /// - Two times are equal in single precision.
    pub fn euler_clip(&mut self, clip: &EulerClip) -> Result<&mut Self, ClipError> {
        for track in clip.tracks() {
            let times = track.keys.iter().map(|key| key.time as f32).collect();
            let values = track.keys.iter().map(|key| {
                let [first, bend, second] = key.angles;
                Vec3A::from([second, bend, first].map(|angle| angle as f32))
            });
            let angles = clip
                .interpolation(track.bone)
                .curve(times, values.collect())
                .map_err(|problem| self.keys_of(track.bone, problem))?;
            let curve = EulerCurve {
                order: EulerOrder::Xzx,
                before: self.armature.rest().local_of(track.bone).rotation,
                angles,
            };
            self.channel(track.bone, Channel::Euler(curve))?;
        }
        Ok(self)
    }

    /// Error of the keys of a bone, with the bone's name if it has one.
    fn keys_of(&self, bone: BoneId, problem: KeyError) -> ClipError {
        match self.armature.names().get(bone.index()) {
            Some(bone) => ClipError::BoneKeys {
                bone: bone.clone(),
                problem,
            },
            None => ClipError::Keys(problem),
        }
    }

    /// Adds an event. An event outside the span of the clip never fires.
    ///
    /// # Errors
    /// The time is not finite.
    pub fn event(&mut self, time: f32, name: impl Into<String>) -> Result<&mut Self, ClipError> {
        let name = name.into();
        if !time.is_finite() {
            let event = name;
            return Err(ClipError::EventTime { event, time });
        }
        self.events.push(Event { time, name });
        Ok(self)
    }

    /// Sets the span of the clip in seconds. The default is from the first to the last key.
    ///
    /// # Errors
    /// A time is not finite, or `end` is before `start`.
    pub fn span(&mut self, start: f32, end: f32) -> Result<&mut Self, ClipError> {
        if !(start.is_finite() && end.is_finite() && start <= end) {
            return Err(ClipError::BadSpan { start, end });
        }
        self.span = Some([start, end]);
        Ok(self)
    }

    /// Builds the clip. A clip without channels is the rest pose; its span is empty unless it was set.
    #[must_use]
    pub fn build(self) -> Clip {
        let mut curves = Curves::default();
        let mut constant = self.armature.rest().clone();
        let keyed = keyed_span(&self.channels, &self.morphs);
        for (bone, channel) in self.channels {
            add(bone.index(), channel, &mut curves, &mut constant);
        }
        for (target, curve) in self.morphs {
            match curve.values() {
                [weight] => constant.morph_weights[target] = *weight,
                _ => curves.morphs.push(Track { target, curve }),
            }
        }
        let mut events = self.events;
        events.sort_by(|a, b| a.time.total_cmp(&b.time));
        Clip {
            name: self.name,
            span: Some(self.span.or(keyed).unwrap_or([0.0, 0.0])),
            tracks: Arc::new(Tracks::new(curves)),
            constant,
            events,
        }
    }
}

/// Times of the first and the last key of all channels.
pub(crate) fn keyed_span(
    channels: &[(BoneId, Channel)],
    morphs: &[(usize, KeyedCurve<f32>)],
) -> Option<[f32; 2]> {
    let times = channels.iter().map(|(_, channel)| channel.times());
    let times = times.chain(morphs.iter().map(|(_, curve)| curve.times()));
    let ends = times.filter_map(|times| Some([*times.first()?, *times.last()?]));
    ends.reduce(|[start, end], [s, e]| [start.min(s), end.max(e)])
}

/// Adds a curve, or its value if it has a single key.
fn add(target: usize, channel: Channel, curves: &mut Curves, constant: &mut Pose) {
    match channel {
        Channel::Translation(curve) => match curve.values() {
            [value] => constant.translations[target] = *value,
            _ => curves.translations.push(Track { target, curve }),
        },
        Channel::Scale(curve) => match curve.values() {
            [value] => constant.scales[target] = *value,
            _ => curves.scales.push(Track { target, curve }),
        },
        Channel::Rotation(curve) => match curve.rotations() {
            [value] => constant.rotations[target] = *value,
            _ => curves.rotations.push(Track { target, curve }),
        },
        Channel::Euler(curve) => match curve.angles.values() {
            [value] => constant.rotations[target] = curve.rotation(*value),
            _ => curves.eulers.push(Track { target, curve }),
        },
    }
}
