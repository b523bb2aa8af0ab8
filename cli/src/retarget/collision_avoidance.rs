//! Collision avoidance of a robot with itself and a world.

use clap::Args;
use kinopt::collision::{Checker, World};
use kinopt::counted;
use kinopt::motion::Trajectory;
use kinopt::motion::retarget::RetargetReport;
use kinopt_bindings::problem_file::CollisionSettings;
use kinopt_bindings::retarget_folder::FolderSettings;

use super::target::Target;
use crate::collision_options::{ObstacleOptions, checker, read_world, shapes};
use crate::failure::Outcome;
use crate::help_headings::COLLISIONS;
use crate::output;
use crate::solve::obstacles::given;

/// Scale factor of the obstacles.
#[derive(Clone, Copy, Debug, PartialEq)]
enum WorldScale {
    Times(f64),
    /// Ratio of the robot's step length to the subject's.
    Stride,
}

impl WorldScale {
    fn parse(text: &str) -> Result<Self, String> {
        match (text, text.parse::<f64>()) {
            ("stride", _) => Ok(Self::Stride),
            (_, Ok(times)) if times > 0.0 && times.is_finite() => Ok(Self::Times(times)),
            _ => Err("expected a number > 0, or `stride`".into()),
        }
    }
}

/// Collision options of `kinopt retarget`.
#[derive(Args, Clone, Debug)]
pub(super) struct AvoidanceOptions {
    #[command(flatten)]
    obstacles: ObstacleOptions,

    /// Scale of the obstacles, or `stride`: the ratio of step lengths.
    #[arg(long, value_name = "TIMES", value_parser = WorldScale::parse, requires = "world", help_heading = COLLISIONS)]
    world_scale: Option<WorldScale>,
}

/// Collision checker and world of the collision avoidance.
#[derive(Clone, Debug)]
pub(super) struct CollisionAvoidance {
    checker: Checker,
    /// Obstacles from the file of `--world`.
    world: Option<World>,
    /// `true` if the obstacles are scaled by the stride.
    of_person: bool,
}

impl CollisionAvoidance {
    /// Checker with the obstacles scaled by `stride`, the ratio of the robot's step length to the subject's.
    ///
    /// # Errors
    /// Scaled obstacles that are too small or too large.
    pub(super) fn at_stride(&self, stride: f64) -> Outcome<Checker> {
        let checker = self.checker.clone();
        Ok(match &self.world {
            Some(world) if self.of_person => checker.with_world(&world.scaled(stride)?)?,
            _ => checker,
        })
    }

    /// Adds margin and world to a folder query.
    pub(super) fn add_to_query(&self, query: &mut FolderSettings<'_>) {
        query.keep_clear = Some(self.checker.margin());
        query.world = self.world.as_ref().map(World::to_json);
        let note = self.of_person.then(|| "world of the person".to_owned());
        query.more.extend(note);
    }
}

impl AvoidanceOptions {
    /// Collision avoidance of a target. `None` without a collision option.
    ///
    /// # Errors
    /// A figure, a robot without shapes, and a missing or damaged file.
    pub(super) fn of(
        &self,
        target: &Target,
        collisions: &CollisionSettings,
    ) -> Outcome<Option<CollisionAvoidance>> {
        let mut collisions = collisions.clone();
        self.obstacles.add_to(&mut collisions);
        let collisions = &collisions;
        let Some(option) = given(collisions) else {
            return Ok(None);
        };
        if target.loaded.robot.is_none() {
            return Err(usage!(
                "{option} applies to robots with collision shapes; {} is a {}",
                target.loaded.file,
                target.loaded.kind()
            ));
        }
        let mut world = read_world(collisions)?;
        if let Some(WorldScale::Times(times)) = self.world_scale {
            world = world.scaled(times)?;
        }
        let checker = checker(collisions, shapes(collisions, &target.robot)?)?;
        let margin = collisions.margin.unwrap_or(0.0);
        Ok(Some(CollisionAvoidance {
            checker: checker.with_world(&world)?.with_margin(margin)?,
            world: collisions.world.is_some().then_some(world),
            of_person: self.world_scale == Some(WorldScale::Stride),
        }))
    }
}

/// Reports the frames that remain in contact.
pub(super) fn report_contacts(file: &str, retargeted: &Trajectory<RetargetReport>) {
    if let Some(first) = retargeted.report.touching.first() {
        let frames = counted(retargeted.report.touching.len(), "frame");
        let (frame, pair) = (first.frame, &first.pair);
        output::message(&format!(
            "note: {file}: {frames} remain in collision, first frame {frame}: {pair}"
        ));
    }
}
