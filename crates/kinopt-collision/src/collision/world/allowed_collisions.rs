//! Allowed collisions of obstacles.

use super::{Obstacle, World, WorldError};

impl World {
    /// Allows the collision of an obstacle and a link of the robot, or of two obstacles, at any depth.
    ///
    /// Examples are feet and the floor, a gripper and its can, or a held can and the table. All checks skip the pair.
    /// The permission lasts until it is [forbidden](Self::forbid_collision) or an obstacle is [removed](Self::remove).
    /// Moving, attaching and detaching keep it. A name denotes both the link and the obstacle of that name. A
    /// [`Checker`](crate::collision::Checker) reports links that the robot does not have.
    /// [`CollisionModel::with_ignored`](crate::collision::CollisionModel::with_ignored) allows collisions of two links.
    ///
    /// ```
    /// # std::env::set_current_dir("../..")?;
    /// use kinopt::collision::{Checker, World};
    /// use kinopt::robot::Robot;
    /// use kinopt::spatial::{Placement, Vector3};
    ///
    /// let robot = Robot::read("models/franka_panda.urdf")?;
    /// let mut world = World::new();
    /// world.add_plane("floor", Placement::translation(Vector3::new(0.0, 0.0, 0.02)))?;
    /// world.allow_collision("floor", "base")?;
    /// let checker = Checker::of(&robot)?.with_world(&world)?;
    /// assert!(checker.collisions(&[0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8, 0.0, 0.0])?.is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Returns an error if a name is blank, or if neither name is an obstacle. The error lists the names of obstacles.
    pub fn allow_collision(&mut self, one: &str, other: &str) -> Result<(), WorldError> {
        if self.find(one).or(self.find(other)).is_none() {
            return Err(self.no_obstacle(one, other));
        }
        if let Some(name) = [one, other].iter().find(|name| name.trim().is_empty()) {
            return Err(WorldError::Unnamed((*name).to_owned()));
        }
        for (name, allowed_name) in [(one, other), (other, one)] {
            let lacks = |obstacle: &Obstacle| {
                obstacle
                    .allowed_collisions
                    .iter()
                    .all(|listed| listed != allowed_name)
            };
            if self.obstacle(name).is_ok_and(lacks) {
                self.edit(name, |obstacle| {
                    obstacle.allowed_collisions.push(allowed_name.to_owned())
                })?;
            }
        }
        Ok(())
    }

    /// Forbids the collision of two bodies again.
    ///
    /// # Errors
    /// Returns an error if neither name is an obstacle, or if their collision is not allowed.
    pub fn forbid_collision(&mut self, one: &str, other: &str) -> Result<(), WorldError> {
        if self.find(one).or(self.find(other)).is_none() {
            return Err(self.no_obstacle(one, other));
        }
        if !self.is_collision_allowed(one, other) {
            let names = [one, other].map(str::to_owned);
            return Err(WorldError::KeptApart(names));
        }
        for (name, allowed_name) in [(one, other), (other, one)] {
            if self.find(name).is_some() {
                self.edit(name, |obstacle| {
                    obstacle
                        .allowed_collisions
                        .retain(|listed| listed != allowed_name)
                })?;
            }
        }
        Ok(())
    }

    /// True if the collision of two bodies is allowed, in either order.
    #[must_use]
    pub fn is_collision_allowed(&self, one: &str, other: &str) -> bool {
        [(one, other), (other, one)]
            .iter()
            .any(|(name, allowed_name)| {
                let obstacle = self.obstacle(name);
                obstacle.is_ok_and(|obstacle| {
                    obstacle
                        .allowed_collisions
                        .iter()
                        .any(|listed| listed == allowed_name)
                })
            })
    }

    /// Obstacles with allowed collisions, each with its number.
    pub(crate) fn with_allowed_collisions(&self) -> impl Iterator<Item = (u64, &Obstacle)> {
        let numbers = self.with_allowed_collisions.iter();
        numbers.filter_map(|number| Some((*number, &**self.obstacles.get(*number)?)))
    }

    /// True if a name in an allowed collision need not exist, according to the file.
    pub(crate) fn may_be_missing(&self, name: &str) -> bool {
        self.may_be_missing.contains(name)
    }

    /// Removes the allowed collisions of a removed obstacle.
    pub(super) fn remove_allowed_collisions_of(&mut self, name: &str, number: u64) {
        self.with_allowed_collisions
            .retain(|other| *other != number);
        let affected = self
            .with_allowed_collisions()
            .filter(|(_, other)| other.allowed_collisions.iter().any(|n| n == name));
        let affected: Vec<String> = affected.map(|(_, other)| other.name.clone()).collect();
        for other in affected {
            // The obstacle was found above.
            let _ = self.edit(&other, |other| {
                other.allowed_collisions.retain(|listed| listed != name)
            });
        }
    }

    fn no_obstacle(&self, one: &str, other: &str) -> WorldError {
        WorldError::no_obstacle([one, other], self.obstacles())
    }
}
