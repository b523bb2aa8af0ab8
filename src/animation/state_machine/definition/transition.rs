//! What leads from state to state, as data.

use serde::{Deserialize, Serialize};

use crate::animation::Easing;

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
    /// Not before this share of the state's clips has played (1 is once through) since the state was
    /// entered, wherever in its clips that was.
    #[serde(default)]
    pub after: Option<f64>,
    /// Whether the state entered starts at the share of its clips at which those of the state are that the
    /// transition leads from, so that feet keep step; without it, at their start. One without `from` that
    /// breaks off a cross-fade leads from the first state that may break it off.
    #[serde(default)]
    pub in_step: bool,
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
#[non_exhaustive]
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
