//! Mapping of a captured hand to a robot hand.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::Finger;
use crate::motion::retarget::{Capture, RetargetError};
use kinopt_kinematics::model::Model;

/// Assignment of a captured finger to a frame of the robot hand.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FingerDrive {
    /// Captured joint at the base of the finger.
    pub base: String,
    /// Captured tip, or the last joint of the finger.
    pub tip: String,
    /// Frame of the robot hand at its fingertip.
    pub frame: String,
}

/// Mapping of a captured hand to a robot hand.
///
/// The thumb and at least two more fingers determine the palm.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HandMap {
    /// Captured joint of the wrist.
    pub wrist: String,
    /// Fingers that are driven.
    pub fingers: BTreeMap<Finger, FingerDrive>,
}

/// Smallest number of fingers next to the thumb.
const MIN_FINGERS: usize = 2;

impl HandMap {
    /// Parses a map from JSON: `{"wrist": "wrist", "fingers": {"thumb": {"base": "thumb_cmc", "tip": "thumb_tip", "frame":
    /// "thumb_tip"}}}`. Fingers are `thumb`, `index`, `middle`, `ring` and `little`.
    ///
    /// # Errors
    /// Returns an error, with its position, if the text is malformed.
    pub fn from_json(text: &str) -> Result<Self, RetargetError> {
        serde_json::from_str(text).map_err(|error| RetargetError::Map(error.to_string()))
    }

    /// Formats the map as JSON for [`from_json`](Self::from_json).
    #[must_use]
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// Guesses a map from names such as `thumb_tip`, `RightHandIndex3`, `fftip` and `index_tip_head`.
    ///
    /// The wrist is the joint that is named wrist or hand, or else the first one. `side`, such as `right`, selects the
    /// joints of one hand of a whole body.
    ///
    /// # Errors
    /// Returns an error, with some of the names, if the thumb or two more fingers are not found on both sides.
    pub fn guess(
        capture: &Capture,
        model: &Model,
        side: Option<&str>,
    ) -> Result<Self, RetargetError> {
        let side = side.map(str::to_lowercase);
        let on_side = |name: &&String| {
            side.as_ref()
                .is_none_or(|side| name.to_lowercase().contains(side))
        };
        let joints: Vec<&String> = capture.names().iter().filter(on_side).collect();
        let wrist = joints.iter().find(|name| {
            let bare = bare(name);
            bare.ends_with("wrist") || bare.ends_with("hand")
        });
        let Some(wrist) = wrist.or(joints.first()) else {
            return Err(RetargetError::NoBody {
                of: "the capture's joints",
                names: capture.names().join(", "),
            });
        };
        let frames: Vec<&String> = model.frames().iter().map(|frame| &frame.name).collect();
        let fingers = Finger::ALL.into_iter().filter_map(|finger| {
            let captured = of_finger(&joints, finger);
            let base = captured.first()?;
            let tip = captured
                .iter()
                .find(|name| bare(name).contains("tip"))
                .or(captured.last())?;
            let frame = tip_of(&frames, finger)?;
            let drive = FingerDrive {
                base: (*base).clone(),
                tip: (*tip).clone(),
                frame: frame.clone(),
            };
            (base != tip).then_some((finger, drive))
        });
        let map = Self {
            wrist: (*wrist).clone(),
            fingers: fingers.collect(),
        };
        match map.is_complete() {
            true => Ok(map),
            false => Err(RetargetError::Hand(format!(
                "names match only {}: a map needs the thumb and {MIN_FINGERS} more fingers; frames of the hand: {}",
                map.fingers
                    .keys()
                    .map(|finger| finger.name())
                    .collect::<Vec<_>>()
                    .join(", "),
                frames
                    .iter()
                    .map(|name| name.as_str())
                    .collect::<Vec<_>>()
                    .join(", "),
            ))),
        }
    }

    fn is_complete(&self) -> bool {
        self.fingers.contains_key(&Finger::Thumb) && self.fingers.len() > MIN_FINGERS
    }

    /// Checks that thumb and fingers exist.
    pub(super) fn check(&self) -> Result<(), RetargetError> {
        match self.is_complete() {
            true => Ok(()),
            false => Err(RetargetError::Hand(format!(
                "a map needs the thumb and {MIN_FINGERS} more fingers"
            ))),
        }
    }
}

/// Returns a name in lower case without separators.
fn bare(name: &str) -> String {
    name.chars()
        .filter(|c| c.is_alphanumeric())
        .flat_map(char::to_lowercase)
        .collect()
}

/// Returns the names with a word of a finger, in their order. Names with abbreviations begin with them.
fn of_words<'n>(names: &[&'n String], finger: Finger, is_abbreviated: bool) -> Vec<&'n String> {
    let words = finger.words().iter();
    let words: Vec<&str> = words
        .copied()
        .filter(|word| (word.len() == 2) == is_abbreviated)
        .collect();
    let names = names.iter().copied().filter(|name| {
        let bare = bare(name);
        words.iter().any(|word| match is_abbreviated {
            true => bare.starts_with(word),
            false => bare.contains(word),
        })
    });
    names.collect()
}

/// Returns the names of a finger, in their order.
fn of_finger<'n>(names: &[&'n String], finger: Finger) -> Vec<&'n String> {
    let by_word = of_words(names, finger, false);
    match by_word.is_empty() {
        true => of_words(names, finger, true),
        false => by_word,
    }
}

/// Returns the name of a finger's tip, or else of its last link.
fn tip_of<'n>(names: &[&'n String], finger: Finger) -> Option<&'n String> {
    let [by_word, by_abbreviation] =
        [false, true].map(|abbreviated| of_words(names, finger, abbreviated));
    let tip = |names: &[&'n String]| {
        names
            .iter()
            .rfind(|name| bare(name).contains("tip"))
            .copied()
    };
    let tip = tip(&by_word).or_else(|| tip(&by_abbreviation));
    tip.or_else(|| by_word.last().or(by_abbreviation.last()).copied())
}
