//! Sphere cover of all shapes of one link.

use super::cells::{Cell, cells};
use super::solid::Solid;
use super::{Resolution, candidates, cover, rows, shrink};
use crate::collision::{Ball, CollisionObject, ShapeKind};
use kinopt_kinematics::bad_option::BadOption;
use kinopt_kinematics::interruption::is_stopped;

/// Ratio of the allowed protrusion to the width of the finest cells.
const CELLS_PER_PROTRUSION: f64 = 4.0;
/// Bisection steps on the protrusion to reach a number of spheres.
const STEPS: u32 = 8;

/// Spheres and their maximum protrusion, metres.
type SphereCover = (Vec<Ball>, f64);

pub(super) fn cover(
    objects: &[&CollisionObject],
    resolution: Resolution,
) -> Result<SphereCover, BadOption> {
    match resolution {
        Resolution::MaxProtrusion(max_protrusion) => cover_with_protrusion(objects, max_protrusion)
            .ok_or(BadOption {
                option: "max_protrusion",
                value: max_protrusion,
                allowed: "a larger part of the links' size",
            }),
        Resolution::PerLink(count) => Ok(cover_with_count(objects, count)),
    }
}

/// The cover with the least protrusion found for at most `count` spheres. It has more spheres if the shapes themselves
/// are more than `count` spheres.
fn cover_with_count(objects: &[&CollisionObject], count: usize) -> SphereCover {
    let size = Solid::new(objects.iter().copied()).bounds().half_diagonal();
    let (mut low, mut high) = (0.01 * size, 2.0 * size);
    let mut best = cover_with_protrusion(objects, 2.0 * size).unwrap_or_default();
    for _ in 0..STEPS {
        let middle = (low * high).sqrt();
        match cover_with_protrusion(objects, middle) {
            Some(candidate) if candidate.0.len() <= count => {
                high = middle;
                if candidate.1 < best.1 || best.0.len() > count {
                    best = candidate;
                }
            }
            _ => low = middle,
        }
    }
    best
}

/// Spheres that protrude at most `max_protrusion` metres; `None` if that needs too many cells.
fn cover_with_protrusion(objects: &[&CollisionObject], max_protrusion: f64) -> Option<SphereCover> {
    let mut balls = Vec::new();
    let mut protrusion: f64 = 0.0;
    let mut others = Vec::new();
    for object in objects {
        let placement = &object.link_from_shape;
        match object.shape.kind() {
            ShapeKind::Sphere { radius } => balls.push(Ball {
                centre: placement.translation,
                radius: *radius,
            }),
            ShapeKind::Points(cloud) => {
                balls.extend(cloud.positions().iter().map(|&position| Ball {
                    centre: placement.apply(position),
                    radius: cloud.radius(),
                }))
            }
            ShapeKind::Capsule { radius, length } => {
                let row = rows::row(*radius, *length, max_protrusion, placement);
                protrusion = row
                    .iter()
                    .map(|ball| ball.radius - radius)
                    .fold(protrusion, f64::max);
                balls.extend(row);
            }
            _ => others.push(*object),
        }
    }
    let solid = Solid::new(others);
    if solid.is_empty() {
        return Some((balls, protrusion));
    }
    let is_uncovered = |cell: &Cell| !cover::is_covered(&balls, cell);
    let (mut surface, mut inner) = cells(&solid, max_protrusion / CELLS_PER_PROTRUSION)?;
    surface.retain(is_uncovered);
    inner.retain(is_uncovered);
    let candidates = candidates::candidates(&solid, &surface, &inner, max_protrusion);
    let covered = cover::cover(&solid, surface, inner, &candidates, max_protrusion);
    for (ball, cells) in covered.balls.into_iter().zip(&covered.cells) {
        if is_stopped() {
            return None;
        }
        let (ball, ball_protrusion) = shrink::shrunk(&solid, ball, cells, max_protrusion);
        protrusion = protrusion.max(ball_protrusion);
        balls.push(ball);
    }
    Some((balls, protrusion))
}
