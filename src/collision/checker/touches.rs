//! Allowed collisions of obstacles, by name.

use super::CheckerError;
use crate::collision::{CollisionModel, World};
use crate::model::{FrameId, FrameRef, UnknownName};

/// Obstacles with allowed collisions.
pub(super) struct Touches<'a> {
    world: &'a World,
    /// Number and name of each obstacle, and the names that it may collide with.
    of: Vec<(u64, &'a str, &'a [String])>,
}

impl<'a> Touches<'a> {
    /// Collects the allowed collisions of a world.
    ///
    /// # Errors
    /// Returns an error if a name belongs neither to the robot nor to the world.
    pub(super) fn of(model: &CollisionModel, world: &'a World) -> Result<Self, CheckerError> {
        let mut of = Vec::new();
        for (number, obstacle) in world.touching() {
            for name in &obstacle.allowed_collisions {
                let frame = FrameRef::from(name.as_str()).resolve(model.model());
                let is_there = frame.is_ok() || world.number_of(name).is_some();
                if !is_there && !world.may_be_missing(name) {
                    let links = model.links().iter().map(|link| model.name_of(*link));
                    let others = world.obstacles().map(|obstacle| obstacle.name.as_str());
                    return Err(CheckerError::MayTouch {
                        obstacle: obstacle.name.clone(),
                        unknown: UnknownName::new("link or obstacle", name, links.chain(others)),
                    });
                }
            }
            of.push((number, &*obstacle.name, &*obstacle.allowed_collisions));
        }
        Ok(Self { world, of })
    }

    /// Sorted numbers of the obstacles that a link may touch.
    pub(super) fn passes_of(model: &CollisionModel, world: &World, link: FrameId) -> Vec<u64> {
        let mut passes = Vec::new();
        // The names are validated when robot and world are combined.
        if let Ok(touches) = Touches::of(model, world) {
            touches.add_passes(model.name_of(link), &mut passes);
        }
        passes
    }

    /// True if two bodies may collide, of which at least one is an obstacle.
    pub(super) fn may(&self, one: &str, other: &str) -> bool {
        !self.of.is_empty() && self.world.is_collision_allowed(one, other)
    }

    /// Adds the numbers of the obstacles that a named body may touch, and sorts all. Numbers of attached obstacles have
    /// no effect.
    pub(super) fn add_passes(&self, name: &str, passes: &mut Vec<u64>) {
        if self.of.is_empty() {
            return;
        }
        for (number, own, with) in &self.of {
            if with.iter().any(|with| with == name) {
                passes.push(*number);
            }
            if *own == name {
                passes.extend(with.iter().filter_map(|with| self.world.number_of(with)));
            }
        }
        passes.sort_unstable();
        passes.dedup();
    }
}
