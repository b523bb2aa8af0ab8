//! Serde form of a clip: curves of moving properties and values of constant ones. Reading rebuilds the clip.

use serde::{Deserialize, Serialize};

use super::{Channel, Clip, Event};
use crate::animation::{Armature, ArmatureBone, ClipError, Pose};
use kinopt_kinematics::curve::KeyedCurve;
use kinopt_kinematics::skeleton::BoneId;

#[derive(Serialize, Deserialize)]
pub(super) struct KeyframeClipDocument {
    name: String,
    span: Option<[f32; 2]>,
    channels: Vec<(BoneId, Channel)>,
    /// Morph target and its curve.
    morphs: Vec<(usize, KeyedCurve<f32>)>,
    constant: Pose,
    events: Vec<Event>,
}

impl From<Clip> for KeyframeClipDocument {
    fn from(clip: Clip) -> Self {
        let mut curves = clip.tracks.curves();
        let morphs = std::mem::take(&mut curves.morphs).into_iter();
        Self {
            name: clip.name,
            span: clip.span,
            channels: curves.channels().collect(),
            morphs: morphs.map(|track| (track.target, track.curve)).collect(),
            constant: clip.constant,
            events: clip.events,
        }
    }
}

impl TryFrom<KeyframeClipDocument> for Clip {
    type Error = ClipError;

    fn try_from(parts: KeyframeClipDocument) -> Result<Self, ClipError> {
        // An armature whose rest pose is the constant part; clips do not store bone names.
        let constant = &parts.constant;
        let bones = (0..constant.bones()).map(|index| ArmatureBone {
            name: index.to_string(),
            parent: None,
            rest: constant.local_of(BoneId::new(index)),
        });
        let targets = (0..constant.morph_weights().len()).map(|index| index.to_string());
        let armature = Armature::new(bones.collect(), targets.collect())?
            .with_rest_morph_weights(constant.morph_weights())
            .map_err(|_| ClipError::TooManyBones { given: 0, most: 0 })?;
        let mut builder = Self::builder(parts.name, &armature);
        let [start, end] = parts.span.unwrap_or_default();
        builder.span(start, end)?;
        for (bone, channel) in parts.channels {
            builder.channel(bone, channel)?;
        }
        for (target, curve) in parts.morphs {
            builder.morph_weight(target, curve)?;
        }
        for event in parts.events {
            builder.event(event.time, event.name)?;
        }
        let clip = builder.build();
        Ok(match parts.span {
            Some(_) => clip,
            None => clip.without_frames(),
        })
    }
}
