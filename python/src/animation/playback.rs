//! Playback modes outside the span of a clip.

use kinopt::animation::Playback;
use kinopt::model::UnknownName;
use pyo3::prelude::*;

use crate::error::OrRaise;

/// Names, as in files of state machines.
const NAMES: [(&str, Playback); 3] = [
    ("hold", Playback::Hold),
    ("loop", Playback::Loop),
    ("ping_pong", Playback::PingPong),
];

/// Returns a playback mode by its name.
pub(crate) fn of(name: &str) -> PyResult<Playback> {
    let entry = NAMES.iter().find(|(known, _)| *known == name);
    entry
        .map(|(_, playback)| *playback)
        .ok_or_else(|| UnknownName::new("playback", name, NAMES.map(|(name, _)| name)))
        .or_raise()
}
