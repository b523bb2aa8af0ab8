//! Reduction of the protrusion of balls: moved, and no larger than their cells need.

use std::collections::BinaryHeap;

use super::cells::Cell;
use super::ranked::Ranked;
use super::solid::Solid;
use crate::collision::Ball;
use kinopt_kinematics::interruption::is_stopped;
use kinopt_kinematics::spatial::Vector3;

/// Number of subdivisions of the cells that need the largest radius.
const MAX_LEVEL: u32 = 3;
/// Rounds of coordinate search.
const SEARCH_ROUNDS: u32 = 12;
/// Relative rounding of a radius.
const ROUNDING: f64 = 1e-12;

/// The ball that contains its cells, and its protrusion from the solid, metres.
pub(super) fn shrunk(
    solid: &Solid<'_>,
    ball: Ball,
    cells: &[Cell],
    max_protrusion: f64,
) -> (Ball, f64) {
    let needed = |centre: Vector3<f64>| {
        let needs = cells.iter().map(|cell| cell.required_radius(centre));
        needs.fold(0.0, f64::max)
    };
    let protrusion = |centre: Vector3<f64>| needed(centre) + solid.signed_distance(centre);
    let (mut centre, mut min_protrusion) = (ball.centre, protrusion(ball.centre));
    let mut step = max_protrusion / 2.0;
    for _ in 0..SEARCH_ROUNDS {
        if is_stopped() {
            break;
        }
        let previous = min_protrusion;
        for axis in Vector3::UNITS {
            for offset in [step, -step] {
                let candidate = centre + axis * offset;
                let candidate_protrusion = protrusion(candidate);
                if candidate_protrusion < min_protrusion {
                    (centre, min_protrusion) = (candidate, candidate_protrusion);
                }
            }
        }
        if min_protrusion >= previous {
            step /= 2.0;
        }
    }
    let radius = tight_radius(solid, centre, cells);
    let radius = radius + ROUNDING * (radius + centre.norm());
    let protrusion = radius + solid.signed_distance(centre);
    (Ball { centre, radius }, protrusion.max(0.0))
}

/// The radius that the cells need. The cells that need the largest radius are subdivided first.
fn tight_radius(solid: &Solid<'_>, centre: Vector3<f64>, cells: &[Cell]) -> f64 {
    let ranked = |level: u32| move |cell: Cell| Ranked(cell.required_radius(centre), (level, cell));
    let mut heap: BinaryHeap<Ranked<(u32, Cell)>> = cells.iter().copied().map(ranked(0)).collect();
    while let Some(Ranked(radius, (level, cell))) = heap.pop() {
        if level == MAX_LEVEL {
            return radius;
        }
        heap.extend(cell.split(solid).map(ranked(level + 1)));
    }
    0.0
}
