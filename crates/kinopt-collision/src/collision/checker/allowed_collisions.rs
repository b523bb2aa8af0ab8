//! Allowed collisions of obstacles, by name.

use crate::collision::WorldError;
use crate::collision::{CollisionModel, World};
use kinopt_kinematics::model::{FrameId, FrameRef, UnknownName};

/// Obstacles with allowed collisions.
pub(super) struct AllowedCollisions<'a> {
    world: &'a World,
    /// Number and name of each obstacle, and the names that it may collide with.
    entries: Vec<(u64, &'a str, &'a [String])>,
}

impl<'a> AllowedCollisions<'a> {
    /// Collects the allowed collisions of a world.
    ///
    /// # Errors
    /// Returns an error if a name belongs neither to the robot nor to the world.
    pub(super) fn of(model: &CollisionModel, world: &'a World) -> Result<Self, WorldError> {
        let mut entries = Vec::new();
        for (number, obstacle) in world.with_allowed_collisions() {
            for name in &obstacle.allowed_collisions {
                let frame = FrameRef::from(name.as_str()).resolve(model.model());
                let exists = frame.is_ok() || world.number_of(name).is_some();
                if !exists && !world.may_be_missing(name) {
                    let links = model.links().iter().map(|link| model.name_of(*link));
                    let others = world.obstacles().map(|obstacle| obstacle.name.as_str());
                    return Err(WorldError::MayTouch {
                        obstacle: obstacle.name.clone(),
                        unknown: UnknownName::new("link or obstacle", name, links.chain(others)),
                    });
                }
            }
            entries.push((number, &*obstacle.name, &*obstacle.allowed_collisions));
        }
        Ok(Self { world, entries })
    }

    /// Sorted numbers of the obstacles that a link may touch.
    pub(super) fn passes_of(model: &CollisionModel, world: &World, link: FrameId) -> Vec<u64> {
        let mut allowed = Vec::new();
        // The names are validated when robot and world are combined.
        if let Ok(allowed_collisions) = AllowedCollisions::of(model, world) {
            allowed_collisions.add_allowed(model.name_of(link), &mut allowed);
        }
        allowed
    }

    /// True if two bodies may collide, of which at least one is an obstacle.
    pub(super) fn is_allowed(&self, one: &str, other: &str) -> bool {
        !self.entries.is_empty() && self.world.is_collision_allowed(one, other)
    }

    /// Adds the numbers of the obstacles that a named body may touch, and sorts all. Numbers of attached obstacles have
    /// no effect.
    pub(super) fn add_allowed(&self, name: &str, allowed: &mut Vec<u64>) {
        if self.entries.is_empty() {
            return;
        }
        for (number, obstacle, allowed_names) in &self.entries {
            if allowed_names
                .iter()
                .any(|allowed_name| allowed_name == name)
            {
                allowed.push(*number);
            }
            if *obstacle == name {
                allowed.extend(
                    allowed_names
                        .iter()
                        .filter_map(|allowed_name| self.world.number_of(allowed_name)),
                );
            }
        }
        allowed.sort_unstable();
        allowed.dedup();
    }
}
