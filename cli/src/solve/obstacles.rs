//! Collision avoidance of an arm or a body.

use kinopt::arm::Arm;
use kinopt::collision::{Checker, CollisionModel};
use kinopt_bindings::problem_file::CollisionSettings;

use crate::choices::first_given;
use crate::collision_options::{checker, read_world, shapes};
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;

/// First setting that asks for collision avoidance, if any.
pub(crate) fn given(collisions: &CollisionSettings) -> Option<&'static str> {
    first_given([
        ("--world", collisions.world.is_some()),
        ("--margin", collisions.margin.is_some()),
        ("`sphere_model`", collisions.sphere_model.is_some()),
    ])
}

/// Checker of a model, if obstacles are avoided: collision shapes of a robot, capsules along the bones of a
/// skeleton.
///
/// # Errors
/// A missing or damaged file, or a rig without a skin.
pub(super) fn checker_of(
    collisions: &CollisionSettings,
    loaded: &LoadedModel,
) -> Outcome<Option<Checker>> {
    let Some(option) = given(collisions) else {
        return Ok(None);
    };
    let world = read_world(collisions)?;
    let checker = match &loaded.robot {
        Some(robot) => {
            let model = shapes(collisions, robot)?;
            checker(
                collisions,
                match loaded.srdf.as_deref() {
                    Some(srdf) => model.with_srdf(srdf),
                    None => model,
                },
            )?
        }
        None if collisions.sphere_model.is_some() => {
            return Err(usage!(
                "`sphere_model` is for robots with collision shapes; {} is a {}",
                loaded.file,
                loaded.kind()
            ));
        }
        None => Checker::new(of_figure(loaded, option)?),
    };
    let checker = checker.with_world(&world)?;
    Ok(Some(checker.with_margin(collisions.margin.unwrap_or(0.0))?))
}

/// Arm that avoids the obstacles of the options, with the robot's other joints at `rest`.
///
/// # Errors
/// Errors of [`checker_of`](Self::checker_of).
pub(crate) fn keep_clear(
    collisions: &CollisionSettings,
    arm: Arm,
    loaded: &LoadedModel,
    rest: &[f64],
) -> Outcome<Arm> {
    Ok(match checker_of(collisions, loaded)? {
        Some(checker) => arm.with_checker(&checker, rest)?,
        None => arm,
    })
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
