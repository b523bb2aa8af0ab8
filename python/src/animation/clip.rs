//! Animation clips: motion of an armature's bones and morph targets over a span of time.

use std::sync::Arc;

use kinopt::animation::{
    Armature as Bones, Channel, Clip as Motion, ClipError, Cursor, KeyTolerance, Pose as Locals,
};
use kinopt_bindings::names::{PLAYBACKS, named};
use pyo3::prelude::*;
use pyo3::types::PyType;

use super::bones_and_poses::{Armature, Pose, Poses, poses_of};
use super::clip_builder::ClipBuilder;
use super::clip_ik::{ClipIkRequest, EditedClip};
use super::curve::{EulerCurve, KeyedCurve, RotationCurve, Values};
use super::playhead::Passage;
use super::root_motion::RootMotion;
use crate::arrays::{self, Queries};
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::pool::Pool;
use crate::signals::interruptible;

/// Number of samples between two checks for signals.
const SAMPLES_AT_A_TIME: usize = 256;

/// Animation clip: motion of an armature's bones and morph targets over a span of time. Without a channel they are at
/// rest.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Clip {
    pub(crate) inner: Arc<Motion>,
    pub(crate) armature: Arc<Bones>,
    /// Playback cursors; concurrent calls use different ones.
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

    fn changed(
        &self,
        py: Python<'_>,
        change: impl Fn(&Motion, &Bones) -> Result<Motion, ClipError> + Sync,
    ) -> PyResult<Self> {
        let clip = py
            .detach(|| change(&self.inner, &self.armature))
            .or_raise()?;
        Ok(Self::of(&self.armature, Arc::new(clip)))
    }
}

#[pymethods]
impl Clip {
    /// Returns a builder of a clip for an armature.
    #[classmethod]
    fn builder(
        _class: &Bound<'_, PyType>,
        name: String,
        armature: &Bound<'_, Armature>,
    ) -> ClipBuilder {
        ClipBuilder::new(name, armature)
    }

    /// Returns the clip of a name among `clips`, or the one whose name ends with it after a separator: "Walk" finds
    /// "Armature|Walk".
    ///
    /// Raises `UnknownNameError`, and `InvalidValueError` if several clips match.
    #[staticmethod]
    fn named<'py>(clips: Vec<Bound<'py, Self>>, name: &str) -> PyResult<Bound<'py, Self>> {
        let motion = Motion::named(clips.iter().map(|clip| &*clip.get().inner), name).or_raise()?;
        let is_same = |clip: &Bound<'_, Self>| std::ptr::eq(&*clip.get().inner, motion);
        let index = clips.iter().position(is_same).unwrap_or(0);
        Ok(clips[index].clone())
    }

    /// Name of the clip.
    #[getter]
    fn name(&self) -> &str {
        self.inner.name()
    }

    /// Armature of the clip.
    #[getter]
    fn armature(&self) -> Armature {
        Arc::clone(&self.armature).into()
    }

    /// First and last time, in seconds.
    #[getter]
    fn span(&self) -> (f32, f32) {
        let [start, end] = self.inner.span();
        (start, end)
    }

    /// Duration, in seconds.
    #[getter]
    fn duration(&self) -> f64 {
        self.inner.duration()
    }

    /// Events, sorted by time: [(time of the clip in seconds, name), ...].
    #[getter]
    fn events(&self) -> Vec<(f32, String)> {
        let events = self.inner.events().iter();
        events
            .map(|event| (event.time, event.name.clone()))
            .collect()
    }

    /// The pose at `time`, in seconds of the file as in `span` and `events`. It is a `Pose` for a number, `Poses` for N
    /// of them, shape (N,).
    ///
    /// `playback` selects the behaviour outside the span: "hold", "loop" or "ping_pong". `out`, a `Pose`, receives the
    /// result of a single time.
    ///
    /// Raises `InvalidValueError` for a time that is not finite and for an `out` of another armature,
    /// `UnknownNameError` for another `playback`.
    #[pyo3(signature = (time, playback = "hold", *, out = None))]
    fn sample<'py>(
        &self,
        py: Python<'py>,
        time: &Bound<'py, PyAny>,
        playback: &str,
        out: Option<&Bound<'py, Pose>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let playback = named("playback", playback, &PLAYBACKS).or_raise()?;
        if let Ok(time) = time.extract::<f64>() {
            let time = arrays::finite(time, "time")?;
            let sample = |pose: &mut Locals| {
                let sample = |cursor: &mut Cursor| self.inner.sample(time, playback, cursor, pose);
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
        let times = Queries::numbers(time, "time")?;
        let mut poses = vec![self.armature.rest().clone(); times.count()];
        self.cursors.with(|cursor| {
            times.each(py, &mut poses, SAMPLES_AT_A_TIME, |time, poses| {
                let time = arrays::finite(time[0], "time")?;
                let sampled = self.inner.sample(time, playback, cursor, &mut poses[0]);
                sampled.or_raise()
            })
        })?;
        Ok(Bound::new(py, Poses::of(&self.armature, poses))?.into_any())
    }

    /// Events in a passage of playback (of `Playhead.advance`), in the order of playback, at most the first `most`:
    /// [(name, seconds since playback started), ...].
    ///
    /// Raises `UnknownNameError` for another `playback`, `InvalidValueError` for a `most` that is not a whole number of
    /// at least 0.
    #[pyo3(signature = (passage, playback = "hold", most = 10_000))]
    fn fired(
        &self,
        py: Python<'_>,
        passage: &Bound<'_, Passage>,
        playback: &str,
        #[pyo3(from_py_with = crate::arrays::whole)] most: usize,
    ) -> PyResult<Vec<(String, f64)>> {
        let playback = named("playback", playback, &PLAYBACKS).or_raise()?;
        let passage = passage.get().inner;
        interruptible(py, || {
            let fired = self.inner.fired(playback, passage).take(most);
            fired
                .map(|fired| (fired.event.name.clone(), fired.elapsed))
                .collect()
        })
    }

    /// Channels: [(bone, property, curve), ...], by bone, with "translation", "rotation" or "scale" and a `KeyedCurve`,
    /// `RotationCurve` or `EulerCurve`. A constant property has a single key.
    ///
    /// Raises `InvalidValueError` for a curve without a representation; clips of files and builders have none.
    fn channels<'py>(&self, py: Python<'py>) -> PyResult<Vec<(String, String, Bound<'py, PyAny>)>> {
        let channels = self.inner.channels(&self.armature).or_raise()?;
        let described = |(bone, channel): (kinopt::skeleton::BoneId, Channel)| {
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
                _ => return Err(invalid("a channel of an unknown kind")),
            };
            Ok((name, property.to_owned(), curve))
        };
        channels.into_iter().map(described).collect()
    }

    /// Channels of morph target weights: [(target, curve), ...].
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

    /// A clip through `poses` at ascending `times` in seconds, shape (N,), with linear interpolation. A property that
    /// is equal in all poses has one key, and none if it is at rest.
    ///
    /// Raises `InvalidValueError` for no poses, other counts, times that do not ascend and poses of another armature.
    #[staticmethod]
    fn through_poses(
        name: String,
        armature: &Bound<'_, Armature>,
        times: &Bound<'_, PyAny>,
        poses: &Bound<'_, PyAny>,
    ) -> PyResult<Self> {
        let armature = &armature.get().inner;
        let times = arrays::copied(times, "times")?;
        let times: Vec<f32> = times.into_iter().map(|time| time as f32).collect();
        let (poses, _) = poses_of(poses)?;
        let clip = Motion::through_poses(name, armature, &times, &poses).or_raise()?;
        Ok(Self::of(armature, Arc::new(clip)))
    }

    /// The clip under another name.
    fn renamed(&self, name: String) -> Self {
        let clip = Motion::clone(&self.inner).renamed(name);
        Self::of(&self.armature, Arc::new(clip))
    }

    /// The clip resampled at `keys_per_second` from start to end, with linear interpolation.
    ///
    /// Raises `InvalidValueError` for a rate that is not above 0 or needs more than four million keys.
    fn baked(&self, py: Python<'_>, keys_per_second: f64) -> PyResult<Self> {
        self.changed(py, |clip, armature| clip.baked(armature, keys_per_second))
    }

    /// The clip with fewer keys. At each original key, every bone stays within `translation` (the file's unit),
    /// `rotation` (radians) and `scale` of its original local transform. Morph target weights stay within `scale`.
    /// Step, cubic and eased curves do not change.
    #[pyo3(signature = (translation = 0.0, rotation = 0.0, scale = 0.0))]
    fn with_fewer_keys(
        &self,
        py: Python<'_>,
        translation: f32,
        rotation: f32,
        scale: f32,
    ) -> PyResult<Self> {
        let tolerance = KeyTolerance::EXACT
            .with_translation(translation)
            .with_rotation(rotation)
            .with_scale(scale);
        self.changed(py, |clip, armature| {
            Ok(clip.with_fewer_keys(armature, &tolerance)?)
        })
    }

    /// The clip resampled, with its last `seconds` blended into its first pose, so that it loops without a jump.
    ///
    /// Raises `InvalidValueError` for seconds longer than the clip, and as `baked`.
    #[pyo3(signature = (seconds, keys_per_second = 30.0))]
    fn with_closed_seam(
        &self,
        py: Python<'_>,
        seconds: f64,
        keys_per_second: f64,
    ) -> PyResult<Self> {
        self.changed(py, |clip, armature| {
            clip.with_closed_seam(armature, seconds, keys_per_second)
        })
    }

    /// Inverse kinematics over the clip. `reach` is a list of `Reach`: bones that reach points, or follow curves, over
    /// spans. `plant` is a list of bones, such as feet. Each is locked in place while it is slow and low in the clip.
    /// Each sample stays as close to the clip as possible. The bone `root` moves only if limbs are too short. By
    /// default it is the topmost bone that carries all these bones and has more than one child.
    ///
    /// `up` is the upward axis. Feet are in contact with the `ground`. It is a `World`, or a function of x, y, z that
    /// returns its height over the level of the clip's walk. A clip in place has no contacts without `root_velocity`,
    /// a velocity (3,) in units of length per second; "feet" computes it from the planted bones. For a clip of a rig,
    /// `skeleton` adds its joint limits, and the tips of bones, not their origins, reach and are planted.
    /// `keys_per_second` samples are solved and keyed.
    ///
    /// Raises `UnknownNameError` for bones, `InvalidValueError` for spans and numbers out of range and for conflicting
    /// requests. Exceptions of the ground function propagate.
    #[pyo3(signature = (
        reach = Vec::new(), plant = Vec::new(), *, root = None, up = [0.0, 1.0, 0.0], keys_per_second = 60.0,
        ground = None, root_velocity = None, skeleton = None
    ))]
    #[allow(clippy::too_many_arguments, reason = "they are keywords")]
    fn with_ik<'py>(
        &self,
        py: Python<'py>,
        reach: Vec<Bound<'py, PyAny>>,
        plant: Vec<String>,
        root: Option<String>,
        up: [f32; 3],
        keys_per_second: f64,
        ground: Option<Bound<'py, PyAny>>,
        root_velocity: Option<Bound<'py, PyAny>>,
        skeleton: Option<Bound<'py, PyAny>>,
    ) -> PyResult<EditedClip> {
        let request = ClipIkRequest {
            reach,
            plant,
            root,
            up,
            keys_per_second,
            ground,
            root_velocity,
            skeleton,
        };
        request.over(py, self)
    }

    /// The clip in place, and the root motion of a bone: (clip, root motion). The bone keeps its initial horizontal
    /// position and heading; `up` is the upward axis.
    ///
    /// Raises `UnknownNameError`, `InvalidValueError` for an axis of zero length, and as `baked`.
    #[pyo3(signature = (bone, up = [0.0, 1.0, 0.0], keys_per_second = 30.0))]
    fn without_root_motion(
        &self,
        py: Python<'_>,
        bone: &str,
        up: [f32; 3],
        keys_per_second: f64,
    ) -> PyResult<(Self, RootMotion)> {
        let bone = self.armature.bone(bone).or_raise()?;
        let parts = py.detach(|| {
            self.inner
                .without_root_motion(&self.armature, bone, up.into(), keys_per_second)
        });
        let (clip, inner) = parts.or_raise()?;
        Ok((
            Self::of(&self.armature, Arc::new(clip)),
            RootMotion { inner },
        ))
    }

    /// The clip resampled with a root motion added to a bone: the inverse of `without_root_motion`.
    ///
    /// Raises as `without_root_motion`.
    #[pyo3(signature = (bone, motion, keys_per_second = 30.0))]
    fn with_root_motion(
        &self,
        py: Python<'_>,
        bone: &str,
        motion: &Bound<'_, RootMotion>,
        keys_per_second: f64,
    ) -> PyResult<Self> {
        let bone = self.armature.bone(bone).or_raise()?;
        let motion = &motion.get().inner;
        self.changed(py, |clip, armature| {
            clip.with_root_motion(armature, bone, motion, keys_per_second)
        })
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = serde_json::to_string(&*self.inner).or_raise()?;
        pickling::by_rebuild::<Self>(py, (self.armature(), text))
    }

    #[staticmethod]
    fn _rebuild(armature: &Bound<'_, Armature>, text: &str) -> PyResult<Self> {
        let armature = &armature.get().inner;
        let clip: Motion = serde_json::from_str(text).or_raise()?;
        // Returns an error if the clip is of another armature.
        let mut pose = armature.rest().clone();
        let hold = kinopt::animation::Playback::Hold;
        clip.sample(clip.start(), hold, &mut Cursor::new(), &mut pose)
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
