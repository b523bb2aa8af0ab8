//! Small bounding sphere of balls.

use crate::collision::Ball;
use kinopt_kinematics::spatial::Vector3;

/// Number of steps of the centre.
const STEPS: u32 = 300;

/// A bounding sphere within about 1 % of the smallest.
///
/// The centre moves towards the farthest ball in ever shorter steps (Bădoiu & Clarkson 2003). Without balls, the result
/// is at the origin with radius 0.
pub(crate) fn enclosing(balls: &[Ball]) -> Ball {
    let Some(first) = balls.first() else {
        return Ball::default();
    };
    let mut centre = first.centre;
    let mut best = around(balls, centre);
    for step in 1..=STEPS {
        let reach = |ball: &&Ball| (ball.centre - centre).norm() + ball.radius;
        let farthest = balls.iter().max_by(|a, b| reach(a).total_cmp(&reach(b)));
        let Some(farthest) = farthest else {
            break;
        };
        let offset = farthest.centre - centre;
        let length = offset.norm();
        // Aims at the far side of that ball.
        let target = match length > 0.0 {
            true => offset * (1.0 + farthest.radius / length),
            false => Vector3::zero(),
        };
        centre += target * f64::from(step + 1).recip();
        let candidate = around(balls, centre);
        if candidate.radius < best.radius {
            best = candidate;
        }
    }
    best
}

fn around(balls: &[Ball], centre: Vector3<f64>) -> Ball {
    let reach = |ball: &Ball| (ball.centre - centre).norm() + ball.radius;
    let radius = balls.iter().map(reach).fold(0.0, f64::max);
    // Margin for rounding.
    let radius = radius * (1.0 + 8.0 * f64::EPSILON);
    Ball { centre, radius }
}
