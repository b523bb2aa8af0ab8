//! Linear interpolation in joint space.

use crate::problem::{Problem, ProblemInstance};
use crate::solver::ConfigurationSpace;

/// Returns the variable that moves furthest relative to its `unit`, and by how much, in radians.
///
/// `unit` is 1 for angles and a length for prismatic joints. A ball joint counts with its rotation angle. `way` is a
/// buffer with one entry per variable.
pub(super) fn furthest_move(
    problem: &Problem,
    unit: &[f64],
    [from, to]: [&[f64]; 2],
    way: &mut [f64],
) -> Option<(usize, f64)> {
    ProblemInstance::from(problem)
        .space()
        .difference(to, from, way);
    for ball in problem.parameters().balls() {
        let turned = ball.angle_between(from, to);
        way[ball.variable..ball.variable + 3].copy_from_slice(&[turned, 0.0, 0.0]);
    }
    let moves = way.iter().zip(unit);
    let moves = moves.map(|(way, unit)| way.abs() / unit);
    moves.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Writes the point at the fraction `share` of the motion into `at`, within the limits of ball joints. `way` is a
/// buffer.
pub(super) fn go_share(
    space: ConfigurationSpace<'_>,
    [from, to]: [&[f64]; 2],
    share: f64,
    way: &mut [f64],
    at: &mut [f64],
) {
    space.difference(to, from, way);
    space.integrate_share(from, share, way, at);
    space.project(at);
}
