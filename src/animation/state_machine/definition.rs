//! A state machine as data, as it stands in a JSON file.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use crate::animation::{Easing, Playback};

/// States that play clips, and what leads from one to another.
///
/// ```
/// # use kinopt::animation::StateMachineDefinition;
/// let definition: StateMachineDefinition = serde_json::from_str(
///     r#"{
///       "parameters": {"speed": 0.0, "grounded": true, "jump": "trigger"},
///       "initial": "idle",
///       "states": [
///         {"name": "idle", "clip": "stand"},
///         {"name": "walk", "clip": "walk", "speed": 1.2},
///         {"name": "jump", "clip": "jump", "playback": "hold"}
///       ],
///       "transitions": [
///         {"from": "idle", "to": "walk", "seconds": 0.2, "when": [{"parameter": "speed", "above": 0.1}]},
///         {"from": "walk", "to": "idle", "seconds": 0.3, "when": [{"parameter": "speed", "below": 0.1}],
///          "interruption": "target"},
///         {"to": "jump", "seconds": 0.1, "when": [{"parameter": "jump"}, {"parameter": "grounded", "is": true}]},
///         {"from": "jump", "to": "idle", "seconds": 0.2, "after": 0.9}
///       ]
///     }"#,
/// )?;
/// assert_eq!(definition.states.len(), 3);
/// # Ok::<(), serde_json::Error>(())
/// ```
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct StateMachineDefinition {
    /// Named values that conditions look at, and what they are at first.
    #[serde(default)]
    pub parameters: BTreeMap<String, ParameterDefault>,
    /// The name of the state to start in.
    pub initial: String,
    /// At least one.
    pub states: Vec<StateDefinition>,
    /// In order of precedence.
    #[serde(default)]
    pub transitions: Vec<TransitionDefinition>,
}

/// What kind of value a parameter has, and what it is at first.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(
    untagged,
    expecting = "a parameter is `true` or `false`, a number, or \"trigger\""
)]
pub enum ParameterDefault {
    /// A flag: `true` or `false`.
    Flag(bool),
    /// A number.
    Number(f32),
    /// `"trigger"`: set by an event, cleared by the transition that it causes.
    Trigger(TriggerWord),
}

/// The word `"trigger"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum TriggerWord {
    /// The word.
    Trigger,
}

/// A clip that plays while the machine is in a state.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct StateDefinition {
    /// Unique within the machine.
    pub name: String,
    /// The name of the clip.
    pub clip: String,
    /// What happens at the clip's end; it loops unless this says otherwise.
    #[serde(default = "looped")]
    pub playback: Playback,
    /// How many seconds of the clip pass in a second; negative plays backwards.
    #[serde(default = "one")]
    pub speed: f64,
}

fn looped() -> Playback {
    Playback::Loop
}

fn one() -> f64 {
    1.0
}

/// What leads from one state to another.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TransitionDefinition {
    /// The state it leaves; without one, every state but its own target.
    #[serde(default)]
    pub from: Option<String>,
    /// The state it leads to.
    pub to: String,
    /// How long the cross-fade takes; 0 changes at once.
    #[serde(default)]
    pub seconds: f64,
    /// How the cross-fade runs.
    #[serde(default)]
    pub easing: Easing,
    /// Not before this share of the state's clip has played (1 is once through).
    #[serde(default)]
    pub after: Option<f64>,
    /// Not before so many seconds in the state.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after_seconds: Option<f64>,
    /// All must hold.
    #[serde(default)]
    pub when: Vec<ConditionDefinition>,
    /// What may break off the cross-fade.
    #[serde(default)]
    pub interruption: Interruption,
}

/// Something that must be so: a number above or below a bound, a flag with a value, or, without any
/// of these, a trigger that is set.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ConditionDefinition {
    /// Which parameter it looks at.
    pub parameter: String,
    /// The number is greater than this.
    #[serde(default)]
    pub above: Option<f32>,
    /// The number is less than this.
    #[serde(default)]
    pub below: Option<f32>,
    /// The flag is this.
    #[serde(default)]
    pub is: Option<bool>,
}

/// Whose transitions may break off a cross-fade that is under way. The fade that follows starts from
/// the pose as it was then, held still.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Interruption {
    /// No transition: the cross-fade ends first.
    #[default]
    Never,
    /// Those of the state that is being left.
    Source,
    /// Those of the state that is being entered.
    Target,
    /// Both, the state's that is being left first.
    Either,
}
