//! What plays in a state, as data.

use serde::{Deserialize, Serialize};

use crate::animation::Playback;

/// What plays while the machine is in a state.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "StateData", into = "StateData")]
pub struct StateDefinition {
    /// Unique within the machine.
    pub name: String,
    /// A clip, or several.
    pub motion: MotionDefinition,
    /// What happens at the clips' ends; they loop unless this says otherwise.
    pub playback: Playback,
    /// How many seconds of the clips pass in a second; negative plays backwards.
    pub speed: f64,
}

/// One clip, or several between which a number chooses.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MotionDefinition {
    /// The name of a clip: in JSON, `clip`.
    Clip(String),
    /// In JSON, `blend`.
    Blend(BlendDefinition),
}

/// Clips along a number: walking and running by speed. Between two clips' numbers the pose is the
/// cross-fade of theirs by the share of the way; beyond the ends it is the end's. The clips keep step:
/// all are at the same share of their length, which passes in the mean of the lengths by those shares
/// (clips that last no time, mere poses, do not count).
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BlendDefinition {
    /// The name of a parameter that is a number.
    pub parameter: String,
    /// At least one, by rising numbers.
    pub clips: Vec<BlendClip>,
}

/// A clip of a blend.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BlendClip {
    /// The number at which it plays alone.
    pub at: f32,
    /// The name of the clip.
    pub clip: String,
}

/// A state as it stands in a file.
#[derive(Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
struct StateData {
    name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    clip: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    blend: Option<BlendDefinition>,
    #[serde(default = "looped")]
    playback: Playback,
    #[serde(default = "one")]
    speed: f64,
}

fn looped() -> Playback {
    Playback::Loop
}

fn one() -> f64 {
    1.0
}

impl TryFrom<StateData> for StateDefinition {
    type Error = String;

    fn try_from(data: StateData) -> Result<Self, String> {
        let motion = match (data.clip, data.blend) {
            (Some(clip), None) => MotionDefinition::Clip(clip),
            (None, Some(blend)) => MotionDefinition::Blend(blend),
            (Some(_), Some(_)) => {
                return Err(format!(
                    "state `{}` has both `clip` and `blend`; it plays one of them",
                    data.name
                ));
            }
            (None, None) => {
                return Err(format!(
                    "state `{}` has neither `clip` nor `blend`",
                    data.name
                ));
            }
        };
        Ok(Self {
            name: data.name,
            motion,
            playback: data.playback,
            speed: data.speed,
        })
    }
}

impl From<StateDefinition> for StateData {
    fn from(state: StateDefinition) -> Self {
        let (clip, blend) = match state.motion {
            MotionDefinition::Clip(clip) => (Some(clip), None),
            MotionDefinition::Blend(blend) => (None, Some(blend)),
        };
        Self {
            name: state.name,
            clip,
            blend,
            playback: state.playback,
            speed: state.speed,
        }
    }
}
