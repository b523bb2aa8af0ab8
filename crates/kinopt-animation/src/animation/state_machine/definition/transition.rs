//! Definition of transitions and conditions.

use serde::{Deserialize, Serialize};

use crate::animation::Easing;

/// Transition between two states.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct TransitionDefinition {
    /// Source state; `None` for every state except the target.
    #[serde(default)]
    pub from: Option<String>,
    /// Target state.
    pub to: String,
    /// Duration of the cross-fade, seconds; 0 changes at once.
    #[serde(default)]
    pub seconds: f64,
    /// Easing of the cross-fade.
    #[serde(default)]
    pub easing: Easing,
    /// Least number of cycles of the state's clips since the state was entered, independent of their start position; 1
    /// is one full cycle.
    #[serde(default)]
    pub after: Option<f64>,
    /// Synchronised entry: the target starts at the same fraction of its clips as the source state, so that steps
    /// match. False starts the target's clips at their beginning. A transition without `from` that interrupts a
    /// cross-fade takes the first state that it may interrupt as source.
    #[serde(default)]
    pub in_step: bool,
    /// Least time in the state, seconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub after_seconds: Option<f64>,
    /// Conditions, all of which must hold.
    #[serde(default)]
    pub when: Vec<ConditionDefinition>,
    /// Transitions that may interrupt the cross-fade.
    #[serde(default)]
    pub interruption: Interruption,
}

/// Condition: a number above or below a bound, or a flag with a value. With none of these fields, a trigger that is
/// set.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct ConditionDefinition {
    /// Name of the parameter.
    pub parameter: String,
    /// The number must be greater than this.
    #[serde(default)]
    pub above: Option<f32>,
    /// The number must be less than this.
    #[serde(default)]
    pub below: Option<f32>,
    /// The flag must have this value.
    #[serde(default)]
    pub is: Option<bool>,
}

/// States whose transitions may interrupt a running cross-fade. The next cross-fade then starts from the pose at the
/// interruption, which is frozen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
#[non_exhaustive]
pub enum Interruption {
    /// None; the cross-fade ends first.
    #[default]
    Never,
    /// Transitions of the state that is being left.
    Source,
    /// Transitions of the state that is being entered.
    Target,
    /// Transitions of both states; those of the state being left come first.
    Either,
}
