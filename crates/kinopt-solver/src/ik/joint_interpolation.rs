//! Linear interpolation in joint space.

use crate::problem::{Problem, ProblemInstance};
use crate::solver::ConfigurationSpace;

/// Returns the variable that moves furthest relative to its `units`, and by how much, in radians.
///
/// `units` is 1 for angles and a length for prismatic joints. A ball joint counts with its rotation angle.
/// `displacement` is a buffer with one entry per variable.
pub(super) fn max_displacement(
    problem: &Problem,
    units: &[f64],
    [from, to]: [&[f64]; 2],
    displacement: &mut [f64],
) -> Option<(usize, f64)> {
    ProblemInstance::from(problem)
        .space()
        .difference(to, from, displacement);
    for ball in problem.parameters().balls() {
        let angle = ball.angle_between(from, to);
        displacement[ball.variable..ball.variable + 3].copy_from_slice(&[angle, 0.0, 0.0]);
    }
    let displacements = displacement.iter().zip(units);
    let displacements = displacements.map(|(displacement, unit)| displacement.abs() / unit);
    displacements.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Writes the point at the given `fraction` of the motion into `x`, within the limits of ball joints. `displacement` is
/// a buffer.
pub(super) fn interpolate(
    space: ConfigurationSpace<'_>,
    [from, to]: [&[f64]; 2],
    fraction: f64,
    displacement: &mut [f64],
    x: &mut [f64],
) {
    space.difference(to, from, displacement);
    space.integrate_share(from, fraction, displacement, x);
    space.project(x);
}
