//! Definition of a state.

use serde::{Deserialize, Serialize};

use crate::animation::Playback;

/// State of a machine: name, clips and playback.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(try_from = "StateData", into = "StateData")]
pub struct StateDefinition {
    /// Unique within the machine.
    pub name: String,
    /// A clip or a blend of clips.
    pub motion: MotionDefinition,
    /// Playback mode of the clips; the default is loop.
    pub playback: Playback,
    /// Clip seconds per second; negative plays backwards.
    pub speed: f64,
}

/// One clip, or clips blended by a parameter.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum MotionDefinition {
    /// Name of a clip; `clip` in JSON.
    Clip(String),
    /// Blend of clips; `blend` in JSON.
    Blend(BlendDefinition),
}

/// One-dimensional blend of clips by a number, such as walking and running by speed. The pose is a cross-fade of the
/// two clips whose numbers enclose the parameter. Outside the range it is that of the end clip.
///
/// The clips are synchronised: all are at the same fraction of their duration. The cycle takes the weighted mean of
/// their durations; clips of zero duration do not count.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BlendDefinition {
    /// Name of a number parameter.
    pub parameter: String,
    /// Clips in increasing order of `at`; at least one.
    pub clips: Vec<BlendClip>,
}

/// A clip of a blend.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields)]
pub struct BlendClip {
    /// Parameter value at which the clip plays alone.
    pub at: f32,
    /// Name of the clip.
    pub clip: String,
}

/// State in the file format.
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
