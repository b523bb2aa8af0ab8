//! State machines: which clips a character plays, and how one goes over into the next.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use kinopt::animation::{
    Armature as Bones, Clip as Motion, ParameterValue, StateMachine as Machine,
    StateMachineRun as Run,
};
use kinopt::io::state_machine;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyType};

use super::bones_and_poses::{Armature, Pose};
use super::clip::Clip;
use crate::arrays;
use crate::contents::text_or_bytes;
use crate::error::{OrRaise, invalid};
use crate::pickling;

/// States, transitions and the clips they play, checked. It never changes; each character that runs it has a
/// `StateMachineRun`.
///
/// Its JSON names parameters with their first values (a number, true or false, or "trigger"), the initial
/// state, states that play clips by name, and transitions with their conditions:
///
///     {"parameters": {"speed": 0.0, "hit": "trigger", "dead": false},
///      "initial": "idle",
///      "states": [{"name": "idle", "clip": "stand"},
///                 {"name": "blow", "clip": "jump", "playback": "hold", "speed": 1.25}],
///      "transitions": [
///         {"from": "idle", "to": "blow", "seconds": 0.1, "when": [{"parameter": "hit"}]},
///         {"from": "blow", "to": "idle", "seconds": 0.25, "after": 0.8, "easing": "quadratic_in_out"},
///         {"to": "idle", "seconds": 0.3, "when": [{"parameter": "speed", "above": 0.5}]}]}
///
/// A transition without "from" leads from every state; "seconds" is how long its cross-fade takes, "after" the
/// share of the clip that must have played; a condition is "is", "above" or "below" a value, and nothing for a
/// trigger. "playback" is "hold", "loop" or "ping_pong", "speed" a factor.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct StateMachine {
    inner: Arc<Machine>,
    armature: Arc<Bones>,
    /// What it was read from.
    json: Vec<u8>,
    file: String,
    clips: Vec<Py<Clip>>,
}

impl StateMachine {
    fn make(
        py: Python<'_>,
        json: Vec<u8>,
        file: String,
        clips: Vec<Bound<'_, Clip>>,
    ) -> PyResult<Self> {
        let armature = match clips.first() {
            Some(clip) => Arc::clone(&clip.get().armature),
            None => return Err(invalid("a state machine plays at least one clip")),
        };
        let motions: Vec<Arc<Motion>> = clips
            .iter()
            .map(|clip| Arc::clone(&clip.get().inner))
            .collect();
        let machine = py.detach(|| state_machine::from_bytes(&json, &file, &motions));
        Ok(Self {
            inner: Arc::new(machine.or_raise()?),
            armature,
            json,
            file,
            clips: clips.into_iter().map(Bound::unbind).collect(),
        })
    }
}

#[pymethods]
impl StateMachine {
    /// Reads a state machine's JSON file that plays these clips, all of one armature.
    ///
    /// Raises `FileError` where it cannot be opened, `InvalidFileError` naming the file and a path in it such
    /// as `transitions[2].to`.
    #[classmethod]
    fn read(
        class: &Bound<'_, PyType>,
        path: PathBuf,
        clips: Vec<Bound<'_, Clip>>,
    ) -> PyResult<Self> {
        let file = path.display().to_string();
        let json = kinopt::io::FileAccess::new().read(&path).or_raise()?;
        Self::make(class.py(), json, file, clips)
    }

    /// Reads a state machine from its JSON, a text or bytes; `name` is what messages call it.
    ///
    /// Raises `InvalidFileError` naming a path in it such as `transitions[2].to`.
    #[classmethod]
    #[pyo3(signature = (data, clips, name = "state_machine.json"))]
    fn from_bytes(
        class: &Bound<'_, PyType>,
        data: &Bound<'_, PyAny>,
        clips: Vec<Bound<'_, Clip>>,
        name: &str,
    ) -> PyResult<Self> {
        Self::make(
            class.py(),
            text_or_bytes(data, "data")?,
            name.to_owned(),
            clips,
        )
    }

    /// The states' names.
    #[getter]
    fn states(&self) -> Vec<&str> {
        self.inner.states().collect()
    }

    /// The clips that it may play.
    #[getter]
    fn clips(&self, py: Python<'_>) -> Vec<Py<Clip>> {
        self.clips.iter().map(|clip| clip.clone_ref(py)).collect()
    }

    /// The armature of its clips.
    #[getter]
    fn armature(&self) -> Armature {
        Arc::clone(&self.armature).into()
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let json = pyo3::types::PyBytes::new(py, &self.json);
        let parts = (json, self.clips(py), self.file.as_str());
        pickling::by_method(py.get_type::<Self>().as_any(), "from_bytes", parts)
    }

    fn __repr__(&self) -> String {
        format!("StateMachine({})", self.states().join(", "))
    }
}

/// Where one character is in a machine: its parameters, the state it is in, and the cross-fade that is under
/// way. It holds what is running, so it is not pickled.
///
/// A character in the machine's initial state.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct StateMachineRun {
    inner: Mutex<Run>,
    armature: Arc<Bones>,
}

impl StateMachineRun {
    /// Does something with it that makes no Python objects.
    fn with<T>(&self, run: impl FnOnce(&mut Run) -> T) -> T {
        run(&mut self.inner.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// An event of a clip that a state machine went by: the state and the clip whose it is, the event's name and
/// its time in the clip, and how much of the pose was that clip's at that moment.
type Heard = (String, String, String, f32, f32);

#[pymethods]
impl StateMachineRun {
    #[new]
    fn new(machine: &Bound<'_, StateMachine>) -> PyResult<Self> {
        let machine = machine.get();
        let run = Run::new(Arc::clone(&machine.inner), machine.armature.rest()).or_raise()?;
        Ok(Self {
            inner: Mutex::new(run),
            armature: Arc::clone(&machine.armature),
        })
    }

    /// Goes on by so many seconds: plays the clips, takes transitions at the moments at which they may be
    /// taken, and blends. A long step ends where many short ones do.
    ///
    /// Gives the events of clips that were passed, at most 1024 of them: [(state, clip, event, time in the
    /// clip, weight), ...]. Seconds below 0 count as 0.
    ///
    /// Raises `InvalidValueError` for seconds that are not finite.
    fn update(&self, py: Python<'_>, seconds: f64) -> PyResult<Vec<Heard>> {
        let seconds = arrays::finite(seconds, "seconds")?;
        let mut heard: Vec<Heard> = Vec::new();
        let updated = py.detach(|| {
            self.with(|run| {
                run.update(seconds, |event| {
                    heard.push((
                        event.state.to_owned(),
                        event.clip.to_owned(),
                        event.event.name.clone(),
                        event.event.time,
                        event.weight,
                    ));
                })
            })
        });
        updated.or_raise()?;
        Ok(heard)
    }

    /// The pose as of the last update; a new one each time.
    #[getter]
    fn pose(&self) -> Pose {
        Pose::of(&self.armature, self.with(|run| run.pose().clone()))
    }

    /// The state that it is in or on the way to.
    #[getter]
    fn state(&self) -> String {
        self.with(|run| run.state().to_owned())
    }

    /// How long it has been in that state, in seconds, from the start of the cross-fade to it.
    #[getter]
    fn seconds(&self) -> f64 {
        self.with(|run| run.seconds())
    }

    /// How many times through that state's clips have played since it was entered: 0.5 is half of it.
    #[getter]
    fn played(&self) -> f64 {
        self.with(|run| run.played())
    }

    /// The names of that state's clips that play now, with their weights: [(clip, weight), ...].
    #[getter]
    fn playing(&self) -> Vec<(String, f32)> {
        let named = |(clip, weight): (&str, f32)| (clip.to_owned(), weight);
        self.with(|run| run.playing().map(named).collect())
    }

    /// How far the cross-fade to the state is, as the share of its time within [0, 1); None without one.
    #[getter]
    fn fading(&self) -> Option<f32> {
        self.with(|run| run.fading())
    }

    /// The state that a cross-fade comes from; None without one, or where it comes from the pose in which
    /// another one was broken off.
    #[getter]
    fn leaving(&self) -> Option<String> {
        self.with(|run| run.leaving().map(str::to_owned))
    }

    /// Whether the last update passed more events than it told.
    #[getter]
    fn events_left_out(&self) -> bool {
        self.with(|run| run.events_left_out())
    }

    /// All parameters with their values now: {name: number or bool}; a trigger is True until it is taken.
    #[getter]
    fn parameters<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let all: Vec<(String, ParameterValue)> = self.with(|run| {
            let all = run.parameters();
            all.map(|(name, value)| (name.to_owned(), value)).collect()
        });
        let values = PyDict::new(py);
        for (name, value) in all {
            match value {
                ParameterValue::Number(value) => values.set_item(name, value)?,
                ParameterValue::Flag(value) | ParameterValue::Trigger(value) => {
                    values.set_item(name, value)?;
                }
                _ => {}
            }
        }
        Ok(values)
    }

    /// Sets a number.
    ///
    /// Raises `UnknownNameError`, which lists the numbers.
    fn set_number(&self, name: &str, value: f32) -> PyResult<()> {
        self.with(|run| run.set_number(name, value)).or_raise()
    }

    /// Sets a flag.
    ///
    /// Raises `UnknownNameError`, which lists the flags.
    fn set_flag(&self, name: &str, value: bool) -> PyResult<()> {
        self.with(|run| run.set_flag(name, value)).or_raise()
    }

    /// Sets a trigger, until a transition takes it.
    ///
    /// Raises `UnknownNameError`, which lists the triggers.
    fn trigger(&self, name: &str) -> PyResult<()> {
        self.with(|run| run.trigger(name)).or_raise()
    }

    /// Takes a trigger back that no transition has taken.
    ///
    /// Raises `UnknownNameError`, which lists the triggers.
    fn clear_trigger(&self, name: &str) -> PyResult<()> {
        self.with(|run| run.clear_trigger(name)).or_raise()
    }

    fn __repr__(&self) -> String {
        format!("StateMachineRun({:?}, {} s)", self.state(), self.seconds())
    }
}
