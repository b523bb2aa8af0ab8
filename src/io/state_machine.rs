//! Animation state machines in JSON; see
//! [`StateMachineDefinition`] for what the file holds.

use std::path::Path;
use std::sync::Arc;

use super::{Place, ReadError, read_with};
use crate::animation::{Clip, StateMachine, StateMachineDefinition};

/// The longest file that is read.
const LIMIT: u64 = 1 << 24;

/// Reads a state machine that plays these clips.
///
/// # Errors
/// A [`ReadError`] naming the file and a path in it such as `transitions[2].to`; unknown names come
/// with the valid ones.
pub fn read(path: impl AsRef<Path>, clips: &[Arc<Clip>]) -> Result<StateMachine, ReadError> {
    read_with(path.as_ref(), LIMIT, |bytes, name| {
        from_bytes(bytes, name, clips)
    })
}

/// Reads a state machine from the bytes of its file; `name` is for messages.
///
/// # Errors
/// As [`read`].
pub fn from_bytes(
    bytes: &[u8],
    name: &str,
    clips: &[Arc<Clip>],
) -> Result<StateMachine, ReadError> {
    let definition: StateMachineDefinition = super::json::parse(bytes, name)?;
    StateMachine::new(&definition, clips).map_err(|error| {
        let place = Place::Json(error.path);
        ReadError::malformed(name, place, error.problem.to_string())
    })
}
