//! Characters that share an armature and the limbs that reach for goals.

use std::sync::{Arc, Mutex, PoisonError};

use kinopt::animation::{
    Armature as Bones, Crowd as Many, Playback, Playhead, PlayingClip as Playing,
};
use kinopt::glam::Affine3A;
use numpy::PyArrayDyn;
use pyo3::prelude::*;

use super::bones_and_poses::{Armature, Pose, Poses};
use super::clip::Clip;
use super::limb::{Limb, LimbGoal};
use super::playback;
use crate::arrays::{self, place};
use crate::error::{OrRaise, invalid};
use crate::pickling;
use crate::{threads, transforms};

/// A clip that a character plays: where it is, how fast it plays, what happens at its ends, and how far the
/// pose of the clips before it goes to this one's.
///
/// A clip that plays from `elapsed` seconds on at `speed`, "hold", "loop" or "ping_pong", blended over the
/// clips before it by `share`, within [0, 1].
///
/// Raises `UnknownNameError` for another `playback`, `InvalidValueError` for a `share` that is not within [0,
/// 1] and for numbers that are not finite.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct PlayingClip {
    clip: Py<Clip>,
    playback: Playback,
    name: String,
    #[pyo3(get)]
    /// How many seconds of the clip pass in a second; negative plays backwards.
    speed: f64,
    #[pyo3(get)]
    /// Seconds since playback started.
    elapsed: f64,
    #[pyo3(get)]
    /// How far the pose of the clips before it goes to this one's, within [0, 1].
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
            playback: playback::of(playback)?,
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

    /// What happens at its ends.
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
        pickling::by_rebuild::<Self>(py, parts)
    }

    #[staticmethod]
    fn _rebuild(
        clip: &Bound<'_, Clip>,
        playback: &str,
        speed: f64,
        elapsed: f64,
        share: f32,
    ) -> PyResult<Self> {
        Self::new(clip, playback, speed, elapsed, share)
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

/// Characters that share an armature and the limbs that reach for goals. A frame of one samples its clips,
/// blends them, brings its limbs to their goals, and places its bones in the model.
///
/// It holds what is running, so it is not pickled; calls from many threads come one after another.
///
/// A crowd without characters; each will have a goal for each of the limbs, which are of the armature.
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

    /// Adds a character that plays these clips, each blended over those before it, in the rest pose until it is
    /// advanced. Gives its number.
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

    /// The armature of the characters.
    #[getter]
    fn armature(&self) -> Armature {
        Arc::clone(&self.armature).into()
    }

    /// Goes on by so many seconds, over `threads` threads (None: one a core), with the same bits at any number.
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

    /// Where the bones of all characters are in the model, as of the last frame: float32, shape
    /// (N, bones, 4, 4). `out` takes the result.
    ///
    /// Raises `InvalidValueError` for an `out` that does not fit.
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
        let array = arrays::room_of::<f32>(py, out, &[placed.len(), bones, 4, 4])?;
        arrays::fill(&array, |room| {
            for (placed, room) in placed.iter().zip(room.chunks_mut((bones * 16).max(1))) {
                transforms::write(placed, room);
            }
            Ok(())
        })?;
        Ok(array)
    }

    /// The poses of all characters as of the last frame.
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

    /// One character's pose as of the last frame.
    ///
    /// Raises `IndexError` for a character that there is not.
    fn pose(&self, character: isize) -> PyResult<Pose> {
        let index = place(character, self.__len__())?;
        let pose = self.with(|crowd| crowd.characters()[index].pose().clone());
        Ok(Pose::of(&self.armature, pose))
    }

    /// Sets what a limb of a character reaches for; both by number.
    ///
    /// Raises `IndexError` for a character or a limb that there is not.
    fn set_goal(&self, character: isize, limb: isize, goal: &Bound<'_, LimbGoal>) -> PyResult<()> {
        let (index, limb) = (place(character, self.__len__())?, place(limb, self.limbs)?);
        let goal = goal.get().inner;
        self.with(|crowd| crowd.characters_mut()[index].goals_mut()[limb] = goal);
        Ok(())
    }

    /// Changes how a character plays a clip of its list, both by number: its `share`, its `speed`.
    ///
    /// Raises `IndexError` for a character or a clip that there is not, `InvalidValueError` for a `share`
    /// that is not within [0, 1] and for numbers that are not finite.
    #[pyo3(signature = (character, clip, *, share = None, speed = None))]
    fn set_clip(
        &self,
        character: isize,
        clip: isize,
        share: Option<f32>,
        speed: Option<f64>,
    ) -> PyResult<()> {
        let index = place(character, self.__len__())?;
        let clips = self.with(|crowd| crowd.characters_mut()[index].clips_mut().len());
        let clip = place(clip, clips)?;
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
