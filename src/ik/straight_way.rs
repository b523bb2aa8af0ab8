//! The straight way of a body from one place to another, on which all its variables go evenly.

use crate::problem::{Problem, Question};
use crate::solver::ConfigurationSpace;

/// The variable that goes furthest for what it may (its unit, a radian for what turns), and how far, in radians: of a ball the
/// angle that it turns by. `way` is memory of as many numbers.
pub(super) fn furthest_move(
    problem: &Problem,
    unit: &[f64],
    [from, to]: [&[f64]; 2],
    way: &mut [f64],
) -> Option<(usize, f64)> {
    Question::from(problem).space().difference(to, from, way);
    for ball in problem.parameters().balls() {
        let turned = ball.angle_between(from, to);
        way[ball.variable..ball.variable + 3].copy_from_slice(&[turned, 0.0, 0.0]);
    }
    let moves = way.iter().zip(unit);
    let moves = moves.map(|(way, unit)| way.abs() / unit);
    moves.enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
}

/// Where a share of the way leads, within the limits of balls. `way` is memory of as many numbers.
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
