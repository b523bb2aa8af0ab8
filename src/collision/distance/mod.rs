//! How far two shapes are apart, or how deep one is in the other.

mod convex;
mod core_and_radius;
mod cylinder_refinement;
mod epa;
mod gjk;
mod half_space;
mod many;
mod nearest_features;
mod reach;
mod simplex;

use self::core_and_radius::Gap;
use super::shape::{Shape, ShapeKind};
use crate::spatial::{Placement, Vector3};
use many::Parts;

pub(crate) use self::core_and_radius::{Core, Pair};
pub(crate) use convex::gap as convex_gap;

/// Solids of a robot's size that are made to meet exactly are told apart or deep by far less than that, metres.
pub(crate) const ROUNDING: f64 = 1e-9;

/// How far two shapes are apart, in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Separation {
    /// In metres: positive apart, 0 touching, negative overlapping, by the shortest way that frees them.
    pub distance: f64,
    /// The point of the first shape that is nearest to the second, or deepest in it.
    pub on_first: Vector3<f64>,
    /// The point of the second shape that is nearest to the first, or deepest in it.
    pub on_second: Vector3<f64>,
    /// Of unit length, from the first to the second: the distance grows by as much as the second moves this way.
    pub normal: Vector3<f64>,
}

/// How far two shapes are apart, each by where it stands in the world.
///
/// The distance of shapes that are apart is exact to some 1e-14 of their size and distance from each other, and so
/// is the depth of convex ones (spheres, capsules, cylinders, boxes, hulls and half-spaces) in each other. A mesh,
/// height field or cloud is deep by its deepest triangle or point, or where a shape lies wholly within by how deep
/// a point of that is: never more than the true depth. Of an open mesh the surface alone counts. Two half-spaces
/// that meet are infinitely deep. Where many points are as near, as between faces, one pair of them is told; the points are
/// within 1e-6 of their shapes.
#[must_use]
pub fn separation(
    first: &Shape,
    world_from_first: &Placement<f64>,
    second: &Shape,
    world_from_second: &Placement<f64>,
) -> Separation {
    let gap = gap(
        first,
        world_from_first,
        second,
        world_from_second,
        f64::INFINITY,
    );
    // Without a bound there is always one.
    gap.map_or_else(Separation::none, |gap| {
        Separation::placed(&gap, world_from_first)
    })
}

/// The same, if it is at most `within`, which may be told much sooner; else `None`.
#[must_use]
pub fn separation_within(
    first: &Shape,
    world_from_first: &Placement<f64>,
    second: &Shape,
    world_from_second: &Placement<f64>,
    within: f64,
) -> Option<Separation> {
    let gap = gap(first, world_from_first, second, world_from_second, within)?;
    (gap.distance <= within).then(|| Separation::placed(&gap, world_from_first))
}

impl Separation {
    fn placed(gap: &Gap, world_from_first: &Placement<f64>) -> Self {
        Self {
            distance: gap.distance,
            on_first: world_from_first.apply(gap.on_a),
            on_second: world_from_first.apply(gap.on_b),
            normal: world_from_first.rotation * gap.normal,
        }
    }

    fn none() -> Self {
        Self {
            distance: f64::INFINITY,
            on_first: Vector3::zero(),
            on_second: Vector3::zero(),
            normal: Vector3::UNITS[2],
        }
    }
}

/// In the coordinates of the first; `None` where it is more than `within`.
fn gap(
    first: &Shape,
    world_from_first: &Placement<f64>,
    second: &Shape,
    world_from_second: &Placement<f64>,
    within: f64,
) -> Option<Gap> {
    let first_from_second = world_from_first.inverse() * *world_from_second;
    match (first.kind(), second.kind()) {
        (ShapeKind::HalfSpace, other) => half_space::gap(other, &first_from_second),
        (other, ShapeKind::HalfSpace) => {
            let second_from_first = first_from_second.inverse();
            let turned = half_space::gap(other, &second_from_first)?;
            Some(turned.flipped(&first_from_second))
        }
        (a, b) => match (Core::of(a), Core::of(b)) {
            (Some((core_a, radius_a)), Some((core_b, radius_b))) => {
                let pair = Pair {
                    a: core_a,
                    b: core_b,
                    a_from_b: first_from_second,
                };
                convex::gap(&pair, radius_a, radius_b, within)
            }
            _ => many::gap(
                &Parts::of(first),
                &Parts::of(second),
                &first_from_second,
                within,
            ),
        },
    }
}
