//! Options of the subject and of the score.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use kinopt::motion::path::QuaternionOrder;
use kinopt::motion::retarget::{BodyMap, HumanBones};
use kinopt::motion::score::{Heading, MotionScorer, ScoreWeights};
use kinopt::robot::Robot;
use kinopt_bindings::problem_file::number_list;

use crate::failure::Outcome;
use crate::retarget::contact_options::ContactOptions;
use crate::retarget::map_choice::MapArgument;
use crate::retarget::source::{BodyOptions, Source, SourceOptions, Up};

/// Order of the numbers of a quaternion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum QuaternionArgument {
    Xyzw,
    Wxyz,
}

impl From<QuaternionArgument> for QuaternionOrder {
    fn from(order: QuaternionArgument) -> Self {
        match order {
            QuaternionArgument::Xyzw => Self::WLast,
            QuaternionArgument::Wxyz => Self::WFirst,
        }
    }
}

/// Options of the subject.
#[derive(Args, Debug)]
pub(super) struct SubjectOptions {
    /// Capture of the person, as the SOURCE of `kinopt retarget`.
    #[arg(long, value_name = "CAPTURE")]
    subject: Option<PathBuf>,

    #[command(flatten)]
    map: MapArgument,

    /// Up axis of the capture, y or z. Default: the map's, else detected.
    #[arg(long, value_enum, value_name = "AXIS", hide_possible_values = true)]
    up: Option<Up>,

    /// Clip of the capture's scene. Default: the first.
    #[arg(long, value_name = "NAME")]
    clip: Option<String>,

    /// Frames per second of the capture. Default: as in `kinopt retarget`.
    #[arg(long, value_name = "N", value_parser = number_list::positive)]
    subject_fps: Option<f64>,

    #[command(flatten)]
    body: BodyOptions,
}

/// Person of a motion.
#[derive(Debug)]
pub(super) struct Subject {
    pub(super) file: String,
    pub(super) source: Source,
    pub(super) map: BodyMap,
}

impl SubjectOptions {
    /// Reads the capture and its map to a robot.
    pub(super) fn read(&self, robot_file: &Path, robot: &Robot) -> Outcome<Option<Subject>> {
        let Some(path) = &self.subject else {
            return Ok(None);
        };
        let choice = self.map.read(robot_file)?;
        let options = SourceOptions {
            fps: self.subject_fps,
            clip: self.clip.clone(),
            up: self.up,
            body: self.body.clone(),
        };
        let source = options.read(path, choice.given(), choice.skeleton())?;
        let file = path.display().to_string();
        let guess = choice.of(&file, &source, robot.model(), HumanBones::default())?;
        choice.report(&file, &guess, source.up);
        let mut map = guess.map;
        // The option has priority over the map.
        map.up = Some(source.up);
        Ok(Some(Subject { file, source, map }))
    }
}

/// Options of the score.
#[derive(Args, Debug)]
pub(super) struct ScoreOptions {
    /// Time of the capture at which the motion begins, in s. Default: 0.
    #[arg(long, value_name = "S", value_parser = number_list::not_negative)]
    start: Option<f64>,

    /// Heading of the motion in degrees, or `fit`. Default: multiple of 90 that fits.
    #[arg(long, value_name = "DEG|fit", value_parser = heading)]
    heading: Option<Heading>,

    /// Height of the ground in m. Default: 0.
    #[arg(long, value_name = "M")]
    ground: Option<f64>,

    /// Weights of the total, such as limbs=1,jerk=0.
    #[arg(long, value_name = "NAME=W,...", value_parser = weights)]
    weights: Option<ScoreWeights>,

    /// Check self-collisions.
    #[arg(long)]
    pub(super) collisions: bool,

    #[command(flatten)]
    contacts: ContactOptions,
}

impl ScoreOptions {
    /// Applies the options to a scorer.
    pub(super) fn apply<'r>(&self, scorer: MotionScorer<'r>) -> MotionScorer<'r> {
        scorer
            .with_start(self.start.unwrap_or(0.0))
            .with_heading(self.heading.unwrap_or_default())
            .with_ground(self.ground.unwrap_or(0.0))
            .with_weights(self.weights.unwrap_or_default())
            .with_contacts(self.contacts.detection())
    }
}

fn heading(text: &str) -> Result<Heading, String> {
    match (text, text.parse::<f64>()) {
        ("fit", _) => Ok(Heading::Fitted),
        (_, Ok(degrees)) if degrees.is_finite() => Ok(Heading::Fixed(degrees.to_radians())),
        _ => Err("expected degrees, or `fit`".to_owned()),
    }
}

fn weights(text: &str) -> Result<ScoreWeights, String> {
    let mut weights = ScoreWeights::default();
    for pair in text.split(',') {
        let malformed = || format!("`{pair}`: expected NAME=WEIGHT");
        let (name, weight) = pair.split_once('=').ok_or_else(malformed)?;
        let weight: f64 = weight.trim().parse().map_err(|_| malformed())?;
        let set = weights.set(name.trim(), weight);
        set.map_err(|error| error.to_string())?;
    }
    Ok(weights)
}
