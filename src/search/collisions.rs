//! What a solution touches.

use super::Solution;

/// Two things that are nearer to each other than they should be.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Collision {
    /// A link of the robot, or an obstacle attached to one.
    pub first: String,
    /// An obstacle, or another link.
    pub second: String,
    /// How far they are apart, metres; negative where one is in the other: by how much the shortest way frees them.
    pub distance: f64,
}

impl Collision {
    /// Two things by name, and how far they are apart.
    #[cfg(feature = "collision")]
    pub(crate) fn new(first: &str, second: &str, distance: f64) -> Self {
        Self {
            first: first.to_owned(),
            second: second.to_owned(),
            distance,
        }
    }

    /// How deep one is in the other, metres; 0 where they are apart.
    #[must_use]
    pub fn depth(&self) -> f64 {
        (-self.distance).max(0.0)
    }
}

impl Solution {
    /// The pairs that are nearer to each other at `q` than the margin asked for, the deepest first. A solution that is
    /// [reached](Self::reached) has none; none are known where no world was given.
    #[must_use]
    pub fn collisions(&self) -> &[Collision] {
        &self.collisions
    }

    /// Whether every goal is within its tolerances, though something may be touched.
    #[must_use]
    pub fn goals_reached(&self) -> bool {
        self.reached || !self.collisions.is_empty() && self.goals_are_met()
    }

    fn goals_are_met(&self) -> bool {
        let mut goals = self.tasks().filter(|t| t.role == crate::task::Role::Goal);
        goals.all(|task| task.reached)
    }

    /// Takes what is touched; a solution that touches something is not reached.
    #[cfg(feature = "collision")]
    pub(crate) fn set_collisions(&mut self, collisions: Vec<Collision>) {
        self.reached &= collisions.is_empty();
        self.collisions = collisions;
    }
}
