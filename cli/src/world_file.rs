//! Worlds out of files.

use std::path::Path;

use kinopt::collision::World;

use crate::failure::Outcome;
use crate::output;

/// The world of a file, or one without obstacles; what was mended of its shapes goes to standard error.
pub(crate) fn read(file: Option<&Path>) -> Outcome<World> {
    let world = match file {
        Some(file) => World::read(file)?,
        None => World::new(),
    };
    for obstacle in world.obstacles() {
        for note in obstacle.shape.notes() {
            output::message(&format!("note: obstacle {}: {note}", obstacle.name));
        }
    }
    Ok(world)
}
