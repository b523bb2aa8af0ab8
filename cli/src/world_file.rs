//! Worlds from files, with their allowed collisions.

use std::path::Path;

use clap::Args;
use kinopt::collision::World;

use crate::failure::Outcome;
use crate::file_access;
use crate::help_headings::COLLISIONS;
use crate::output;

/// Allowed collisions with obstacles.
#[derive(Args, Clone, Debug)]
pub(crate) struct TouchOption {
    /// Allowed collision of two obstacles, or of a link and one. Default: the file's. Repeatable.
    #[arg(long, value_name = "NAME=NAME", value_parser = pair, requires = "world", help_heading = COLLISIONS, hide_short_help = true)]
    allow_collision: Vec<[String; 2]>,
}

impl TouchOption {
    /// World of [`read`], with the allowed collisions of the options.
    pub(crate) fn read(&self, file: Option<&Path>) -> Outcome<World> {
        let mut world = read(file)?;
        for [one, other] in &self.allow_collision {
            let allowed = world.allow_collision(one, other);
            allowed.map_err(|error| usage!("--allow-collision {one}={other}: {error}"))?;
        }
        Ok(world)
    }
}

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

/// Two names, separated by `=`.
fn pair(text: &str) -> Result<[String; 2], String> {
    match text.split_once('=') {
        Some((one, other)) if !one.trim().is_empty() && !other.trim().is_empty() => {
            Ok([one, other].map(|name| name.trim().to_owned()))
        }
        _ => Err("expected two names, such as left_foot=floor".to_owned()),
    }
}
