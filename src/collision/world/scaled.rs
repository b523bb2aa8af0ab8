//! Worlds so many times as large.

use std::sync::Arc;

use super::{Obstacle, World, WorldError, rigid};
use crate::bad_option::{BadOption, POSITIVE};
use crate::spatial::Placement;

impl World {
    /// The same obstacles `times` as large and as far from the world's origin, as a person's surroundings are for a robot whose
    /// steps are so many times as long; attached ones as far from the origin of their frame.
    ///
    /// # Errors
    /// A factor that is not positive and finite, or with which an obstacle is too small or too large to be one.
    pub fn scaled(&self, times: f64) -> Result<Self, WorldError> {
        BadOption::check("times", times, POSITIVE)?;
        let mut scaled = Self {
            notes: self.notes.clone(),
            may_be_missing: self.may_be_missing.clone(),
            ..Self::new()
        };
        for obstacle in self.obstacles() {
            let shape = obstacle.shape.scaled(times);
            let shape = shape.map_err(|error| WorldError::Shape {
                name: obstacle.name.clone(),
                error,
            })?;
            let Placement {
                rotation,
                translation,
            } = obstacle.placement;
            let placement = Placement::new(rotation, translation * times);
            let placement = rigid(&obstacle.name, placement)?;
            let attached = obstacle.attached.clone();
            let mut own = Obstacle::new(&obstacle.name, shape, placement, attached);
            own.may_touch.clone_from(&obstacle.may_touch);
            scaled.push(Arc::new(own));
        }
        Ok(scaled)
    }
}
