//! `--keep-clear`, `--world` and `--margin`: collision avoidance of a robot with itself and a world.

use std::path::PathBuf;

use clap::Args;
use kinopt::collision::{Checker, World};
use kinopt::counted;
use kinopt::motion::retarget::Retargeted;
use kinopt::motion::retarget::folder::FolderQuestion;

use super::target::Target;
use crate::choices::first_given;
use crate::collision_options::{ShapeOptions, SphereOption};
use crate::failure::Outcome;
use crate::help_headings::COLLISIONS;
use crate::number_list::not_negative;
use crate::output;
use crate::world_file::TouchOption;

/// How many times as large obstacles are made.
#[derive(Clone, Copy, Debug, PartialEq)]
enum WorldScale {
    Times(f64),
    /// As many as the robot's steps are longer than the person's.
    Stride,
}

impl WorldScale {
    fn parse(text: &str) -> Result<Self, String> {
        match (text, text.parse::<f64>()) {
            ("stride", _) => Ok(Self::Stride),
            (_, Ok(times)) if times > 0.0 && times.is_finite() => Ok(Self::Times(times)),
            _ => Err("a number above 0, or stride".into()),
        }
    }
}

/// Options about collisions.
#[derive(Args, Clone, Debug)]
pub(super) struct KeepClearOptions {
    /// Keep the robot's links apart in every frame, by so many metres. Default: not at all; of M: 0.
    ///
    /// By the exact distances of its collision shapes. Pairs of links are those that a thousand random configurations neither never
    /// nor always have touching.
    #[arg(long, value_name = "M", num_args = 0..=1, default_missing_value = "0", value_parser = not_negative, help_heading = COLLISIONS)]
    keep_clear: Option<f64>,

    /// Keep the robot clear of the obstacles of a file in every frame, and of itself.
    ///
    /// Our JSON (`{"boxes": [{"name", "size", "position", "quaternion"}], "spheres": …}`), or a planning scene of MoveIt's (.yaml), in
    /// metres where the robot goes. Feet stand on obstacles as on the ground. Default: nothing is in the way.
    #[arg(long, value_name = "FILE", help_heading = COLLISIONS)]
    world: Option<PathBuf>,

    /// How many times as large the obstacles are, and as far from the origin: a number, or `stride` where they stood about the person,
    /// for as many as the robot's steps are. Default: 1.
    #[arg(long, value_name = "TIMES", value_parser = WorldScale::parse, requires = "world", help_heading = COLLISIONS)]
    world_scale: Option<WorldScale>,

    /// How far all is to be apart at least, in metres; without --world of the robot's own links, as --keep-clear. Default: 0.
    #[arg(long, value_name = "M", value_parser = not_negative, conflicts_with = "keep_clear", help_heading = COLLISIONS)]
    margin: Option<f64>,

    #[command(flatten)]
    touch: TouchOption,

    #[command(flatten)]
    shapes: ShapeOptions,

    #[command(flatten)]
    spheres: SphereOption,
}

/// What is to be kept clear of, and in which world.
#[derive(Clone, Debug)]
pub(super) struct Clear {
    checker: Checker,
    /// The obstacles of a file, if one was given.
    world: Option<World>,
    /// Whether they stood about the person.
    of_person: bool,
}

impl Clear {
    /// What a movement is kept clear of whose steps are so many times as large as the person's.
    ///
    /// # Errors
    /// Obstacles that are then too small or too large.
    pub(super) fn at_stride(&self, stride: f64) -> Outcome<Checker> {
        let checker = self.checker.clone();
        Ok(match &self.world {
            Some(world) if self.of_person => checker.with_world(&world.scaled(stride)?)?,
            _ => checker,
        })
    }

    /// Says in a folder's question what is kept clear.
    pub(super) fn ask(&self, question: &mut FolderQuestion<'_>) {
        question.keep_clear = Some(self.checker.margin());
        question.world = self.world.as_ref().map(World::to_json);
        let note = self.of_person.then(|| "world of the person".to_owned());
        question.more.extend(note);
    }
}

impl KeepClearOptions {
    /// By which shapes, unless by the usual ones.
    pub(super) fn unusual_shapes(&self) -> Option<String> {
        self.shapes.unusual()
    }

    /// The first of the options that was given.
    fn given(&self) -> Option<&'static str> {
        first_given([
            ("--keep-clear", self.keep_clear.is_some()),
            ("--world", self.world.is_some()),
            ("--margin", self.margin.is_some()),
        ])
    }

    /// What is to be kept clear of, if anything is.
    ///
    /// # Errors
    /// A figure, a robot without shapes, and a file that is not there or damaged.
    pub(super) fn clear(&self, target: &Target) -> Outcome<Option<Clear>> {
        let Some(option) = self.given() else {
            return Ok(None);
        };
        if target.loaded.robot.is_none() {
            return Err(usage!(
                "{option} is for robots with collision shapes, and {} is a {}",
                target.loaded.file,
                target.loaded.kind()
            ));
        }
        let mut world = self.touch.read(self.world.as_deref())?;
        if let Some(WorldScale::Times(times)) = self.world_scale {
            world = world.scaled(times)?;
        }
        let checker = self.spheres.checker(self.shapes.model(&target.robot)?)?;
        let margin = self.margin.or(self.keep_clear).unwrap_or(0.0);
        Ok(Some(Clear {
            checker: checker.with_world(&world)?.with_margin(margin)?,
            world: self.world.is_some().then_some(world),
            of_person: self.world_scale == Some(WorldScale::Stride),
        }))
    }
}

/// Tells of frames that touch all the same.
pub(super) fn tell_touching(file: &str, found: &Retargeted) {
    if let Some(first) = found.touching.first() {
        let frames = counted(found.touching.len(), "frame");
        let (frame, pair) = (first.frame, &first.pair);
        output::message(&format!(
            "note: {file}: in {frames} something touches all the same, first in frame {frame}: {pair}"
        ));
    }
}
