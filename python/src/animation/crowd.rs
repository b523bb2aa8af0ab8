//! Crowds: characters that share an armature and its reaching limbs.

use std::sync::{Arc, Mutex, PoisonError};

use kinopt::animation::{
    Armature as Bones, Crowd as Many, Playback, Playhead, PlayingClip as Playing,
};
use kinopt::glam::Affine3A;
use kinopt_bindings::names::{PLAYBACKS, named};
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::bones_and_poses::{Armature, Pose, Poses};
use super::clip::Clip;
use super::limb::{Limb, LimbGoal};
use crate::arrays::{self, resolve_index};
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::{threads, transforms};

/// A clip in playback: its position and speed, the behaviour at its ends, and its blend weight over the previous clips.
///
/// A clip at `elapsed` seconds, with `speed`, "hold", "loop" or "ping_pong", blended over the previous clips by
/// `share`, within [0, 1].
///
/// Raises `UnknownNameError` for another `playback`, `InvalidValueError` for a `share` that is not within [0, 1] and
/// for numbers that are not finite.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct PlayingClip {
    clip: Py<Clip>,
    playback: Playback,
    name: String,
    #[pyo3(get)]
    /// Playback speed: seconds of the clip for each second; negative plays backwards.
    speed: f64,
    #[pyo3(get)]
    /// Seconds since playback started.
    elapsed: f64,
    #[pyo3(get)]
    /// Blend weight over the previous clips, within [0, 1].
    share: f32,
}

#[pymethods]
impl PlayingClip {
    #[new]
    #[pyo3(signature = (clip, playback = "loop", *, speed = 1.0, elapsed = 0.0, share = 1.0))]
    fn new(
        clip: &Bound<'_, Clip>,
        playback: &str,
        speed: f64,
        elapsed: f64,
        share: f32,
    ) -> PyResult<Self> {
        Ok(Self {
            clip: clip.clone().unbind(),
            playback: named("playback", playback, &PLAYBACKS).or_raise()?,
            name: playback.to_owned(),
            speed: arrays::finite(speed, "speed")?,
            elapsed: arrays::finite(elapsed, "elapsed")?,
            share: arrays::share(share, "share")?,
        })
    }

    /// The clip that is played.
    #[getter]
    fn clip(&self, py: Python<'_>) -> Py<Clip> {
        self.clip.clone_ref(py)
    }

    /// Behaviour at its ends.
    #[getter]
    fn playback(&self) -> &str {
        &self.name
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let parts = (
            self.clip(py),
            self.playback(),
            self.speed,
            self.elapsed,
            self.share,
        );
        pickling::by_arguments::<Self>(py, parts, &["speed", "elapsed", "share"])
    }

    fn __repr__(&self) -> String {
        let name = self.clip.get().inner.name();
        format!(
            "PlayingClip({name:?}, speed={}, share={})",
            self.speed, self.share
        )
    }
}

impl PlayingClip {
    fn playing(&self) -> Playing {
        let mut playing = Playing::new(Arc::clone(&self.clip.get().inner));
        playing.playhead = Playhead::starting_at(self.elapsed);
        playing.playhead.speed = self.speed;
        playing.playback = self.playback;
        playing.share = self.share;
        playing
    }
}

/// Characters that share an armature and its reaching limbs. Each update of a character samples its clips, blends them,
/// moves its limbs to their goals, and computes its bones in model space.
///
/// It holds running state, so it cannot be pickled; calls from several threads are serialised.
///
/// A crowd without characters; each added character has a goal for each of the limbs.
///
/// Raises `InvalidValueError` for a limb of another armature.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct Crowd {
    inner: Mutex<Many>,
    armature: Arc<Bones>,
    limbs: usize,
}

impl Crowd {
    fn with<T>(&self, run: impl FnOnce(&mut Many) -> T) -> T {
        run(&mut self.inner.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

#[pymethods]
impl Crowd {
    #[new]
    #[pyo3(signature = (armature, limbs = Vec::new()))]
    fn new(armature: &Bound<'_, Armature>, limbs: Vec<Bound<'_, Limb>>) -> PyResult<Self> {
        let armature = Arc::clone(&armature.get().inner);
        if limbs.iter().any(|limb| *limb.get().armature != *armature) {
            return Err(invalid("a limb is of another armature"));
        }
        let limbs: Vec<_> = limbs.iter().map(|limb| limb.get().inner).collect();
        Ok(Self {
            limbs: limbs.len(),
            inner: Mutex::new(Many::new(Bones::clone(&armature), limbs)),
            armature,
        })
    }

    /// Adds a character that plays these clips, each blended over the previous ones. It is in the rest pose until the
    /// first `advance`. Returns its index.
    ///
    /// Raises `InvalidValueError` for a clip of another armature.
    fn add(&self, clips: Vec<Bound<'_, PlayingClip>>) -> PyResult<usize> {
        let clips: Vec<Playing> = clips.iter().map(|clip| clip.get().playing()).collect();
        self.with(|crowd| {
            crowd.add(clips)?;
            Ok::<usize, kinopt::animation::SizeMismatch>(crowd.characters().len() - 1)
        })
        .or_raise()
    }

    fn __len__(&self) -> usize {
        self.with(|crowd| crowd.characters().len())
    }

    /// Armature of the characters.
    #[getter]
    fn armature(&self) -> Armature {
        Arc::clone(&self.armature).into()
    }

    /// Advances all characters by `seconds`, on `threads` threads (None: one for each core), with equal results at any
    /// number.
    ///
    /// Raises `InvalidValueError` for seconds that are not finite and for 0 threads.
    #[pyo3(signature = (seconds, threads = Some(1)))]
    fn advance(
        &self,
        py: Python<'_>,
        seconds: f64,
        #[pyo3(from_py_with = crate::arrays::whole_or_none)] threads: Option<usize>,
    ) -> PyResult<()> {
        let seconds = arrays::finite(seconds, "seconds")?;
        let characters = self.with(|crowd| crowd.characters().len());
        let pool = threads::pool(threads, characters)?;
        py.detach(|| {
            self.with(|crowd| match &pool {
                Some(pool) => pool.install(|| crowd.advance_parallel(seconds)),
                None => crowd.advance(seconds),
            })
        })
        .or_raise()
    }

    /// Bone transforms of all characters in model space after the last update: float32, shape (N, bones, 4, 4). `out`
    /// receives the result.
    ///
    /// Raises `InvalidValueError` for an `out` of another shape or type.
    #[pyo3(signature = (*, out = None))]
    fn model_from_bone<'py>(
        &self,
        py: Python<'py>,
        out: Option<&Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyArrayDyn<f32>>> {
        let placed: Vec<Vec<Affine3A>> = self.with(|crowd| {
            let characters = crowd.characters().iter();
            characters
                .map(|character| character.model_from_bone().to_vec())
                .collect()
        });
        let bones = self.armature.bones();
        let array = arrays::output_array::<f32>(py, out, &[placed.len(), bones, 4, 4])?;
        arrays::fill(&array, |buffer| {
            for (placed, buffer) in placed.iter().zip(buffer.chunks_mut((bones * 16).max(1))) {
                transforms::write(placed, buffer);
            }
            Ok(())
        })?;
        Ok(array)
    }

    /// Poses of all characters after the last update.
    #[getter]
    fn poses(&self) -> Poses {
        let poses = self.with(|crowd| {
            let characters = crowd.characters().iter();
            characters
                .map(|character| character.pose().clone())
                .collect()
        });
        Poses::of(&self.armature, poses)
    }

    /// Pose of one character after the last update.
    ///
    /// Raises `IndexError` for an unknown character.
    fn pose(&self, character: isize) -> PyResult<Pose> {
        let index = resolve_index(character, self.__len__())?;
        let pose = self.with(|crowd| crowd.characters()[index].pose().clone());
        Ok(Pose::of(&self.armature, pose))
    }

    /// Sets the goal of a limb of a character; both by index.
    ///
    /// Raises `IndexError` for an unknown character or limb.
    fn set_goal(&self, character: isize, limb: isize, goal: &Bound<'_, LimbGoal>) -> PyResult<()> {
        let (index, limb) = (
            resolve_index(character, self.__len__())?,
            resolve_index(limb, self.limbs)?,
        );
        let goal = goal.get().inner;
        self.with(|crowd| crowd.characters_mut()[index].goals_mut()[limb] = goal);
        Ok(())
    }

    /// Changes the `share` or `speed` of a clip of a character, both by index.
    ///
    /// Raises `IndexError` for an unknown character or clip, `InvalidValueError` for a `share` that is not within [0,
    /// 1] and for numbers that are not finite.
    #[pyo3(signature = (character, clip, *, share = None, speed = None))]
    fn set_clip(
        &self,
        character: isize,
        clip: isize,
        share: Option<f32>,
        speed: Option<f64>,
    ) -> PyResult<()> {
        let index = resolve_index(character, self.__len__())?;
        let clips = self.with(|crowd| crowd.characters_mut()[index].clips_mut().len());
        let clip = resolve_index(clip, clips)?;
        let share = share.map(|share| arrays::share(share, "share"));
        let share = share.transpose()?;
        let speed = speed.map(|speed| arrays::finite(speed, "speed"));
        let speed = speed.transpose()?;
        self.with(|crowd| {
            let playing = &mut crowd.characters_mut()[index].clips_mut()[clip];
            playing.share = share.unwrap_or(playing.share);
            playing.playhead.speed = speed.unwrap_or(playing.playhead.speed);
        });
        Ok(())
    }

    fn __repr__(&self) -> String {
        format!(
            "Crowd({} characters of {} bones)",
            self.__len__(),
            self.armature.bones()
        )
    }
}
