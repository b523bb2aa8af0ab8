//! Definition of a state machine, as read from JSON.

mod state;
mod transition;

pub use state::{BlendClip, BlendDefinition, MotionDefinition, StateDefinition};
pub use transition::{ConditionDefinition, Interruption, TransitionDefinition};

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Error, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

/// States that play clips or blends, and the transitions between them.
///
/// ```
/// # use kinopt::animation::StateMachineDefinition;
/// let definition: StateMachineDefinition = serde_json::from_str(
///     r#"{
///       "parameters": {"speed": 0.0, "grounded": true, "jump": "trigger"},
///       "initial": "idle",
///       "states": [
///         {"name": "idle", "clip": "stand"},
///         {"name": "move", "blend": {"parameter": "speed", "clips": [
///           {"at": 1.4, "clip": "walk"}, {"at": 4.0, "clip": "run"}
///         ]}},
///         {"name": "jump", "clip": "jump", "playback": "hold"}
///       ],
///       "transitions": [
///         {"from": "idle", "to": "move", "seconds": 0.2, "when": [{"parameter": "speed", "above": 0.1}]},
///         {"from": "move", "to": "idle", "seconds": 0.3, "when": [{"parameter": "speed", "below": 0.1}],
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
    /// Named parameters of conditions, with default values.
    #[serde(default, deserialize_with = "each_once")]
    pub parameters: BTreeMap<String, ParameterDefault>,
    /// Name of the initial state.
    pub initial: String,
    /// States, at least one.
    pub states: Vec<StateDefinition>,
    /// Transitions, in order of precedence.
    #[serde(default)]
    pub transitions: Vec<TransitionDefinition>,
}

/// Kind and default value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, Serialize)]
#[serde(
    untagged,
    expecting = "a parameter is `true` or `false`, a number, or \"trigger\""
)]
#[non_exhaustive]
pub enum ParameterDefault {
    /// Flag: `true` or `false`.
    Flag(bool),
    /// Number.
    Number(f32),
    /// `"trigger"`: set by an event, cleared by the transition that it causes.
    Trigger(TriggerWord),
}

impl ParameterDefault {
    /// Name of the kind, for messages.
    pub(super) fn kind(&self) -> &'static str {
        match self {
            Self::Flag(_) => "flag",
            Self::Number(_) => "number",
            Self::Trigger(_) => "trigger",
        }
    }
}

/// The word `"trigger"`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum TriggerWord {
    /// The word.
    Trigger,
}

/// Map in which a repeated name is an error.
fn each_once<'de, D: Deserializer<'de>>(
    from: D,
) -> Result<BTreeMap<String, ParameterDefault>, D::Error> {
    struct ParametersVisitor;
    impl<'de> Visitor<'de> for ParametersVisitor {
        type Value = BTreeMap<String, ParameterDefault>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("parameters by name")
        }

        fn visit_map<A: MapAccess<'de>>(self, mut entries: A) -> Result<Self::Value, A::Error> {
            let mut map = BTreeMap::new();
            while let Some((name, default)) = entries.next_entry::<String, _>()? {
                if map.contains_key(&name) {
                    return Err(A::Error::custom(format_args!("`{name}` is given twice")));
                }
                map.insert(name, default);
            }
            Ok(map)
        }
    }
    from.deserialize_map(ParametersVisitor)
}
