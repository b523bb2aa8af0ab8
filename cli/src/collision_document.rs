//! Collisions in JSON.

use kinopt::collision::Collision;
use serde::Serialize;

/// Pair of links or obstacles with their distance.
#[derive(Serialize)]
pub(crate) struct CollisionDocument<'a> {
    first: &'a str,
    /// `link` or `obstacle`.
    first_kind: &'static str,
    second: &'a str,
    second_kind: &'static str,
    /// Distance in metres; negative for a penetration.
    distance: f64,
    /// True for a collision along a motion, false at the configuration.
    on_the_way: bool,
}

impl<'a> CollisionDocument<'a> {
    pub(crate) fn of(pair: &'a Collision) -> Self {
        Self {
            first: &pair.first,
            first_kind: pair.first_kind.name(),
            second: &pair.second,
            second_kind: pair.second_kind.name(),
            distance: pair.distance,
            on_the_way: pair.on_the_way,
        }
    }
}

/// Penetration depth or distance as text, in millimetres.
pub(crate) fn depth(pair: &Collision) -> String {
    let millimetres = 1e3 * pair.distance.abs();
    let relation = if pair.distance < 0.0 { "deep" } else { "apart" };
    format!("{millimetres:.3} mm {relation}")
}
