//! Map from joints to frames: from a file, by the name of a skeleton, or guessed from names.

use std::path::{Path, PathBuf};

use clap::Args;
use kinopt::model::Model;
use kinopt::motion::retarget::{
    BodyMap, BodyPart, HumanBones, KnownSkeleton, MapGuess, RetargetError, UpAxis,
};

use super::source::Source;
use crate::failure::Outcome;
use crate::file_access;
use crate::output;

/// Choice of the body map.
#[derive(Args, Debug)]
pub(crate) struct MapArgument {
    /// Body map .json, or cmu, lafan1, mixamo or smpl. Default: by names.
    #[arg(long, value_name = "FILE|NAME")]
    map: Option<PathBuf>,
}

/// Options of the body map.
#[derive(Args, Debug)]
pub(super) struct MapOptions {
    #[command(flatten)]
    pub(super) choice: MapArgument,

    /// Write the body map to a file.
    #[arg(long, value_name = "FILE")]
    pub(super) save_map: Option<PathBuf>,

    /// Print the body map. Without --out, stop after that.
    #[arg(long)]
    pub(super) print_map: bool,
}

/// Source of the body map.
#[derive(Debug)]
pub(crate) enum MapChoice {
    /// Path of the file, and its map.
    Given(String, BodyMap),
    Skeleton(KnownSkeleton),
    Guessed,
}

impl MapOptions {
    /// Returns `true` if the body map is an output.
    pub(super) fn outputs_map(&self) -> bool {
        self.print_map || self.save_map.is_some()
    }
}

impl MapArgument {
    /// File or name of the map, if given.
    pub(crate) fn file(&self) -> Option<&Path> {
        self.map.as_deref()
    }

    /// Reads the body map for the target file.
    pub(crate) fn read(&self, target: &Path) -> Outcome<MapChoice> {
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
    /// Body map of the file.
    pub(crate) fn given(&self) -> Option<&BodyMap> {
        match self {
            Self::Given(_, map) => Some(map),
            _ => None,
        }
    }

    /// Skeleton that the user named.
    pub(crate) fn skeleton(&self) -> Option<&KnownSkeleton> {
        match self {
            Self::Skeleton(skeleton) => Some(skeleton),
            _ => None,
        }
    }

    /// Body map from a capture to a model.
    pub(crate) fn of(
        &self,
        file: &str,
        source: &Source,
        model: &Model,
        human_bones: HumanBones,
    ) -> Outcome<MapGuess> {
        let capture = &source.capture;
        let with_file = |error: RetargetError| failure!("{file}: {error}");
        let guess = match self {
            Self::Given(_, map) => map.clone().completed(capture, model),
            Self::Skeleton(skeleton) => BodyMap::from_skeleton(skeleton, capture, model),
            Self::Guessed => {
                let mut map = BodyMap::default();
                map.human_bones = human_bones;
                match map.human_bones.is_empty() {
                    true => BodyMap::guess(capture, model),
                    false => map.completed(capture, model),
                }
            }
        };
        guess.map_err(|error| match self {
            Self::Given(map, _) if self.is_guessed() => {
                failure!("{map}: the map drives no frame of this target; {file}: {error}")
            }
            _ => with_file(error),
        })
    }

    /// Reports the origin of a guessed map, and its notes.
    pub(crate) fn report(&self, file: &str, guess: &MapGuess, up: UpAxis) {
        if self.is_guessed() {
            report_parts(file, guess);
        }
        report(file, guess, up);
    }

    /// Returns `true` if names determine the driven frames.
    fn is_guessed(&self) -> bool {
        self.given().is_none_or(|given| given.drives.is_empty())
    }

    /// Error with the file that caused it: the map or the source.
    pub(crate) fn failed(&self, file: &str, error: &RetargetError) -> crate::failure::Failure {
        match (self, error) {
            (Self::Given(map, _), error) if error.is_of_map() => failure!("{map}: {error}"),
            _ => failure!("{file}: {error}"),
        }
    }
}

/// Reports the names that a guess used.
fn report_parts(file: &str, guess: &MapGuess) {
    let source = |known: Option<&'static str>, names: &str| match known {
        Some(known) => format!("the {names} of {known}"),
        None => names.to_owned(),
    };
    output::message(&format!(
        "note: {file}: {} of {} body parts are driven, by {} and {}; --print-map lists them",
        guess.map.drives.len(),
        BodyPart::ALL.len(),
        source(guess.skeleton, "joints' names"),
        match guess.from_tree {
            true => "the robot's tree".to_owned(),
            false => source(guess.body, "frames' names"),
        },
    ));
}

/// Reports a suspicious up axis and the notes of a guess.
fn report(file: &str, guess: &MapGuess, up: UpAxis) {
    if let Some(along) = guess.up.filter(|along| *along != up) {
        let (along, up) = (along.name(), up.name());
        output::message(&format!(
            "note: {file}: the body is upright along {along}, but the up axis is {up}: --up {along} changes it"
        ));
    }
    for note in &guess.notes {
        output::message(&format!("note: {file}: {note}"));
    }
}
