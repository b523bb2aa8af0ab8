//! Solution of least penetration, for queries without a collision-free one.

use super::search::LOOKED_AT;
use super::{CollisionAvoidance, CollisionWorkspace};
use crate::arm::QueryError;
use crate::arm::arm::Arm;
use crate::arm::dispatch::Query;
use crate::arm::workspace::ArmWorkspace;

impl Arm {
    /// Moves the workspace's x to the solution found with the least penetration, as far as time allows; x itself
    /// included.
    ///
    /// Returns the distance of its worst pair, metres.
    pub(super) fn stand_least_deep(
        &self,
        kept: &CollisionAvoidance,
        workspace: &mut ArmWorkspace,
        room: &mut CollisionWorkspace,
        query: &Query<'_>,
    ) -> Result<f64, QueryError> {
        let mut best = kept.worst(self, room, &workspace.x)?;
        for turn in 0..workspace.order.len().min(LOOKED_AT) {
            if kept.is_late(query, 2) {
                break;
            }
            let place = workspace.order[turn].1;
            let distance = kept.worst(self, room, workspace.found_at(place))?;
            if distance > best {
                best = distance;
                workspace.stand_at_found(place);
            }
        }
        Ok(best)
    }
}
