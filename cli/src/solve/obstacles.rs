//! `--world` and `--margin`: collision avoidance of an arm or a body.

use std::path::PathBuf;

use clap::Args;
use kinopt::arm::Arm;
use kinopt::collision::{Checker, CollisionModel};
use kinopt::robot::{Robot, Srdf};

use crate::choices::first_given;
use crate::collision_options::{ShapeOptions, SphereOption};
use crate::failure::Outcome;
use crate::help_headings::{COLLISIONS, TARGETS};
use crate::loaded_model::LoadedModel;
use crate::number_list::not_negative;
use crate::world_file::TouchOption;

/// Options of collisions.
#[derive(Args, Clone, Debug)]
pub(crate) struct ObstacleArguments {
    /// Avoid self-collisions and the obstacles of a .json or MoveIt .yaml file. Default: none.
    #[arg(long, value_name = "FILE", help_heading = TARGETS)]
    world: Option<PathBuf>,

    /// Required distance, in metres; without --world only between the robot's links. Default: 0.
    #[arg(long, value_name = "M", value_parser = not_negative, help_heading = COLLISIONS, hide_short_help = true)]
    margin: Option<f64>,

    #[command(flatten)]
    touch: TouchOption,

    #[command(flatten)]
    shapes: ShapeOptions,

    #[command(flatten)]
    spheres: SphereOption,
}

impl ObstacleArguments {
    /// First given option, if any.
    pub(super) fn given(&self) -> Option<&'static str> {
        first_given([
            ("--world", self.world.is_some()),
            ("--margin", self.margin.is_some()),
            ("--sphere-model", self.spheres.is_given()),
        ])
    }

    /// Checker of the options, if any: collision shapes of a robot, capsules along the bones of a skeleton.
    ///
    /// # Errors
    /// A missing or damaged file, or a rig without a skin.
    pub(super) fn checker(&self, loaded: &LoadedModel) -> Outcome<Option<Checker>> {
        let Some(option) = self.given() else {
            return Ok(None);
        };
        let world = self.touch.read(self.world.as_deref())?;
        let checker = match &loaded.robot {
            Some(robot) => {
                let model = self.of_robot(robot, loaded.srdf.as_deref())?;
                self.spheres.checker(model)?
            }
            None if self.spheres.is_given() => {
                return Err(usage!(
                    "--sphere-model is for robots with collision shapes; {} is a {}",
                    loaded.file,
                    loaded.kind()
                ));
            }
            None => Checker::new(of_figure(loaded, option)?),
        };
        let checker = checker.with_world(&world)?;
        Ok(Some(checker.with_margin(self.margin.unwrap_or(0.0))?))
    }

    /// Arm that avoids the obstacles of the options, with the robot's other joints at `rest`.
    ///
    /// # Errors
    /// Errors of [`checker`](Self::checker).
    pub(crate) fn keep_clear(&self, arm: Arm, loaded: &LoadedModel, rest: &[f64]) -> Outcome<Arm> {
        Ok(match self.checker(loaded)? {
            Some(checker) => arm.with_checker(&checker, rest)?,
            None => arm,
        })
    }

    fn of_robot(&self, robot: &Robot, srdf: Option<&Srdf>) -> Outcome<CollisionModel> {
        let model = self.shapes.model(robot)?;
        Ok(match srdf {
            Some(srdf) => model.with_srdf(srdf),
            None => model,
        })
    }
}

/// Collision model of capsules as thick as the skin.
fn of_figure(loaded: &LoadedModel, option: &str) -> Outcome<CollisionModel> {
    let rig = loaded.rig.as_deref();
    let skin = rig.and_then(|rig| Some((rig, rig.mesh.as_ref()?, rig.weights.as_ref()?)));
    let Some((rig, mesh, weights)) = skin else {
        return Err(usage!(
            "{option} is for robots with collision shapes and skeletons with a skin; {} is a {} without one",
            loaded.file,
            loaded.kind()
        ));
    };
    Ok(match &loaded.balls {
        Some(figure) => kinopt::motion::ball_skin_capsules(figure, mesh, weights)?,
        None => kinopt::motion::skin_capsules(&rig.skeleton, mesh, weights)?,
    })
}
