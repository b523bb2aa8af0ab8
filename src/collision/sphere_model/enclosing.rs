//! A small ball around others.

use crate::collision::Ball;
use crate::spatial::Vector3;

/// Steps of the walk to the middle.
const STEPS: u32 = 300;

/// A ball around all others, within a hundredth or so of the least: the centre walks towards whatever is farthest
/// in ever shorter steps (Bădoiu & Clarkson 2003). About the origin of radius 0 where there are none.
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
        let way = farthest.centre - centre;
        let length = way.norm();
        // To the far side of that ball.
        let target = match length > 0.0 {
            true => way * (1.0 + farthest.radius / length),
            false => Vector3::zero(),
        };
        centre += target * f64::from(step + 1).recip();
        let here = around(balls, centre);
        if here.radius < best.radius {
            best = here;
        }
    }
    best
}

fn around(balls: &[Ball], centre: Vector3<f64>) -> Ball {
    let reach = |ball: &Ball| (ball.centre - centre).norm() + ball.radius;
    let radius = balls.iter().map(reach).fold(0.0, f64::max);
    // What rounding may hide.
    let radius = radius * (1.0 + 8.0 * f64::EPSILON);
    Ball { centre, radius }
}
