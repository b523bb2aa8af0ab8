//! Samples with a given configuration.

use super::MotionError;
use super::length_limits::{LengthLimit, Measure};
use crate::model::{Limits, Source, quaternion_at};
use crate::problem::Problem;
use crate::search::check_start;

/// Tolerance of swing, twist and angle limits for rounding, in radians and relative.
const ON_EDGE: f64 = 1e-9;

/// Returns the variables of a fixed configuration.
pub(super) fn fixed_frame(problem: &Problem, q: &[f64]) -> Result<Vec<f64>, MotionError> {
    check_start(problem, q)?;
    let map = problem.parameters();
    for (variable, &leader) in map.leaders().iter().enumerate() {
        let limits = Limits::new(map.lower()[variable], map.upper()[variable]);
        let is_ball = matches!(map.sources()[leader], Source::Rotation { .. });
        if !is_ball && !limits.contains(q[leader]) {
            return Err(MotionError::FixedBeyond {
                joint: problem.names().joints[variable].clone(),
                value: q[leader],
                lower: limits.lower,
                upper: limits.upper,
            });
        }
    }
    let mut x = vec![0.0; problem.variables()];
    map.gather(q, &mut x);
    refuse_beyond_balls(problem, q)?;
    Ok(x)
}

/// Returns an error if a ball joint is beyond its swing, twist or angle limit.
fn refuse_beyond_balls(problem: &Problem, q: &[f64]) -> Result<(), MotionError> {
    let map = problem.parameters();
    let mut x = vec![0.0; problem.variables()];
    for ball in map.balls() {
        let rotation = quaternion_at(&q[ball.coordinate..]);
        let own = rotation.map_or([f64::NAN; 3], |rotation| ball.chart.variables(rotation));
        x[ball.variable..ball.variable + 3].copy_from_slice(&own);
    }
    let beyond = |variable: usize, value: f64, [lower, upper]: [f64; 2]| MotionError::FixedBeyond {
        joint: problem.names().variables[variable].clone(),
        value,
        lower,
        upper,
    };
    for limit in LengthLimit::of_balls(map) {
        let [first, second, third] = limit.variables;
        let stretched = limit.rho(&x, &x).norm();
        if stretched > limit.most * (1.0 + ON_EDGE) {
            let angle = match limit.measure {
                Measure::Swing(..) => (x[first] * x[first] + x[second] * x[second]).sqrt(),
                _ => stretched,
            };
            return Err(beyond(first, angle, [0.0, angle * limit.most / stretched]));
        }
        let ends = [map.lower()[third], map.upper()[third]];
        let twist = x[third];
        if twist < ends[0] - ON_EDGE || twist > ends[1] + ON_EDGE {
            return Err(beyond(third, twist, ends));
        }
    }
    Ok(())
}
