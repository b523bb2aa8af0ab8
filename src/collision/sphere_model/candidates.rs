//! Where spheres may stand: the largest balls within a solid, each as large as it may be.

use super::cells::Cell;
use super::solid::Solid;
use crate::bisection::bisect;
use crate::collision::Ball;
use crate::interruption::is_stopped;
use crate::spatial::Vector3;

/// So many spheres are tried for a link.
const TRIED: usize = 400;
/// Halvings on the way to the largest ball that touches the surface at a point.
const HALVINGS: usize = 24;

/// Balls that stick out no further than `overhang`: about the middles of the largest balls that touch the surface
/// from within (points of the medial axis), and about other places within.
pub(super) fn candidates(
    solid: &Solid<'_>,
    surface: &[Cell],
    inner: &[Cell],
    overhang: f64,
) -> Vec<Ball> {
    let largest = solid.bounds().half_diagonal();
    let mut balls = Vec::new();
    for cell in spread(surface, 3 * TRIED / 4) {
        if is_stopped() {
            return balls;
        }
        let centre = medial(solid, cell, largest).unwrap_or(cell.heart);
        balls.push(grown(solid, centre, overhang));
    }
    let within = surface.iter().chain(inner).filter(|cell| cell.depth > 0.0);
    let within: Vec<Cell> = within.copied().collect();
    balls.extend(spread(&within, TRIED / 4).map(|cell| grown(solid, cell.centre, overhang)));
    balls
}

/// At most so many of them, evenly by their order, which goes through space.
fn spread(cells: &[Cell], count: usize) -> impl Iterator<Item = &Cell> {
    cells.iter().step_by(cells.len().div_ceil(count).max(1))
}

/// As large as a ball about a point may be.
pub(super) fn grown(solid: &Solid<'_>, centre: Vector3<f64>, overhang: f64) -> Ball {
    let radius = (overhang - solid.signed_distance(centre)).max(0.0);
    Ball { centre, radius }
}

/// The middle of the largest ball within the solid that touches its surface next to a cell.
fn medial(solid: &Solid<'_>, cell: &Cell, largest: f64) -> Option<Vector3<f64>> {
    let foot = solid.nearest(cell.centre);
    let way = match cell.depth > 0.0 {
        true => cell.centre - foot,
        false => foot - cell.centre,
    };
    let length = way.norm();
    if length < 1e-9 * largest {
        return None;
    }
    let inward = way * length.recip();
    let at = |t: f64| foot + inward * t;
    let touches = |t: f64| -solid.signed_distance(at(t)) >= t * (1.0 - 1e-3);
    Some(at(bisect(0.0, largest, HALVINGS, touches)))
}
