//! Builder of clips.

use std::sync::Arc;

use kinopt::animation::{Armature as Bones, Channel, Clip as Motion};
use pyo3::prelude::*;

use super::bones_and_poses::Armature;
use super::clip::Clip;
use super::curve::{EulerCurve, KeyedCurve, RotationCurve, Values};
use super::euler_clip::EulerClip;
use crate::error::{OrRaise, invalid};

/// Collects the channels and events of a clip for one armature.
///
/// Starts an empty clip of this name.
#[pyclass(module = "kinopt.animation")]
pub(crate) struct ClipBuilder {
    name: String,
    armature: Arc<Bones>,
    parts: Vec<Part>,
}

/// Additions in their order.
#[derive(Clone)]
enum Part {
    Channel(kinopt::skeleton::BoneId, Channel),
    MorphWeight(usize, kinopt::animation::curve::KeyedCurve<f32>),
    EulerClip(Arc<kinopt::animation::EulerClip>),
    Event(f32, String),
    Span(f32, f32),
}

impl Part {
    fn add(self, builder: &mut kinopt::animation::ClipBuilder<'_>) -> PyResult<()> {
        match self {
            Self::Channel(bone, channel) => builder.channel(bone, channel),
            Self::MorphWeight(target, curve) => builder.morph_weight(target, curve),
            Self::EulerClip(clip) => builder.euler_clip(&clip),
            Self::Event(time, name) => builder.event(time, name),
            Self::Span(start, end) => builder.span(start, end),
        }
        .or_raise()
        .map(|_| ())
    }
}

#[pymethods]
impl ClipBuilder {
    #[new]
    pub(super) fn new(name: String, armature: &Bound<'_, Armature>) -> Self {
        Self {
            name,
            armature: Arc::clone(&armature.get().inner),
            parts: Vec::new(),
        }
    }

    /// Adds a channel of a bone: `property` is "translation" or "scale" with a `KeyedCurve` of vectors, or
    /// "rotation" with a `RotationCurve` or an `EulerCurve`.
    ///
    /// Raises `UnknownNameError`, and `InvalidValueError` for a curve of another kind.
    fn channel(&mut self, bone: &str, property: &str, curve: &Bound<'_, PyAny>) -> PyResult<()> {
        let bone = self.armature.bone(bone).or_raise()?;
        let known = ["translation", "rotation", "scale"];
        if !known.contains(&property) {
            let error = kinopt::model::UnknownName::new("property", property, known);
            return Err(error).or_raise();
        }
        let channel = if let Ok(curve) = curve.cast::<RotationCurve>() {
            Some(Channel::Rotation(curve.get().inner.clone())).filter(|_| property == "rotation")
        } else if let Ok(curve) = curve.cast::<EulerCurve>() {
            Some(Channel::Euler(curve.get().inner.clone())).filter(|_| property == "rotation")
        } else if let Ok(curve) = curve.cast::<KeyedCurve>() {
            match (&curve.get().inner, property) {
                (Values::Vectors(curve), "translation") => {
                    Some(Channel::Translation(curve.clone()))
                }
                (Values::Vectors(curve), "scale") => Some(Channel::Scale(curve.clone())),
                _ => None,
            }
        } else {
            None
        };
        let mismatch = || {
            invalid(format!(
                "a {property} channel has {}, not {}",
                match property {
                    "rotation" => "a RotationCurve or an EulerCurve",
                    _ => "a KeyedCurve of vectors",
                },
                curve.get_type()
            ))
        };
        self.parts
            .push(Part::Channel(bone, channel.ok_or_else(mismatch)?));
        Ok(())
    }

    /// Adds the weight of one morph target: a `KeyedCurve` of numbers.
    ///
    /// Raises `UnknownNameError` for an unknown morph target, `InvalidValueError` for a curve of
    fn morph_weight(&mut self, target: &str, weights: &Bound<'_, KeyedCurve>) -> PyResult<()> {
        let target = self.armature.morph_target(target).or_raise()?;
        match &weights.get().inner {
            Values::Numbers(curve) => self.parts.push(Part::MorphWeight(target, curve.clone())),
            Values::Vectors(_) => return Err(invalid("weights must be a curve of numbers")),
        }
        Ok(())
    }

    /// Adds the tracks of a rig's keyframes, for an armature of its skeleton.
    ///
    /// A clip of other bones raises `InvalidValueError` in `build`.
    fn euler_clip(&mut self, clip: &Bound<'_, EulerClip>) {
        let clip = Arc::clone(&clip.get().inner);
        self.parts.push(Part::EulerClip(clip));
    }

    /// Adds an event at a time in seconds; an event outside the clip's span never fires.
    ///
    /// A time that is not finite raises `InvalidValueError` in `build`.
    fn event(&mut self, time: f32, name: String) {
        self.parts.push(Part::Event(time, name));
    }

    /// Sets the span of the clip in seconds. Default: from the first to the last key.
    ///
    /// An end before the start raises `InvalidValueError` in `build`.
    fn span(&mut self, start: f32, end: f32) {
        self.parts.push(Part::Span(start, end));
    }

    /// Validates all parts and creates the clip.
    ///
    /// Raises `InvalidValueError` with the bone or target: a second channel for one of its properties, keys or an event
    /// that are not finite, a span that ends before it starts.
    fn build(&self) -> PyResult<Clip> {
        let mut builder = Motion::builder(self.name.as_str(), &self.armature);
        for part in &self.parts {
            part.clone().add(&mut builder)?;
        }
        Ok(Clip::of(&self.armature, Arc::new(builder.build())))
    }

    fn __repr__(&self) -> String {
        format!("ClipBuilder({:?})", self.name)
    }
}
