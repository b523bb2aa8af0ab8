//! Pairs of bodies in collision, or too close.

use std::fmt;

/// The kind of a body in a collision: a link and an obstacle may have equal names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum BodyKind {
    /// A link of a robot, or a bone of a skeleton.
    Link,
    /// An obstacle of the world, attached to a link or not.
    Obstacle,
}

impl BodyKind {
    /// `link` or `obstacle`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Link => "link",
            Self::Obstacle => "obstacle",
        }
    }
}

impl fmt::Display for BodyKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Two bodies whose distance is below the required margin, or that [block a motion](Self::on_the_way).
///
/// Its text names both kinds: ``link `hand` and obstacle `table` ``.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Collision {
    /// A link of the robot, or an obstacle attached to one.
    pub first: String,
    /// An obstacle, or another link.
    pub second: String,
    /// The kind of the first body.
    pub first_kind: BodyKind,
    /// The kind of the second body.
    pub second_kind: BodyKind,
    /// Distance between the bodies, metres; minus the penetration depth if they overlap.
    pub distance: f64,
    /// True if the pair blocks a motion rather than its end configuration.
    ///
    /// The step of a path or of a drag was then not made, or made in part, because it is not proven collision-free. The
    /// distance is the one at the end of the executed motion. It may exceed the margin by up to a micrometre, the
    /// resolution of the check.
    pub on_the_way: bool,
}

impl Collision {
    /// A link and an obstacle by name, and their distance, metres.
    #[must_use]
    pub fn new(first: &str, second: &str, distance: f64) -> Self {
        Self {
            first: first.to_owned(),
            second: second.to_owned(),
            first_kind: BodyKind::Link,
            second_kind: BodyKind::Obstacle,
            distance,
            on_the_way: false,
        }
    }

    /// Sets the kinds of both bodies.
    #[must_use]
    pub fn between(mut self, first: BodyKind, second: BodyKind) -> Self {
        (self.first_kind, self.second_kind) = (first, second);
        self
    }

    /// Marks the pair as [blocking a motion](Self::on_the_way).
    #[must_use]
    pub fn met_on_the_way(mut self) -> Self {
        self.on_the_way = true;
        self
    }

    /// True if `other` has the same two bodies.
    pub(crate) fn is_of_same_pair(&self, other: &Self) -> bool {
        let kinds = |pair: &Self| (pair.first_kind, pair.second_kind);
        kinds(self) == kinds(other) && self.first == other.first && self.second == other.second
    }

    /// Penetration depth, metres; 0 if the bodies do not overlap.
    #[must_use]
    pub fn depth(&self) -> f64 {
        (-self.distance).max(0.0)
    }
}

impl fmt::Display for Collision {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { first, second, .. } = self;
        write!(
            f,
            "{} `{first}` and {} `{second}`",
            self.first_kind, self.second_kind
        )
    }
}

#[cfg(test)]
mod tests {
    use super::{BodyKind, Collision};

    #[test]
    fn link_and_obstacle_of_equal_name_are_distinct() {
        let pair = Collision::new("hand", "table", -0.01);
        let closer = Collision::new("hand", "table", -0.02).met_on_the_way();
        assert!(pair.is_of_same_pair(&closer));
        for (first, second) in [
            (BodyKind::Link, BodyKind::Link),
            (BodyKind::Obstacle, BodyKind::Obstacle),
        ] {
            let other = Collision::new("hand", "table", -0.01).between(first, second);
            assert!(!pair.is_of_same_pair(&other), "{other}");
        }
    }
}
