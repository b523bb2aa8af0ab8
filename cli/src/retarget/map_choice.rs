//! Map from joints to frames: from a file, by the name of a skeleton, or guessed from names.

use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::Model;
use kinopt::motion::retarget::{BodyMap, BodyPart, KnownSkeleton, MapGuess, RetargetError, UpAxis};

use super::source::Source;
use crate::failure::Outcome;
use crate::file_access;
use crate::output;

/// Where a map comes from.
#[derive(Args, Debug)]
pub(super) struct MapOptions {
    /// Which joint of the source drives which frame: a .json file, as below, which may hold several robots' drives under the
    /// names of their files, or none for this one; or the skeleton that the source is of: cmu, lafan1, mixamo or smpl. Default: as names tell.
    #[arg(long, value_name = "FILE|NAME")]
    map: Option<PathBuf>,

    /// Write the map that is taken, to be corrected by hand.
    #[arg(long, value_name = "FILE")]
    pub(super) save_map: Option<PathBuf>,

    /// Print the map that is taken; without --out do no more.
    #[arg(long)]
    pub(super) print_map: bool,
}

/// A map, or whose names tell of one.
#[derive(Debug)]
pub(super) enum MapChoice {
    /// Of a file, which is named.
    Given(String, BodyMap),
    Skeleton(KnownSkeleton),
    Guessed,
}

impl MapOptions {
    /// Whether the map alone is asked for.
    pub(super) fn asks_for_map(&self) -> bool {
        self.print_map || self.save_map.is_some()
    }

    /// Reads it, for a target's file.
    pub(super) fn read(&self, target: &Path) -> Outcome<MapChoice> {
        let Some(given) = &self.map else {
            return Ok(MapChoice::Guessed);
        };
        let file = given.display();
        let name = given.to_string_lossy();
        if given.components().count() == 1 && given.extension().is_none() && !given.exists() {
            return Ok(MapChoice::Skeleton(KnownSkeleton::named(&name).map_err(
                |error| usage!("--map {file}: no such file, and {error}"),
            )?));
        }
        let text = file_access::text(given)?;
        let robot = target.file_name().unwrap_or_default().to_string_lossy();
        let map = BodyMap::from_json(&text, &robot);
        let map = map.map_err(|error| failure!("{file}: {error}"))?;
        Ok(MapChoice::Given(file.to_string(), map))
    }
}

impl MapChoice {
    /// What a file says, for the source.
    pub(super) fn given(&self) -> Option<&BodyMap> {
        match self {
            Self::Given(_, map) => Some(map),
            _ => None,
        }
    }

    /// The skeleton that the source is said to be.
    pub(super) fn skeleton(&self) -> Option<&KnownSkeleton> {
        match self {
            Self::Skeleton(skeleton) => Some(skeleton),
            _ => None,
        }
    }

    /// The map from a capture to a model.
    pub(super) fn of(&self, file: &str, source: &Source, model: &Model) -> Outcome<MapGuess> {
        let capture = &source.capture;
        let told = |error: RetargetError| failure!("{file}: {error}");
        let guess = match self {
            Self::Given(_, map) => map.clone().completed(capture, model),
            Self::Skeleton(skeleton) => BodyMap::from_skeleton(skeleton, capture, model),
            Self::Guessed => BodyMap::guess(capture, model),
        };
        guess.map_err(|error| match self {
            Self::Given(map, _) if self.is_guessed() => {
                failure!("{map}: it drives nothing of this target, and of {file} {error}")
            }
            _ => told(error),
        })
    }

    /// Says of a guess what it is by, and what is to be looked at.
    pub(super) fn say(&self, file: &str, guess: &MapGuess, up: UpAxis) {
        if self.is_guessed() {
            say_parts(file, guess);
        }
        say(file, guess, up);
    }

    /// Whether names tell what drives what.
    fn is_guessed(&self) -> bool {
        self.given().is_none_or(|given| given.drives.is_empty())
    }

    /// What of it is wrong, with where it is from.
    pub(super) fn failed(&self, file: &str, error: &RetargetError) -> crate::failure::Failure {
        match (self, error) {
            (Self::Given(map, _), error) if error.is_of_map() => failure!("{map}: {error}"),
            _ => failure!("{file}: {error}"),
        }
    }
}

/// What a guess is by.
fn say_parts(file: &str, guess: &MapGuess) {
    let by = |known: Option<&'static str>, names: &str| match known {
        Some(known) => format!("the {names} of {known}"),
        None => format!("what {names} tell"),
    };
    output::message(&format!(
        "note: {file}: {} of {} parts are driven, by {} and {}; --print-map shows which",
        guess.map.drives.len(),
        BodyPart::ALL.len(),
        by(guess.skeleton, "joints' names"),
        by(guess.body, "frames' names"),
    ));
}

/// What is to be looked at.
fn say(file: &str, guess: &MapGuess, up: UpAxis) {
    if let Some(along) = guess.up.filter(|along| *along != up) {
        let name = |axis| match axis {
            UpAxis::Y => "y",
            UpAxis::Z => "z",
        };
        let (along, up) = (name(along), name(up));
        output::message(&format!(
            "note: {file}: the body stands along {along}, but {up} is taken for upward: --up {along} says otherwise"
        ));
    }
    for note in &guess.notes {
        output::message(&format!("note: {file}: {note}"));
    }
}
