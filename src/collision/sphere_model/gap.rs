//! How much of a solid others' spheres leave uncovered.

use std::collections::BinaryHeap;

use super::cells::{Cell, whole};
use super::ranked::Ranked;
use super::rows;
use super::solid::Solid;
use crate::collision::{Ball, CollisionObject, ShapeKind};
use crate::spatial::Vector3;

/// A gap is told to such a share of the solid's size.
const PRECISION: f64 = 2e-3;
/// So many cells are looked at, at most: what is told then is more than it need be.
const CELLS: usize = 20_000;

/// How far a point of the solid may lie outside all spheres, metres: never less than it truly is, 0 where all of it surely lies in them. By
/// branch and bound over an octree, the cell whose points may lie farthest out first.
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
        // One that is almost covered is split until it is or the cells are used up, so that what surely covers is told to.
        let is_known = at_least > 0.0 && most <= at_least + precision;
        looked_at += 1;
        if is_known || looked_at == CELLS {
            return most;
        }
        heap.extend(cell.split(solid).map(at_most));
    }
    0.0
}

/// Whether spheres hold a sphere or a capsule, which have no room to spare where they are held by as small ones as can be.
fn is_held(object: &CollisionObject, spheres: &[Ball]) -> bool {
    let (radius, length) = match object.shape.kind() {
        ShapeKind::Sphere { radius } => (*radius, 0.0),
        ShapeKind::Capsule { radius, length } => (*radius, *length),
        _ => return false,
    };
    rows::holds(spheres, radius, length, &object.link_from_shape)
}
