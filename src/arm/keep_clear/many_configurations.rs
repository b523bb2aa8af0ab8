//! Many configurations at once, and ways between two: what whole paths ask.

use crate::arm::Reply;
use crate::arm::arm::Arm;
use crate::search::Collision;

impl Arm {
    /// Which configurations are free: surely by their spheres, or where `by_shapes` also by the exact check. All are where
    /// the arm has nothing to keep clear of.
    pub(crate) fn are_free(&self, q: &[f64], by_shapes: bool, free: &mut Vec<bool>) -> Reply<()> {
        free.clear();
        free.resize(q.len() / self.joint_count(), true);
        self.for_each_touching(q, by_shapes, |place| free[place] = false)
    }

    /// What is in the way from one configuration to another, on which all joints move evenly.
    pub(crate) fn in_the_way(&self, from: &[f64], to: &[f64]) -> Reply<Option<Collision>> {
        let Some(kept) = &self.collisions else {
            return Ok(None);
        };
        self.with_room(kept, |_, room| kept.blocked(self, room, from, to))
    }
}
