//! `--world` and `--margin`: what an arm keeps clear of.

use std::path::PathBuf;

use clap::Args;
use kinopt::arm::Arm;
use kinopt::collision::{Checker, World};
use kinopt::robot::{Robot, Srdf};

use crate::collision_options::ShapeOptions;
use crate::failure::Outcome;
use crate::help_headings::{COLLISIONS, TARGETS};
use crate::number_list::not_negative;

/// Options about collisions.
#[derive(Args, Clone, Debug)]
pub(crate) struct ObstacleArguments {
    /// Keep clear of the obstacles of a file, and of oneself. A robot's arm only.
    ///
    /// Our JSON (`{"boxes": [{"name", "size", "position", "quaternion"}], "spheres": …}`), or a planning scene of MoveIt's
    /// (.yaml). Default: nothing is in the way. An answer is reached only if it touches nothing, by the exact distances of the
    /// robot's collision shapes; the pairs that touch are told otherwise. Of a path nothing touches between its points
    /// either. Pairs of links are those that a thousand random configurations neither never nor always have touching, less
    /// those that --srdf disables.
    #[arg(long, value_name = "FILE", help_heading = TARGETS)]
    world: Option<PathBuf>,

    /// How far all is to be apart at least, in metres; without --world of the robot's own links. Default: 0.
    #[arg(long, value_name = "M", value_parser = not_negative, help_heading = COLLISIONS, hide_short_help = true)]
    margin: Option<f64>,

    #[command(flatten)]
    shapes: ShapeOptions,
}

impl ObstacleArguments {
    /// The first of the options that was given.
    pub(super) fn given(&self) -> Option<&'static str> {
        let world = self.world.as_ref().map(|_| "--world");
        world.or(self.margin.map(|_| "--margin"))
    }

    /// The arm kept clear of what is given, with the robot's other joints at `rest`.
    pub(crate) fn keep_clear(
        &self,
        arm: Arm,
        robot: &Robot,
        srdf: Option<&PathBuf>,
        rest: &[f64],
    ) -> Outcome<Arm> {
        if self.given().is_none() {
            return Ok(arm);
        }
        let mut model = self.shapes.model(robot)?;
        if let Some(file) = srdf {
            model = model.with_srdf(&Srdf::read(file, robot)?);
        }
        let world = match &self.world {
            Some(file) => World::read(file)?,
            None => World::new(),
        };
        let checker = Checker::sampled(model).with_world(&world)?;
        let checker = checker.with_margin(self.margin.unwrap_or(0.0))?;
        Ok(arm.with_checker(&checker, rest)?)
    }
}
