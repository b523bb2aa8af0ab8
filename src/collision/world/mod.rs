//! Worlds: named obstacles, each a shape with a place.

mod add;
mod error;
mod file;
mod ground_height;
mod json;
mod moveit;
mod pose;

use std::sync::Arc;

pub use error::WorldError;

use super::shape::Shape;
use crate::spatial::Placement;

/// An obstacle of a [`World`].
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Obstacle {
    /// Its name, of which there is one in a world.
    pub name: String,
    /// What it is.
    pub shape: Shape,
    /// Where it stands: in the world, or in the frame that it is attached to.
    pub placement: Placement<f64>,
    /// The frame of the robot that it moves with, as something grasped does.
    pub attached: Option<String>,
}

impl Obstacle {
    /// An obstacle by itself, in the world or attached to a frame.
    #[must_use]
    pub fn new(
        name: impl Into<String>,
        shape: Shape,
        placement: impl Into<Placement<f64>>,
        attached: Option<String>,
    ) -> Self {
        Self {
            name: name.into(),
            shape,
            placement: placement.into(),
            attached,
        }
    }
}

/// Named obstacles in the order in which they were added. Cheap to clone: copies share what neither changes.
#[derive(Clone, Debug, Default)]
pub struct World {
    obstacles: Vec<Arc<Obstacle>>,
    revision: u64,
}

impl World {
    /// A world without obstacles.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    getters! {
        /// How many obstacles there are.
        pub fn len(&self) -> usize = self.obstacles.len();
        /// Whether there are none.
        pub fn is_empty(&self) -> bool = self.obstacles.is_empty();
        /// A number that every change raises, so that what was made of a world knows whether it is still so.
        pub fn revision(&self) -> u64 = self.revision;
        /// All obstacles in the order in which they were added.
        pub fn obstacles(&self) -> impl ExactSizeIterator<Item = &Obstacle> = self.obstacles.iter().map(|o| &**o);
    }

    /// Looks an obstacle up.
    ///
    /// # Errors
    /// There is none of that name; the error lists those there are.
    pub fn obstacle(&self, name: &str) -> Result<&Obstacle, WorldError> {
        Ok(&self.obstacles[self.position(name)?])
    }

    fn position(&self, name: &str) -> Result<usize, WorldError> {
        let position = self.obstacles.iter().position(|o| o.name == name);
        position.ok_or_else(|| WorldError::unknown(name, self.obstacles()))
    }

    /// Moves an obstacle; of an attached one the placement in its frame.
    ///
    /// # Errors
    /// There is none of that name, or the placement is not rigid.
    pub fn move_to(
        &mut self,
        name: &str,
        placement: impl Into<Placement<f64>>,
    ) -> Result<(), WorldError> {
        let placement = rigid(name, placement.into())?;
        self.edit(name, |obstacle| obstacle.placement = placement)
    }

    /// Takes an obstacle out.
    ///
    /// # Errors
    /// There is none of that name; the error lists those there are.
    pub fn remove(&mut self, name: &str) -> Result<(), WorldError> {
        let at = self.position(name)?;
        self.obstacles.remove(at);
        self.revision += 1;
        Ok(())
    }

    /// Makes an obstacle move with a frame of the robot, at `frame_from_object` in it. Whether the robot has the
    /// frame shows when both come together.
    ///
    /// # Errors
    /// There is no obstacle of that name, or the placement is not rigid.
    pub fn attach(
        &mut self,
        name: &str,
        frame: &str,
        frame_from_object: impl Into<Placement<f64>>,
    ) -> Result<(), WorldError> {
        let placement = rigid(name, frame_from_object.into())?;
        self.edit(name, |obstacle| {
            obstacle.attached = Some(frame.to_owned());
            obstacle.placement = placement;
        })
    }

    /// Leaves an obstacle in the world again, at `world_from_object`.
    ///
    /// # Errors
    /// There is none of that name, it is attached to nothing, or the placement is not rigid.
    pub fn detach(
        &mut self,
        name: &str,
        world_from_object: impl Into<Placement<f64>>,
    ) -> Result<(), WorldError> {
        if self.obstacle(name)?.attached.is_none() {
            return Err(WorldError::NotAttached(name.to_owned()));
        }
        let placement = rigid(name, world_from_object.into())?;
        self.edit(name, |obstacle| {
            obstacle.attached = None;
            obstacle.placement = placement;
        })
    }

    fn edit(&mut self, name: &str, change: impl FnOnce(&mut Obstacle)) -> Result<(), WorldError> {
        let at = self.position(name)?;
        change(Arc::make_mut(&mut self.obstacles[at]));
        self.revision += 1;
        Ok(())
    }
}

/// A placement that is rigid to the bits that files leave.
fn rigid(name: &str, placement: Placement<f64>) -> Result<Placement<f64>, WorldError> {
    match placement.check_rigid(1e-6) {
        Ok(()) => Ok(placement.made_rigid()),
        Err(defect) => Err(WorldError::Placement {
            name: name.to_owned(),
            defect,
        }),
    }
}
