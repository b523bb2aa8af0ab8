//! Largest gap that given spheres leave uncovered in a solid.

use std::collections::BinaryHeap;

use super::cells::{Cell, root_cell};
use super::ranked::Ranked;
use super::rows;
use super::solid::Solid;
use crate::collision::{Ball, CollisionObject, ShapeKind};
use kinopt_kinematics::spatial::Vector3;

/// Precision of a gap, relative to the solid's half diagonal.
const RELATIVE_PRECISION: f64 = 2e-3;
/// Largest number of visited cells. At the limit the result is an upper bound of lower precision.
const MAX_CELLS: usize = 20_000;

/// Upper bound of the distance from a point of the solid to the union of the spheres, metres; 0 only if they cover it.
///
/// Branch and bound over an octree: the cell with the largest bound first.
pub(super) fn gap(objects: &[&CollisionObject], spheres: &[Ball]) -> f64 {
    let is_covered_object = |object: &&&CollisionObject| is_covered(object, spheres);
    let solid = &Solid::new(
        objects
            .iter()
            .filter(|object| !is_covered_object(object))
            .copied(),
    );
    if solid.is_empty() {
        return 0.0;
    }
    let distance_outside = |point: Vector3<f64>| {
        let balls = spheres.iter();
        let excess = balls.map(|ball| (point - ball.centre).norm() - ball.radius);
        excess.fold(f64::INFINITY, f64::min)
    };
    let with_upper_bound = |cell: Cell| {
        let balls = spheres.iter();
        let excess = balls.map(|ball| cell.required_radius(ball.centre) - ball.radius);
        Ranked(excess.fold(f64::INFINITY, f64::min), cell)
    };
    let precision = RELATIVE_PRECISION * solid.bounds().half_diagonal();
    let mut heap: BinaryHeap<Ranked<Cell>> =
        root_cell(solid).into_iter().map(with_upper_bound).collect();
    let mut lower_bound: f64 = 0.0;
    let mut visited = 0;
    while let Some(Ranked(upper_bound, cell)) = heap.pop() {
        if upper_bound <= 0.0 {
            return 0.0;
        }
        lower_bound = lower_bound.max(cell.point().map_or(0.0, distance_outside));
        // A nearly covered cell is split until it is covered or the limit is reached, so that exact covers give 0.
        let is_precise = lower_bound > 0.0 && upper_bound <= lower_bound + precision;
        visited += 1;
        if is_precise || visited == MAX_CELLS {
            return upper_bound;
        }
        heap.extend(cell.split(solid).map(with_upper_bound));
    }
    0.0
}

/// True if spheres cover a sphere or a capsule. A minimal cover of these leaves no margin for the bound by cells.
fn is_covered(object: &CollisionObject, spheres: &[Ball]) -> bool {
    let (radius, length) = match object.shape.kind() {
        ShapeKind::Sphere { radius } => (*radius, 0.0),
        ShapeKind::Capsule { radius, length } => (*radius, *length),
        _ => return false,
    };
    rows::covers_capsule(spheres, radius, length, &object.link_from_shape)
}
