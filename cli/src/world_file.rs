//! Worlds from files.

use std::path::Path;

use kinopt::collision::World;

use crate::failure::Outcome;
use crate::file_access;
use crate::output;

/// World of a file, or an empty one. Notes about repaired and omitted shapes go to standard error.
pub(crate) fn read(file: Option<&Path>) -> Outcome<World> {
    let Some(file) = file else {
        return Ok(World::new());
    };
    let world = World::read_with(file, &file_access::allowed())?;
    for note in world.notes() {
        output::message(&format!("note: {}: {note}", file.display()));
    }
    Ok(world)
}
