//! Clips: the motion of an armature's bones and morph targets over a span of time.

use std::sync::Arc;

use kinopt::animation::{Armature as Bones, Channel, Clip as Motion, Cursor, Pose as Locals};
use pyo3::prelude::*;
use pyo3::types::PyType;

use super::bones_and_poses::{Armature, Pose, Poses};
use super::curve::{EulerCurve, KeyedCurve, RotationCurve, Values};
use super::euler_clip::EulerClip;
use super::playback;
use super::playhead::Passage;
use crate::arrays::{self, Questions};
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::pool::Pool;

/// Samples that are taken between two looks at signals.
const SAMPLES_AT_A_TIME: usize = 256;

/// Motion of an armature's bones and morph targets over a span of time. What has no channel is at rest.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Clip {
    pub(crate) inner: Arc<Motion>,
    pub(crate) armature: Arc<Bones>,
    /// Playback goes on where it was; from many threads each has a cursor of its own.
    cursors: Pool<Cursor>,
}

impl Clip {
    pub(crate) fn of(armature: &Arc<Bones>, clip: Arc<Motion>) -> Self {
        Self {
            inner: clip,
            armature: Arc::clone(armature),
            cursors: Pool::new(Cursor::new()),
        }
    }
}

#[pymethods]
impl Clip {
    /// Starts a clip for an armature.
    #[classmethod]
    fn builder(
        _class: &Bound<'_, PyType>,
        name: String,
        armature: &Bound<'_, Armature>,
    ) -> ClipBuilder {
        ClipBuilder::new(name, armature)
    }

    /// The clip of a name among `clips`, or the one whose name ends with it after a sign: "Walk" means
    /// "Armature|Walk".
    ///
    /// Raises `UnknownNameError`, `InvalidValueError` where several may be meant.
    #[staticmethod]
    fn named<'py>(clips: Vec<Bound<'py, Self>>, name: &str) -> PyResult<Bound<'py, Self>> {
        let found = Motion::named(clips.iter().map(|clip| &*clip.get().inner), name).or_raise()?;
        let same = |clip: &Bound<'_, Self>| std::ptr::eq(&*clip.get().inner, found);
        let index = clips.iter().position(same).unwrap_or(0);
        Ok(clips[index].clone())
    }

    /// What the clip is called.
    #[getter]
    fn name(&self) -> &str {
        self.inner.name()
    }

    /// The armature it moves.
    #[getter]
    fn armature(&self) -> Armature {
        Arc::clone(&self.armature).into()
    }

    /// The first and last moment, in seconds.
    #[getter]
    fn span(&self) -> (f32, f32) {
        let [start, end] = self.inner.span();
        (start, end)
    }

    /// How long it lasts, in seconds.
    #[getter]
    fn duration(&self) -> f64 {
        self.inner.duration()
    }

    /// Its events, sorted by time: [(seconds of the clip's own time, name), ...].
    #[getter]
    fn events(&self) -> Vec<(f32, String)> {
        let events = self.inner.events().iter();
        events
            .map(|event| (event.time, event.name.clone()))
            .collect()
    }

    /// The pose at `elapsed` seconds after the clip's start: a `Pose` for a number, `Poses` for N of them,
    /// shape (N,).
    ///
    /// `playback` says what happens outside the span: "hold", "loop" or "ping_pong". `out`, a `Pose`, takes
    /// the result of a number.
    ///
    /// Raises `InvalidValueError` for a time that is not finite and for an `out` of another armature,
    /// `UnknownNameError` for another `playback`.
    #[pyo3(signature = (elapsed, playback = "hold", *, out = None))]
    fn sample<'py>(
        &self,
        py: Python<'py>,
        elapsed: &Bound<'py, PyAny>,
        playback: &str,
        out: Option<&Bound<'py, Pose>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let playback = playback::of(playback)?;
        if let Ok(elapsed) = elapsed.extract::<f64>() {
            let elapsed = arrays::finite(elapsed, "elapsed")?;
            let sample = |pose: &mut Locals| {
                let sample =
                    |cursor: &mut Cursor| self.inner.sample(elapsed, playback, cursor, pose);
                self.cursors.with(sample)
            };
            if let Some(out) = out {
                out.get().with(sample).or_raise()?;
                return Ok(out.clone().into_any());
            }
            let mut pose = self.armature.rest().clone();
            sample(&mut pose).or_raise()?;
            return Ok(Bound::new(py, Pose::of(&self.armature, pose))?.into_any());
        }
        if out.is_some() {
            return Err(invalid("out takes the pose at one time"));
        }
        let times = Questions::numbers(elapsed, "elapsed")?;
        let mut poses = vec![self.armature.rest().clone(); times.count()];
        self.cursors.with(|cursor| {
            times.each(py, &mut poses, SAMPLES_AT_A_TIME, |time, poses| {
                let time = arrays::finite(time[0], "elapsed")?;
                let sampled = self.inner.sample(time, playback, cursor, &mut poses[0]);
                sampled.or_raise()
            })
        })?;
        Ok(Bound::new(py, Poses::of(&self.armature, poses))?.into_any())
    }

    /// The events that a passage of playback (of `Playhead.advance`) goes by, in the order in which it meets
    /// them, the first `most` of them: [(name, seconds since playback started), ...].
    ///
    /// Raises `UnknownNameError` for another `playback`, `InvalidValueError` for a `most` that is no whole
    /// number of at least 0.
    #[pyo3(signature = (passage, playback = "hold", most = 10_000))]
    fn fired(
        &self,
        py: Python<'_>,
        passage: &Bound<'_, Passage>,
        playback: &str,
        #[pyo3(from_py_with = crate::arrays::whole)] most: usize,
    ) -> PyResult<Vec<(String, f64)>> {
        let playback = playback::of(playback)?;
        let passage = passage.get().inner;
        Ok(py.detach(|| {
            let fired = self.inner.fired(playback, passage).take(most);
            fired
                .map(|fired| (fired.event.name.clone(), fired.elapsed))
                .collect()
        }))
    }

    /// What it moves and how: [(bone, property, curve), ...], by bone, with "translation", "rotation" or
    /// "scale" and a `KeyedCurve`, `RotationCurve` or `EulerCurve`. What does not move has a single key.
    ///
    /// Raises `InvalidValueError` where a curve cannot be told, which no clip of a file or a builder has.
    fn channels<'py>(&self, py: Python<'py>) -> PyResult<Vec<(String, String, Bound<'py, PyAny>)>> {
        let channels = self.inner.channels(&self.armature).or_raise()?;
        let of = |(bone, channel): (kinopt::skeleton::BoneId, Channel)| {
            let name = self.armature.names()[bone.index()].clone();
            let (property, curve) = match channel {
                Channel::Translation(curve) => ("translation", vectors(py, curve)?),
                Channel::Scale(curve) => ("scale", vectors(py, curve)?),
                Channel::Rotation(inner) => (
                    "rotation",
                    Bound::new(py, RotationCurve { inner })?.into_any(),
                ),
                Channel::Euler(inner) => {
                    ("rotation", Bound::new(py, EulerCurve { inner })?.into_any())
                }
                _ => return Err(invalid("a channel of a kind that is not known here")),
            };
            Ok((name, property.to_owned(), curve))
        };
        channels.into_iter().map(of).collect()
    }

    /// As `channels`, for the weights of morph targets: [(target, curve), ...].
    ///
    /// Raises as `channels`.
    fn morph_channels(&self) -> PyResult<Vec<(String, KeyedCurve)>> {
        let channels = self.inner.morph_channels(&self.armature).or_raise()?;
        let targets = self.armature.morph_targets();
        Ok(channels
            .into_iter()
            .map(|(target, curve)| {
                let inner = Values::Numbers(curve);
                (targets[target].clone(), KeyedCurve { inner })
            })
            .collect())
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = serde_json::to_string(&*self.inner).or_raise()?;
        pickling::by_rebuild::<Self>(py, (self.armature(), text))
    }

    #[staticmethod]
    fn _rebuild(armature: &Bound<'_, Armature>, text: &str) -> PyResult<Self> {
        let armature = &armature.get().inner;
        let clip: Motion = serde_json::from_str(text).or_raise()?;
        // Of one size, or an error.
        let mut pose = armature.rest().clone();
        let hold = kinopt::animation::Playback::Hold;
        clip.sample(0.0, hold, &mut Cursor::new(), &mut pose)
            .or_raise()?;
        Ok(Self::of(armature, Arc::new(clip)))
    }

    fn __repr__(&self) -> String {
        let [start, end] = self.inner.span();
        format!("Clip({:?}, {start} s to {end} s)", self.inner.name())
    }
}

fn vectors(
    py: Python<'_>,
    curve: kinopt::animation::curve::KeyedCurve<kinopt::glam::Vec3A>,
) -> PyResult<Bound<'_, PyAny>> {
    let inner = Values::Vectors(curve);
    Ok(Bound::new(py, KeyedCurve { inner })?.into_any())
}

/// Collects the channels and events of a clip for one armature.
///
/// An empty clip of this name.
#[pyclass(module = "kinopt.animation")]
pub(crate) struct ClipBuilder {
    name: String,
    armature: Arc<Bones>,
    parts: Vec<Part>,
}

/// What is added, in the order in which it was.
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
    fn new(name: String, armature: &Bound<'_, Armature>) -> Self {
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
        let wrong = || {
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
            .push(Part::Channel(bone, channel.ok_or_else(wrong)?));
        Ok(())
    }

    /// Adds the weight of one morph target: a `KeyedCurve` of numbers.
    ///
    /// Raises `UnknownNameError` for a morph target that there is not, `InvalidValueError` for a curve of
    /// vectors.
    fn morph_weight(&mut self, target: &str, weights: &Bound<'_, KeyedCurve>) -> PyResult<()> {
        let target = self.armature.morph_target(target).or_raise()?;
        match &weights.get().inner {
            Values::Numbers(curve) => self.parts.push(Part::MorphWeight(target, curve.clone())),
            Values::Vectors(_) => return Err(invalid("weights must be a curve of numbers")),
        }
        Ok(())
    }

    /// Adds the tracks of a rig's keyframes, for an armature made of its skeleton.
    ///
    /// A clip of other bones raises `InvalidValueError` in `build`.
    fn euler_clip(&mut self, clip: &Bound<'_, EulerClip>) {
        let clip = Arc::clone(&clip.get().inner);
        self.parts.push(Part::EulerClip(clip));
    }

    /// Adds an event at a time in seconds; one outside the clip's span never fires.
    ///
    /// A time that is not finite raises `InvalidValueError` in `build`.
    fn event(&mut self, time: f32, name: String) {
        self.parts.push(Part::Event(time, name));
    }

    /// Sets the clip's span in seconds. Without it, it is from the first to the last key.
    ///
    /// An end before the start raises `InvalidValueError` in `build`.
    fn span(&mut self, start: f32, end: f32) {
        self.parts.push(Part::Span(start, end));
    }

    /// Checks all and makes the clip.
    ///
    /// Raises `InvalidValueError` naming the bone or target: a second channel for one of its properties,
    /// keys or an event that are not finite, a span that ends before it starts.
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
