//! `--surroundings`: ground under a movement, and an object in its hands.

use std::path::PathBuf;

use clap::Args;
use kinopt::motion::retarget::{HeldObject, RetargetError, Terrain};
use serde::Deserialize;
use serde_json::Value;

use crate::failure::Outcome;
use crate::file_access;

/// Surroundings of a movement.
#[derive(Args, Clone, Debug)]
pub(super) struct SurroundingsOptions {
    /// .json with the `terrain` under the movement and a `held_object`.
    #[arg(long, value_name = "FILE")]
    surroundings: Option<PathBuf>,
}

/// Terrain and held object.
#[derive(Clone, Debug, Default)]
pub(super) struct Surroundings {
    pub(super) terrain: Option<Terrain>,
    pub(super) object: Option<HeldObject>,
}

/// Content of the file.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Document {
    #[serde(default)]
    terrain: Option<Value>,
    #[serde(default)]
    held_object: Option<Value>,
}

impl SurroundingsOptions {
    /// Returns `true` if a file is given.
    pub(super) fn is_given(&self) -> bool {
        self.surroundings.is_some()
    }

    /// Reads the file.
    ///
    /// # Errors
    /// A missing or damaged file.
    pub(super) fn read(&self) -> Outcome<Surroundings> {
        let Some(path) = &self.surroundings else {
            return Ok(Surroundings::default());
        };
        let file = path.display();
        let text = file_access::text(path)?;
        let document: Document =
            serde_json::from_str(&text).map_err(|error| failure!("{file}: {error}"))?;
        let with_file = |error: RetargetError| failure!("{file}: {error}");
        let terrain = document
            .terrain
            .map(|value| Terrain::from_json(&value.to_string()));
        let object = document
            .held_object
            .map(|value| HeldObject::from_json(&value.to_string()));
        Ok(Surroundings {
            terrain: terrain.transpose().map_err(with_file)?,
            object: object.transpose().map_err(with_file)?,
        })
    }
}
