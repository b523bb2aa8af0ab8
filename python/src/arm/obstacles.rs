//! What an arm keeps clear of.

use kinopt::collision::Checker;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::{self, number};
use crate::collision::CollisionModel;
use crate::error::{OrRaise, invalid};
use crate::robot::Robot;
use crate::world::World;

/// The options `world`, `margin` and `collision_model`, and where the joints that are not the arm's stand: `held`.
pub(super) struct Obstacles {
    world: Option<kinopt::collision::World>,
    margin: Option<f64>,
    model: Option<kinopt::collision::CollisionModel>,
    held: Option<Vec<f64>>,
}

impl Obstacles {
    pub(super) fn of(options: &Bound<'_, PyDict>) -> PyResult<Self> {
        let given = |name: &str| -> PyResult<Option<Bound<'_, PyAny>>> {
            Ok(options.get_item(name)?.filter(|value| !value.is_none()))
        };
        let world = given("world")?.map(|value| match value.cast::<World>() {
            Ok(world) => Ok(world.get().snapshot()),
            Err(_) => Err(invalid(format!(
                "world must be a kinopt.World, not {value}"
            ))),
        });
        let margin = given("margin")?.map(|value| number(&value, "margin"));
        let model = given("collision_model")?.map(|value| match value.cast::<CollisionModel>() {
            Ok(model) => Ok((*model.get().inner).clone()),
            Err(_) => Err(invalid(format!(
                "collision_model must be a kinopt.CollisionModel, not {value}"
            ))),
        });
        let held = given("held")?.map(|value| arrays::copied(&value, "held"));
        Ok(Self {
            held: held.transpose()?,
            model: model.transpose()?,
            world: world.transpose()?,
            margin: margin.transpose()?,
        })
    }

    /// The arm kept clear of them.
    pub(super) fn keep_clear(
        &self,
        arm: kinopt::Arm,
        robot: &Bound<'_, PyAny>,
    ) -> PyResult<kinopt::Arm> {
        if self.world.is_none() && self.margin.is_none() && self.model.is_none() {
            return Ok(arm);
        }
        let checker = match (&self.model, robot.cast::<Robot>()) {
            (Some(model), _) => Checker::covered(model.clone()),
            (None, Ok(robot)) => Checker::of(&robot.get().inner).or_raise()?,
            (None, Err(_)) => {
                return Err(invalid(
                    "world and margin are for the arm of a Robot, which has collision shapes, or take a collision_model",
                ));
            }
        };
        let world = self.world.clone().unwrap_or_default();
        let checker = checker.with_world(&world).or_raise()?;
        let checker = checker.with_margin(self.margin.unwrap_or(0.0)).or_raise()?;
        let neutral = || checker.model().model().neutral();
        let rest = self.held.clone().unwrap_or_else(neutral);
        arm.with_checker(&checker, &rest).or_raise()
    }
}

/// The same arm in another world.
pub(super) fn moved(
    arm: &kinopt::Arm,
    world: &Bound<'_, World>,
    margin: Option<f64>,
) -> PyResult<kinopt::Arm> {
    let moved = arm.with_world(&world.get().snapshot(), margin).or_raise()?;
    Ok(moved)
}
