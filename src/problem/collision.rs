//! Two things that touch, or are in each other's way.

use std::fmt;

/// What it is that touches: a robot's link and an obstacle may bear the same name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum BodyKind {
    /// A link of the robot, or a bone of a figure.
    Link,
    /// An obstacle of the world, one that is attached to a link too.
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

/// Two things that are nearer to each other than they should be, or that [end a way](Self::on_the_way).
///
/// Its text says what each of them is: ``link `hand` and obstacle `table` ``.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct Collision {
    /// A link of the robot, or an obstacle attached to one.
    pub first: String,
    /// An obstacle, or another link.
    pub second: String,
    /// What the first is.
    pub first_kind: BodyKind,
    /// What the second is.
    pub second_kind: BodyKind,
    /// How far they are apart, metres; negative where one is in the other: by how much the shortest way frees them.
    pub distance: f64,
    /// Whether they are met on the way to a place, not at it: the step of a path or of a drag, or a part of it, was not made, as it is
    /// not surely free. The distance is then that where the way ends, and may be up to a micrometre more than the margin: so near
    /// nothing is told apart from touching.
    pub on_the_way: bool,
}

impl Collision {
    /// A link and an obstacle by name, and how far they are apart, metres.
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

    setters! {
        /// The same pair of other kinds.
        pub fn between(mut self, first: BodyKind, second: BodyKind) {
            (self.first_kind, self.second_kind) = (first, second);
        }
        /// The same pair, met [on the way](Self::on_the_way).
        pub fn met_on_the_way(mut self) { self.on_the_way = true }
    }

    /// Whether another one is of the same two things.
    pub(crate) fn is_of_same_pair(&self, other: &Self) -> bool {
        let of = |pair: &Self| (pair.first_kind, pair.second_kind);
        of(self) == of(other) && self.first == other.first && self.second == other.second
    }

    /// How deep one is in the other, metres; 0 where they are apart.
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
    fn a_link_and_an_obstacle_of_one_name_are_two() {
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
