//! `--terrain`, `--object`: ground under a movement, and an object in its hands.

use std::path::PathBuf;

use clap::Args;
use kinopt::motion::retarget::{HeldObject, Terrain};

use crate::failure::Outcome;
use crate::file_access;

/// Terrain and held object of a movement.
#[derive(Args, Clone, Debug)]
pub(super) struct SurroundingsOptions {
    /// Steps and slopes .json onto which the movement is moved.
    #[arg(long, value_name = "FILE")]
    terrain: Option<PathBuf>,

    /// Box or ball .json in the hands, with its pose in each frame.
    #[arg(long, value_name = "FILE")]
    object: Option<PathBuf>,
}

/// Terrain and held object.
#[derive(Clone, Debug)]
pub(super) struct Surroundings {
    pub(super) terrain: Option<Terrain>,
    pub(super) object: Option<HeldObject>,
}

impl SurroundingsOptions {
    /// Returns `true` if a terrain is given.
    pub(super) fn has_terrain(&self) -> bool {
        self.terrain.is_some()
    }

    /// Returns `true` if an object is given.
    pub(super) fn has_object(&self) -> bool {
        self.object.is_some()
    }

    /// Reads the files.
    ///
    /// # Errors
    /// A missing or damaged file.
    pub(super) fn read(&self) -> Outcome<Surroundings> {
        let text = |file: &Option<PathBuf>| match file {
            Some(file) => Ok(Some((file.display().to_string(), file_access::text(file)?))),
            None => Outcome::Ok(None),
        };
        let terrain = text(&self.terrain)?.map(|(file, text)| {
            Terrain::from_json(&text).map_err(|error| failure!("{file}: {error}"))
        });
        let object = text(&self.object)?.map(|(file, text)| {
            HeldObject::from_json(&text).map_err(|error| failure!("{file}: {error}"))
        });
        Ok(Surroundings {
            terrain: terrain.transpose()?,
            object: object.transpose()?,
        })
    }
}
