//! Collisions in JSON.

use kinopt::collision::Collision;
use serde::Serialize;

/// A pair, what each of it is, and how far it is apart.
#[derive(Serialize)]
pub(crate) struct CollisionDocument<'a> {
    first: &'a str,
    /// `link` or `obstacle`.
    first_kind: &'static str,
    second: &'a str,
    second_kind: &'static str,
    /// In metres, negative where one is in the other.
    distance: f64,
    /// Whether it ends a way instead of touching at the configuration.
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

/// How deep one is in the other, or how far they are apart.
pub(crate) fn depth(pair: &Collision) -> String {
    let millimetres = 1e3 * pair.distance.abs();
    let how = if pair.distance < 0.0 { "deep" } else { "apart" };
    format!("{millimetres:.3} mm {how}")
}
