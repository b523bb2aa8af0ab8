//! Reduction of the protrusion of balls: moved, and no larger than their cells need.

use std::collections::BinaryHeap;

use super::cells::Cell;
use super::ranked::Ranked;
use super::solid::Solid;
use crate::collision::Ball;
use crate::interruption::is_stopped;
use crate::spatial::Vector3;

/// Number of subdivisions of the cells that need the largest radius.
const SPLITS: u32 = 3;
/// Rounds of coordinate search.
const ROUNDS: u32 = 12;
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
        let needs = cells.iter().map(|cell| cell.needs(centre));
        needs.fold(0.0, f64::max)
    };
    let out = |centre: Vector3<f64>| needed(centre) + solid.signed_distance(centre);
    let (mut centre, mut least) = (ball.centre, out(ball.centre));
    let mut step = max_protrusion / 2.0;
    for _ in 0..ROUNDS {
        if is_stopped() {
            break;
        }
        let before = least;
        for axis in Vector3::UNITS {
            for way in [step, -step] {
                let there = centre + axis * way;
                let found = out(there);
                if found < least {
                    (centre, least) = (there, found);
                }
            }
        }
        if least >= before {
            step /= 2.0;
        }
    }
    let radius = tight(solid, centre, cells);
    let radius = radius + ROUNDING * (radius + centre.norm());
    let out = radius + solid.signed_distance(centre);
    (Ball { centre, radius }, out.max(0.0))
}

/// The radius that the cells need. The cells that need the largest radius are subdivided first.
fn tight(solid: &Solid<'_>, centre: Vector3<f64>, cells: &[Cell]) -> f64 {
    let asking = |times: u32| move |cell: Cell| Ranked(cell.needs(centre), (times, cell));
    let mut heap: BinaryHeap<Ranked<(u32, Cell)>> = cells.iter().copied().map(asking(0)).collect();
    while let Some(Ranked(needs, (times, cell))) = heap.pop() {
        if times == SPLITS {
            return needs;
        }
        heap.extend(cell.split(solid).map(asking(times + 1)));
    }
    0.0
}
