//! Signed distance between two shapes, with the closest points.

mod composite;
mod convex;
mod core_and_radius;
mod cylinder_refinement;
mod epa;
mod gjk;
mod half_space;
mod nearest_features;
mod reach;
mod simplex;

use self::core_and_radius::Gap;
use super::shape::{Shape, ShapeKind};
use composite::ConvexParts;
use kinopt_kinematics::spatial::{Placement, Vector3};

pub(crate) use self::core_and_radius::{Core, Pair};
pub(crate) use convex::gap as convex_gap;

/// Distances below this count as touching, metres. It is far above the rounding of distances of robot-sized solids.
pub(crate) const ROUNDING: f64 = 1e-9;

/// Signed distance of two shapes, with the closest points in world coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Separation {
    /// Signed distance, metres: positive if the shapes are apart, 0 if they touch.
    ///
    /// If the shapes overlap, it is minus the penetration depth: the length of the shortest translation that separates
    /// them.
    pub distance: f64,
    /// Point of the first shape that is closest to the second, or deepest in it, metres.
    pub on_first: Vector3<f64>,
    /// Point of the second shape that is closest to the first, or deepest in it, metres.
    pub on_second: Vector3<f64>,
    /// Unit direction from the first to the second shape. A translation of the second along it increases the distance
    /// by the same length.
    pub normal: Vector3<f64>,
}

/// The signed distance of two shapes, each with its placement in the world.
///
/// The distance of separated shapes is exact to about 1e-14 of their size and of the distance between their origins.
/// The same holds for the penetration depth of convex shapes: spheres, capsules, cylinders, boxes, hulls and
/// half-spaces.
///
/// A mesh, height field or point cloud is as deep as its deepest triangle or point. If it contains the other shape
/// entirely, the depth is that of one point of the other shape. Both never exceed the true depth. Only the surface of
/// an open mesh counts. Two half-spaces that meet are infinitely deep.
///
/// If several pairs of points are equally close, as between parallel faces, the result holds one of them. The points
/// are within 1e-6 m of their shapes.
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
    // A query without an upper bound always has a result.
    gap.map_or_else(Separation::none, |gap| {
        Separation::placed(&gap, world_from_first)
    })
}

/// [`separation`], if the distance is at most `max_distance` metres, else `None`. Faster than [`separation`] for
/// distant shapes.
#[must_use]
pub fn separation_within(
    first: &Shape,
    world_from_first: &Placement<f64>,
    second: &Shape,
    world_from_second: &Placement<f64>,
    max_distance: f64,
) -> Option<Separation> {
    let gap = gap(
        first,
        world_from_first,
        second,
        world_from_second,
        max_distance,
    )?;
    (gap.distance <= max_distance).then(|| Separation::placed(&gap, world_from_first))
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

/// The signed distance in the frame of the first shape. May be `None` if it is more than `max_distance`.
fn gap(
    first: &Shape,
    world_from_first: &Placement<f64>,
    second: &Shape,
    world_from_second: &Placement<f64>,
    max_distance: f64,
) -> Option<Gap> {
    let first_from_second = world_from_first.inverse() * *world_from_second;
    match (first.kind(), second.kind()) {
        (ShapeKind::HalfSpace, other) => half_space::gap(other, &first_from_second),
        (other, ShapeKind::HalfSpace) => {
            let second_from_first = first_from_second.inverse();
            let swapped = half_space::gap(other, &second_from_first)?;
            Some(swapped.flipped(&first_from_second))
        }
        (a, b) => match (Core::of(a), Core::of(b)) {
            (Some((core_a, radius_a)), Some((core_b, radius_b))) => {
                let pair = Pair {
                    a: core_a,
                    b: core_b,
                    a_from_b: first_from_second,
                };
                convex::gap(&pair, radius_a, radius_b, max_distance)
            }
            _ => composite::gap(
                &ConvexParts::of(first),
                &ConvexParts::of(second),
                &first_from_second,
                max_distance,
            ),
        },
    }
}
