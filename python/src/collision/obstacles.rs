//! Collision avoidance options of arms and problems: `world`, `margin` and `collision_model`.

use kinopt::collision::Checker;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::arrays::number;
use crate::collision::CollisionModel;
use crate::error::{OrRaise, invalid};
use crate::rig::Rig;
use crate::robot::Robot;
use crate::world::World;

/// Options as given.
pub(crate) struct Obstacles {
    world: Option<kinopt::collision::World>,
    margin: Option<f64>,
    shapes: Option<Checker>,
}

impl Obstacles {
    pub(crate) fn of(options: &Bound<'_, PyDict>) -> PyResult<Self> {
        let option = |name: &str| -> PyResult<Option<Bound<'_, PyAny>>> {
            Ok(options.get_item(name)?.filter(|value| !value.is_none()))
        };
        let world = option("world")?.map(|value| match value.cast::<World>() {
            Ok(world) => Ok(world.get().snapshot()),
            Err(_) => Err(invalid(format!(
                "world must be a kinopt.World, not {value}"
            ))),
        });
        let margin = option("margin")?.map(|value| number(&value, "margin"));
        let model = option("collision_model")?.map(|value| match value.cast::<CollisionModel>() {
            Ok(model) => Ok(model.get().checker()),
            Err(_) => Err(invalid(format!(
                "collision_model must be a kinopt.CollisionModel, not {value}"
            ))),
        });
        Ok(Self {
            shapes: model.transpose()?,
            world: world.transpose()?,
            margin: margin.transpose()?,
        })
    }

    /// Returns the checker of a robot, of a rig with a skin, or of the given collision model; `None` without any
    /// option.
    pub(crate) fn checker(&self, model: &Bound<'_, PyAny>) -> PyResult<Option<Checker>> {
        if self.world.is_none() && self.margin.is_none() && self.shapes.is_none() {
            return Ok(None);
        }
        let checker = if let Some(shapes) = &self.shapes {
            shapes.clone()
        } else if let Ok(robot) = model.cast::<Robot>() {
            robot.get().checker()?
        } else if let Ok(rig) = model.cast::<Rig>() {
            rig.get().checker()?
        } else {
            return Err(invalid(
                "world and margin need a Robot with collision shapes, a Rig with a skin, or a collision_model",
            ));
        };
        let world = self.world.clone().unwrap_or_default();
        let checker = checker.with_world(&world).or_raise()?;
        let checker = checker.with_margin(self.margin.unwrap_or(0.0)).or_raise()?;
        Ok(Some(checker))
    }
}
