//! Two convex bodies: cores and the radii around them.

use super::core::{Gap, Pair};
use super::{epa, gjk};

/// How far they are apart; `None` where that is told to be more than `within`.
pub(crate) fn gap(pair: &Pair<'_>, radius_a: f64, radius_b: f64, within: f64) -> Option<Gap> {
    let radii = radius_a + radius_b;
    let core = match gjk::distance(pair, within + radii) {
        gjk::Found::Beyond => return None,
        gjk::Found::Apart(gap) => gap,
        gjk::Found::Meeting(at) => epa::depth(pair, at),
    };
    Some(Gap {
        distance: core.distance - radii,
        on_a: core.on_a + core.normal * radius_a,
        on_b: core.on_b - core.normal * radius_b,
        normal: core.normal,
    })
}
