//! Uniform scaling of worlds.

use std::sync::Arc;

use super::{Obstacle, World, WorldError, rigid};
use kinopt_kinematics::bad_option::{BadOption, POSITIVE};
use kinopt_kinematics::spatial::Placement;

impl World {
    /// The world scaled by `factor` about its origin. Attached obstacles are scaled about the origin of their frame.
    /// For example, this adapts the surroundings of a human subject to a robot with longer steps.
    /// For example, this adapts a person's surroundings to a robot with longer steps.
    ///
    /// # Errors
    /// Returns an error if the factor is not positive and finite, or if a scaled obstacle is too small or too large.
    pub fn scaled(&self, factor: f64) -> Result<Self, WorldError> {
        BadOption::check("times", factor, POSITIVE)?;
        let mut scaled = Self {
            notes: self.notes.clone(),
            may_be_missing: self.may_be_missing.clone(),
            ..Self::new()
        };
        for obstacle in self.obstacles() {
            let shape = obstacle.shape.scaled(factor);
            let shape = shape.map_err(|error| WorldError::Shape {
                name: obstacle.name.clone(),
                error,
            })?;
            let Placement {
                rotation,
                translation,
            } = obstacle.placement;
            let placement = Placement::new(rotation, translation * factor);
            let placement = rigid(&obstacle.name, placement)?;
            let attached = obstacle.attached.clone();
            let mut scaled_obstacle = Obstacle::new(&obstacle.name, shape, placement, attached);
            scaled_obstacle
                .allowed_collisions
                .clone_from(&obstacle.allowed_collisions);
            scaled.push(Arc::new(scaled_obstacle));
        }
        Ok(scaled)
    }
}
