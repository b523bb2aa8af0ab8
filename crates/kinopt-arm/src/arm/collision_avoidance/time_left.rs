//! Time that a query has left for collision checks.

use super::avoidance::CollisionAvoidance;
use crate::arm::query::Query;
use kinopt_kinematics::clock::Instant;

impl CollisionAvoidance {
    /// Returns true if a query has no time for another check.
    pub(super) fn is_late(&self, query: &Query<'_>) -> bool {
        query.is_late_by(self.check_time.get())
    }

    /// The query with its deadline earlier by one check.
    pub(super) fn with_time_for_check<'q>(&self, query: &Query<'q>) -> Query<'q> {
        let brought_forward = |at: Instant| at.checked_sub(self.check_time.get()).unwrap_or(at);
        Query {
            deadline: query.deadline.map(brought_forward),
            ..*query
        }
    }
}
