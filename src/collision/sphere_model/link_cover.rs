//! Sphere cover of all shapes of one link.

use super::cells::{Cell, cells};
use super::solid::Solid;
use super::{Resolution, candidates, cover, rows, shrink};
use crate::bad_option::BadOption;
use crate::collision::{Ball, CollisionObject, ShapeKind};
use crate::interruption::is_stopped;

/// Ratio of the allowed protrusion to the width of the finest cells.
const FINER: f64 = 4.0;
/// Bisection steps on the protrusion to reach a number of spheres.
const STEPS: u32 = 8;

/// Spheres and their maximum protrusion, metres.
type Covered = (Vec<Ball>, f64);

pub(super) fn cover(
    objects: &[&CollisionObject],
    fineness: Resolution,
) -> Result<Covered, BadOption> {
    match fineness {
        Resolution::MaxProtrusion(max_protrusion) => {
            within(objects, max_protrusion).ok_or(BadOption {
                option: "max_protrusion",
                value: max_protrusion,
                allowed: "a larger part of the links' size",
            })
        }
        Resolution::PerLink(count) => Ok(so_many(objects, count)),
    }
}

/// The cover with the least protrusion found for at most `count` spheres. It has more spheres if the shapes themselves
/// are more than `count` spheres.
fn so_many(objects: &[&CollisionObject], count: usize) -> Covered {
    let size = Solid::new(objects.iter().copied()).bounds().half_diagonal();
    let (mut low, mut high) = (0.01 * size, 2.0 * size);
    let mut best = within(objects, 2.0 * size).unwrap_or_default();
    for _ in 0..STEPS {
        let middle = (low * high).sqrt();
        match within(objects, middle) {
            Some(found) if found.0.len() <= count => {
                high = middle;
                if found.1 < best.1 || best.0.len() > count {
                    best = found;
                }
            }
            _ => low = middle,
        }
    }
    best
}

/// Spheres that protrude at most `max_protrusion` metres; `None` if that needs too many cells.
fn within(objects: &[&CollisionObject], max_protrusion: f64) -> Option<Covered> {
    let mut balls = Vec::new();
    let mut out: f64 = 0.0;
    let mut others = Vec::new();
    for object in objects {
        let place = &object.link_from_shape;
        match object.shape.kind() {
            ShapeKind::Sphere { radius } => balls.push(Ball {
                centre: place.translation,
                radius: *radius,
            }),
            ShapeKind::Points(cloud) => balls.extend(cloud.positions().iter().map(|&at| Ball {
                centre: place.apply(at),
                radius: cloud.radius(),
            })),
            ShapeKind::Capsule { radius, length } => {
                let row = rows::row(*radius, *length, max_protrusion, place);
                out = row
                    .iter()
                    .map(|ball| ball.radius - radius)
                    .fold(out, f64::max);
                balls.extend(row);
            }
            _ => others.push(*object),
        }
    }
    let solid = Solid::new(others);
    if solid.is_empty() {
        return Some((balls, out));
    }
    let free = |cell: &Cell| !cover::holds(&balls, cell);
    let (mut surface, mut inner) = cells(&solid, max_protrusion / FINER)?;
    surface.retain(free);
    inner.retain(free);
    let candidates = candidates::candidates(&solid, &surface, &inner, max_protrusion);
    let covered = cover::cover(&solid, surface, inner, &candidates, max_protrusion);
    for (ball, cells) in covered.balls.into_iter().zip(&covered.cells) {
        if is_stopped() {
            return None;
        }
        let (ball, sticks) = shrink::shrunk(&solid, ball, cells, max_protrusion);
        out = out.max(sticks);
        balls.push(ball);
    }
    Some((balls, out))
}
