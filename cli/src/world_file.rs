//! Worlds from files, with their allowed collisions.

use std::path::Path;

use clap::Args;
use kinopt::collision::World;

use crate::failure::Outcome;
use crate::file_access;
use crate::help_headings::COLLISIONS;
use crate::output;

/// What may touch obstacles.
#[derive(Args, Clone, Debug)]
pub(crate) struct TouchOption {
    /// Let a link of the robot and an obstacle of --world touch, or two obstacles, however deep; repeat it for several pairs.
    /// Default: what the file's own `may_touch` says.
    #[arg(long, value_name = "NAME=NAME", value_parser = pair, requires = "world", help_heading = COLLISIONS, hide_short_help = true)]
    allow_collision: Vec<[String; 2]>,
}

impl TouchOption {
    /// As [`read`], with what may touch besides.
    pub(crate) fn read(&self, file: Option<&Path>) -> Outcome<World> {
        let mut world = read(file)?;
        for [one, other] in &self.allow_collision {
            let allowed = world.allow_collision(one, other);
            allowed.map_err(|error| usage!("--allow-collision {one}={other}: {error}"))?;
        }
        Ok(world)
    }
}

/// The world of a file, or one without obstacles; what was mended of its shapes, or not taken up, goes to standard error.
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

/// Two names.
fn pair(text: &str) -> Result<[String; 2], String> {
    match text.split_once('=') {
        Some((one, other)) if !one.trim().is_empty() && !other.trim().is_empty() => {
            Ok([one, other].map(|name| name.trim().to_owned()))
        }
        _ => Err("two names are expected, as left_foot=floor".to_owned()),
    }
}
