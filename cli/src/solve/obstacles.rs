//! Collision avoidance of an arm or a body.

use kinopt::arm::Arm;
use kinopt::collision::{Checker, CollisionModel};

use crate::choices::first_given;
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::problem::CollisionSettings;

impl CollisionSettings {
    /// First setting that asks for collision avoidance, if any.
    pub(crate) fn given(&self) -> Option<&'static str> {
        first_given([
            ("--world", self.world.is_some()),
            ("--margin", self.margin.is_some()),
            ("`sphere_model`", self.sphere_model.is_some()),
        ])
    }

    /// Checker of a model, if obstacles are avoided: collision shapes of a robot, capsules along the bones of a
    /// skeleton.
    ///
    /// # Errors
    /// A missing or damaged file, or a rig without a skin.
    pub(super) fn checker_of(&self, loaded: &LoadedModel) -> Outcome<Option<Checker>> {
        let Some(option) = self.given() else {
            return Ok(None);
        };
        let world = self.read_world()?;
        let checker = match &loaded.robot {
            Some(robot) => {
                let model = self.shapes(robot)?;
                self.checker(match loaded.srdf.as_deref() {
                    Some(srdf) => model.with_srdf(srdf),
                    None => model,
                })?
            }
            None if self.sphere_model.is_some() => {
                return Err(usage!(
                    "`sphere_model` is for robots with collision shapes; {} is a {}",
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
    /// Errors of [`checker_of`](Self::checker_of).
    pub(crate) fn keep_clear(&self, arm: Arm, loaded: &LoadedModel, rest: &[f64]) -> Outcome<Arm> {
        Ok(match self.checker_of(loaded)? {
            Some(checker) => arm.with_checker(&checker, rest)?,
            None => arm,
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
