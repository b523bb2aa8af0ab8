//! Worlds out of files.

use std::path::Path;

use kinopt::collision::World;

use crate::failure::Outcome;
use crate::output;

/// The world of a file, or one without obstacles; what was mended of its shapes, or not taken up, goes to standard error.
pub(crate) fn read(file: Option<&Path>) -> Outcome<World> {
    let world = match file {
        Some(file) => World::read(file)?,
        None => World::new(),
    };
    if let Some(file) = file {
        for note in world.notes() {
            output::message(&format!("note: {}: {note}", file.display()));
        }
    }
    for obstacle in world.obstacles() {
        for note in obstacle.shape.notes() {
            output::message(&format!("note: obstacle {}: {note}", obstacle.name));
        }
    }
    Ok(world)
}
