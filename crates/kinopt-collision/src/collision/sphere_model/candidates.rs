//! Candidate spheres: balls about points of the medial axis and other interior points.

use super::cells::Cell;
use super::solid::Solid;
use crate::collision::Ball;
use kinopt_kinematics::bisection::bisect;
use kinopt_kinematics::interruption::is_stopped;
use kinopt_kinematics::spatial::Vector3;

/// Number of candidates for a link.
const MAX_CANDIDATES: usize = 400;
/// Bisection steps for the largest ball that touches the surface at a point.
const HALVINGS: usize = 24;

/// Balls that protrude at most `max_protrusion` metres. Their centres are points of the medial axis (centres of the largest
/// inscribed balls that touch the surface) and other interior points.
pub(super) fn candidates(
    solid: &Solid<'_>,
    surface: &[Cell],
    inner: &[Cell],
    max_protrusion: f64,
) -> Vec<Ball> {
    let largest = solid.bounds().half_diagonal();
    let mut balls = Vec::new();
    for cell in spread(surface, 3 * MAX_CANDIDATES / 4) {
        if is_stopped() {
            return balls;
        }
        let centre = medial_centre(solid, cell, largest).unwrap_or(cell.anchor);
        balls.push(grown(solid, centre, max_protrusion));
    }
    let inside = surface.iter().chain(inner).filter(|cell| cell.depth > 0.0);
    let inside: Vec<Cell> = inside.copied().collect();
    balls.extend(
        spread(&inside, MAX_CANDIDATES / 4).map(|cell| grown(solid, cell.centre, max_protrusion)),
    );
    balls
}

/// At most `count` cells, evenly spaced in their order, which follows space.
fn spread(cells: &[Cell], count: usize) -> impl Iterator<Item = &Cell> {
    cells.iter().step_by(cells.len().div_ceil(count).max(1))
}

/// The largest ball about a point that protrudes at most `max_protrusion` metres.
pub(super) fn grown(solid: &Solid<'_>, centre: Vector3<f64>, max_protrusion: f64) -> Ball {
    let radius = (max_protrusion - solid.signed_distance(centre)).max(0.0);
    Ball { centre, radius }
}

/// Centre of the largest inscribed ball that touches the surface next to a cell.
fn medial_centre(solid: &Solid<'_>, cell: &Cell, largest: f64) -> Option<Vector3<f64>> {
    let surface_point = solid.nearest(cell.centre);
    let offset = match cell.depth > 0.0 {
        true => cell.centre - surface_point,
        false => surface_point - cell.centre,
    };
    let length = offset.norm();
    if length < 1e-9 * largest {
        return None;
    }
    let inward = offset * length.recip();
    let ball_centre = |t: f64| surface_point + inward * t;
    let is_inscribed = |t: f64| -solid.signed_distance(ball_centre(t)) >= t * (1.0 - 1e-3);
    Some(ball_centre(bisect(0.0, largest, HALVINGS, is_inscribed)))
}
