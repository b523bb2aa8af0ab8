//! `--keep-clear`: a robot that does not touch itself.

use clap::Args;
use kinopt::collision::Checker;
use kinopt::counted;
use kinopt::motion::retarget::Retargeted;
use kinopt::motion::retarget::folder::FolderQuestion;

use super::target::Target;
use crate::collision_options::{ShapeOptions, SphereOption};
use crate::failure::Outcome;
use crate::help_headings::COLLISIONS;
use crate::number_list::not_negative;
use crate::output;

/// Options about collisions.
#[derive(Args, Clone, Debug)]
pub(super) struct KeepClearOptions {
    /// Keep the robot's links apart in every frame, by so many metres. Default: not at all; of M: 0.
    ///
    /// By the exact distances of its collision shapes. Pairs of links are those that a thousand random configurations neither never
    /// nor always have touching.
    #[arg(long, value_name = "M", num_args = 0..=1, default_missing_value = "0", value_parser = not_negative, help_heading = COLLISIONS)]
    keep_clear: Option<f64>,

    #[command(flatten)]
    shapes: ShapeOptions,

    #[command(flatten)]
    spheres: SphereOption,
}

impl KeepClearOptions {
    /// Says in a folder's question what is kept clear, and by which shapes unless by the usual ones.
    pub(super) fn ask(&self, question: &mut FolderQuestion<'_>) {
        question.keep_clear = self.keep_clear;
        if self.keep_clear.is_some() {
            question.more.extend(self.shapes.told());
        }
    }

    /// What is to be kept clear of, if anything is.
    ///
    /// # Errors
    /// A figure, and a robot without shapes.
    pub(super) fn checker(&self, target: &Target) -> Outcome<Option<Checker>> {
        let Some(margin) = self.keep_clear else {
            return Ok(None);
        };
        if target.loaded.robot.is_none() {
            return Err(usage!(
                "--keep-clear is for robots with collision shapes, and {} is a {}",
                target.loaded.file,
                target.loaded.kind()
            ));
        }
        let checker = self.spheres.checker(self.shapes.model(&target.robot)?)?;
        Ok(Some(checker.with_margin(margin)?))
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
