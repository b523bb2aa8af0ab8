//! Animation state machines: clips by state, with cross-fades between states.

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

/// Validated states, transitions and clips. Immutable; each running character has a `StateMachineRun`.
///
/// Its JSON names parameters with their initial values (a number, true or false, or "trigger"), the initial state,
/// states that play clips by name, and transitions with their conditions:
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
/// A transition without "from" leaves any state. "seconds" is the duration of its cross-fade, "after" the fraction of
/// the clip that must have played. A condition is "is", "above" or "below" a value, and nothing for a trigger.
/// "playback" is "hold", "loop" or "ping_pong", "speed" a factor.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct StateMachine {
    inner: Arc<Machine>,
    armature: Arc<Bones>,
    /// JSON text of the machine.
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
    /// Reads the JSON file of a state machine that plays these clips, all of one armature.
    ///
    /// Raises `FileError` if the file cannot be opened, `InvalidFileError` with the file and a path in it such as
    /// `transitions[2].to`.
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

    /// Reads a state machine from JSON, a text or bytes; `name` is its name in messages.
    ///
    /// Raises `InvalidFileError` with a path in it such as `transitions[2].to`.
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

    /// Names of the states.
    #[getter]
    fn states(&self) -> Vec<&str> {
        self.inner.states().collect()
    }

    /// Clips of the machine.
    #[getter]
    fn clips(&self, py: Python<'_>) -> Vec<Py<Clip>> {
        self.clips.iter().map(|clip| clip.clone_ref(py)).collect()
    }

    /// Armature of its clips.
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

/// State of one character in a machine: its parameters, its current state, and the current cross-fade. It holds running
/// state, so it cannot be pickled.
///
/// The character starts in the machine's initial state.
#[pyclass(frozen, module = "kinopt.animation")]
pub(crate) struct StateMachineRun {
    inner: Mutex<Run>,
    armature: Arc<Bones>,
}

impl StateMachineRun {
    /// Calls a function that creates no Python objects, with the run locked.
    fn with<T>(&self, run: impl FnOnce(&mut Run) -> T) -> T {
        run(&mut self.inner.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Event of a clip: the state, the clip, the name of the event, its time in the clip, and the weight of the clip at
/// that time.
type FiredEvent = (String, String, String, f32, f32);

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

    /// Advances by `seconds`: plays the clips, takes transitions at the times when they become possible, and blends.
    /// The result does not depend on the step size.
    ///
    /// Returns the events of the played clips, at most 1024 of them: [(state, clip, event, time in the clip, weight),
    /// ...]. Negative seconds count as 0.
    ///
    /// Raises `InvalidValueError` for seconds that are not finite.
    fn update(&self, py: Python<'_>, seconds: f64) -> PyResult<Vec<FiredEvent>> {
        let seconds = arrays::finite(seconds, "seconds")?;
        let mut events: Vec<FiredEvent> = Vec::new();
        let updated = py.detach(|| {
            self.with(|run| {
                run.update(seconds, |event| {
                    events.push((
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
        Ok(events)
    }

    /// Pose after the last update, as a new object.
    #[getter]
    fn pose(&self) -> Pose {
        Pose::of(&self.armature, self.with(|run| run.pose().clone()))
    }

    /// Current state, or the target state of a cross-fade.
    #[getter]
    fn state(&self) -> String {
        self.with(|run| run.state().to_owned())
    }

    /// Time in that state, in seconds, from the start of the cross-fade to it.
    #[getter]
    fn seconds(&self) -> f64 {
        self.with(|run| run.seconds())
    }

    /// Number of plays of that state's clip since it was entered: 0.5 is half of it.
    #[getter]
    fn played(&self) -> f64 {
        self.with(|run| run.played())
    }

    /// Names of that state's clips in playback, with their weights: [(clip, weight), ...].
    #[getter]
    fn playing(&self) -> Vec<(String, f32)> {
        let named = |(clip, weight): (&str, f32)| (clip.to_owned(), weight);
        self.with(|run| run.playing().map(named).collect())
    }

    /// Progress of the cross-fade to the state, within [0, 1); None without one.
    #[getter]
    fn fading(&self) -> Option<f32> {
        self.with(|run| run.fading())
    }

    /// Source state of a cross-fade; None without one, or if it starts from the pose of an interrupted cross-fade.
    #[getter]
    fn leaving(&self) -> Option<String> {
        self.with(|run| run.leaving().map(str::to_owned))
    }

    /// True if the last update passed more events than it returned.
    #[getter]
    fn events_left_out(&self) -> bool {
        self.with(|run| run.events_left_out())
    }

    /// All parameters with their current values: {name: number or bool}; a trigger is True until a transition uses it.
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

    /// Sets a trigger, until a transition uses it.
    ///
    /// Raises `UnknownNameError`, which lists the triggers.
    fn trigger(&self, name: &str) -> PyResult<()> {
        self.with(|run| run.trigger(name)).or_raise()
    }

    /// Clears a trigger that no transition has used.
    ///
    /// Raises `UnknownNameError`, which lists the triggers.
    fn clear_trigger(&self, name: &str) -> PyResult<()> {
        self.with(|run| run.clear_trigger(name)).or_raise()
    }

    fn __repr__(&self) -> String {
        format!("StateMachineRun({:?}, {} s)", self.state(), self.seconds())
    }
}
