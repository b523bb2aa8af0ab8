//! Samples with a given configuration.

use super::MotionError;
use super::length_limits::{LengthLimit, Measure};
use kinopt_kinematics::model::{Limits, Source, quaternion_at};
use kinopt_solver::problem::Problem;
use kinopt_solver::search::check_start;

/// Tolerance of swing, twist and angle limits for rounding, in radians and relative.
const LIMIT_TOLERANCE: f64 = 1e-9;

/// Returns the variables of a fixed configuration.
pub(super) fn fixed_frame(problem: &Problem, q: &[f64]) -> Result<Vec<f64>, MotionError> {
    check_start(problem, q)?;
    let map = problem.parameters();
    for (variable, &coordinate) in map.leaders().iter().enumerate() {
        let limits = Limits::new(map.lower()[variable], map.upper()[variable]);
        let is_ball = matches!(map.sources()[coordinate], Source::Rotation { .. });
        if !is_ball && !limits.contains(q[coordinate]) {
            return Err(MotionError::FixedBeyond {
                joint: problem.names().joints[variable].clone(),
                value: q[coordinate],
                lower: limits.lower,
                upper: limits.upper,
            });
        }
    }
    let mut x = vec![0.0; problem.variables()];
    map.gather(q, &mut x);
    check_ball_limits(problem, q)?;
    Ok(x)
}

/// Returns an error if a ball joint is beyond its swing, twist or angle limit.
fn check_ball_limits(problem: &Problem, q: &[f64]) -> Result<(), MotionError> {
    let map = problem.parameters();
    let mut x = vec![0.0; problem.variables()];
    for ball in map.balls() {
        let rotation = quaternion_at(&q[ball.coordinate..]);
        let variables = rotation.map_or([f64::NAN; 3], |rotation| ball.chart.variables(rotation));
        x[ball.variable..ball.variable + 3].copy_from_slice(&variables);
    }
    let limit_error =
        |variable: usize, value: f64, [lower, upper]: [f64; 2]| MotionError::FixedBeyond {
            joint: problem.names().variables[variable].clone(),
            value,
            lower,
            upper,
        };
    for limit in LengthLimit::for_balls(map) {
        let [first, second, third] = limit.variables;
        let length = limit.rho(&x, &x).norm();
        if length > limit.max_length * (1.0 + LIMIT_TOLERANCE) {
            let angle = match limit.measure {
                Measure::Swing(..) => (x[first] * x[first] + x[second] * x[second]).sqrt(),
                _ => length,
            };
            return Err(limit_error(
                first,
                angle,
                [0.0, angle * limit.max_length / length],
            ));
        }
        let ends = [map.lower()[third], map.upper()[third]];
        let twist = x[third];
        if twist < ends[0] - LIMIT_TOLERANCE || twist > ends[1] + LIMIT_TOLERANCE {
            return Err(limit_error(third, twist, ends));
        }
    }
    Ok(())
}
