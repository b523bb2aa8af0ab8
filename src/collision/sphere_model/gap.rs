//! Largest gap that given spheres leave uncovered in a solid.

use std::collections::BinaryHeap;

use super::cells::{Cell, whole};
use super::ranked::Ranked;
use super::rows;
use super::solid::Solid;
use crate::collision::{Ball, CollisionObject, ShapeKind};
use crate::spatial::Vector3;

/// Precision of a gap, relative to the solid's half diagonal.
const PRECISION: f64 = 2e-3;
/// Largest number of visited cells. At the limit the result is an upper bound of lower precision.
const CELLS: usize = 20_000;

/// Upper bound of the distance from a point of the solid to the union of the spheres, metres; 0 only if they cover it.
///
/// Branch and bound over an octree: the cell with the largest bound first.
pub(super) fn gap(objects: &[&CollisionObject], spheres: &[Ball]) -> f64 {
    let held = |object: &&&CollisionObject| is_held(object, spheres);
    let solid = &Solid::new(objects.iter().filter(|object| !held(object)).copied());
    if solid.is_empty() {
        return 0.0;
    }
    let outside = |point: Vector3<f64>| {
        let each = spheres.iter();
        let out = each.map(|ball| (point - ball.centre).norm() - ball.radius);
        out.fold(f64::INFINITY, f64::min)
    };
    let at_most = |cell: Cell| {
        let each = spheres.iter();
        let out = each.map(|ball| cell.needs(ball.centre) - ball.radius);
        Ranked(out.fold(f64::INFINITY, f64::min), cell)
    };
    let precision = PRECISION * solid.bounds().half_diagonal();
    let mut heap: BinaryHeap<Ranked<Cell>> = whole(solid).into_iter().map(at_most).collect();
    let mut at_least: f64 = 0.0;
    let mut looked_at = 0;
    while let Some(Ranked(most, cell)) = heap.pop() {
        if most <= 0.0 {
            return 0.0;
        }
        at_least = at_least.max(cell.point().map_or(0.0, outside));
        // A nearly covered cell is split until it is covered or the limit is reached, so that exact covers give 0.
        let is_known = at_least > 0.0 && most <= at_least + precision;
        looked_at += 1;
        if is_known || looked_at == CELLS {
            return most;
        }
        heap.extend(cell.split(solid).map(at_most));
    }
    0.0
}

/// True if spheres cover a sphere or a capsule. A minimal cover of these leaves no margin for the bound by cells.
fn is_held(object: &CollisionObject, spheres: &[Ball]) -> bool {
    let (radius, length) = match object.shape.kind() {
        ShapeKind::Sphere { radius } => (*radius, 0.0),
        ShapeKind::Capsule { radius, length } => (*radius, *length),
        _ => return false,
    };
    rows::holds(spheres, radius, length, &object.link_from_shape)
}
