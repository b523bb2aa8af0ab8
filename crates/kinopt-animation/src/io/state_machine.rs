//! Animation state machines in JSON; [`StateMachineDefinition`] describes the contents.

use std::path::Path;
use std::sync::Arc;

use super::{FileLocation, ReadError, read_with};
use crate::animation::{Clip, StateMachine, StateMachineDefinition};

/// Largest file size that is read, bytes.
const MAX_FILE_SIZE: u64 = 1 << 24;

/// Reads a state machine for the given clips.
///
/// # Errors
/// A [`ReadError`] that names the file and a path in it such as `transitions[2].to`. Errors for unknown names list the
/// valid ones.
pub fn read(path: impl AsRef<Path>, clips: &[Arc<Clip>]) -> Result<StateMachine, ReadError> {
    read_with(path.as_ref(), MAX_FILE_SIZE, |bytes, name| {
        from_bytes(bytes, name, clips)
    })
}

/// Reads a state machine from the bytes of a file. `name` is the file name for messages.
///
/// # Errors
/// As [`read`].
pub fn from_bytes(
    bytes: &[u8],
    name: &str,
    clips: &[Arc<Clip>],
) -> Result<StateMachine, ReadError> {
    let definition: StateMachineDefinition = kinopt_mesh::json::parse(bytes, name)?;
    StateMachine::new(&definition, clips).map_err(|error| {
        let location = FileLocation::Json(error.path);
        ReadError::malformed(name, location, error.problem.to_string())
    })
}
