//! What an obstacle may touch.

use super::{Obstacle, World, WorldError};

impl World {
    /// Lets two things touch, however deep: an obstacle and a link of the robot, or two obstacles, as feet and the floor, a gripper and its
    /// can, or a can that is held and the table. Every check passes them over. It lasts until it is [forbidden](Self::forbid_touch) or one of
    /// the obstacles is [removed](Self::remove); what is moved, attached or detached keeps it. A name means the link that bears it as
    /// well as the obstacle. Whether the robot has the link shows when both come together; links are let touch each other by
    /// [`CollisionModel::with_ignored`](crate::collision::CollisionModel::with_ignored).
    ///
    /// ```
    /// use kinopt::collision::{Checker, World};
    /// use kinopt::robot::Robot;
    /// use kinopt::spatial::{Placement, Vector3};
    ///
    /// let robot = Robot::read("models/franka_panda.urdf")?;
    /// let mut world = World::new();
    /// world.add_plane("floor", Placement::translation(Vector3::new(0.0, 0.0, 0.02)))?;
    /// world.allow_touch("floor", "base")?;
    /// let checker = Checker::of(&robot)?.with_world(&world)?;
    /// assert!(checker.collisions(&[0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8, 0.0, 0.0])?.is_empty());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// Neither is an obstacle, and the error lists those there are; a name without a letter.
    pub fn allow_touch(&mut self, one: &str, other: &str) -> Result<(), WorldError> {
        if self.find(one).or(self.find(other)).is_none() {
            return Err(self.no_obstacle(one, other));
        }
        if let Some(name) = [one, other].iter().find(|name| name.trim().is_empty()) {
            return Err(WorldError::Unnamed((*name).to_owned()));
        }
        for (own, with) in [(one, other), (other, one)] {
            let lacks = |own: &Obstacle| own.may_touch.iter().all(|name| name != with);
            if self.obstacle(own).is_ok_and(lacks) {
                self.edit(own, |own| own.may_touch.push(with.to_owned()))?;
            }
        }
        Ok(())
    }

    /// Keeps two things apart again that may touch.
    ///
    /// # Errors
    /// Neither is an obstacle, or they may not touch.
    pub fn forbid_touch(&mut self, one: &str, other: &str) -> Result<(), WorldError> {
        if self.find(one).or(self.find(other)).is_none() {
            return Err(self.no_obstacle(one, other));
        }
        if !self.may_touch(one, other) {
            let names = [one, other].map(str::to_owned);
            return Err(WorldError::KeptApart(names));
        }
        for (own, with) in [(one, other), (other, one)] {
            if self.find(own).is_some() {
                self.edit(own, |obstacle| {
                    obstacle.may_touch.retain(|name| name != with)
                })?;
            }
        }
        Ok(())
    }

    /// Whether two things were let touch, in either order.
    #[must_use]
    pub fn may_touch(&self, one: &str, other: &str) -> bool {
        [(one, other), (other, one)].iter().any(|(own, with)| {
            let own = self.obstacle(own);
            own.is_ok_and(|own| own.may_touch.iter().any(|name| name == with))
        })
    }

    /// The obstacles that may touch something, each with its number.
    pub(crate) fn touching(&self) -> impl Iterator<Item = (u64, &Obstacle)> {
        let touching = self.touching.iter();
        touching.filter_map(|number| Some((*number, &**self.obstacles.get(*number)?)))
    }

    /// Whether what bears a name need not be there, as a file said it.
    pub(crate) fn may_be_missing(&self, name: &str) -> bool {
        self.may_be_missing.contains(name)
    }

    /// Forgets what may touch an obstacle that is no more.
    pub(super) fn forget_touch_of(&mut self, name: &str, number: u64) {
        self.touching.retain(|other| *other != number);
        let of_it = self
            .touching()
            .filter(|(_, other)| other.may_touch.iter().any(|n| n == name));
        let of_it: Vec<String> = of_it.map(|(_, other)| other.name.clone()).collect();
        for other in of_it {
            // It was found above.
            let _ = self.edit(&other, |other| {
                other.may_touch.retain(|known| known != name)
            });
        }
    }

    fn no_obstacle(&self, one: &str, other: &str) -> WorldError {
        WorldError::no_obstacle([one, other], self.obstacles())
    }
}
