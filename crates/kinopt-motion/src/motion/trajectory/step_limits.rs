//! Displacement bounds between samples from velocity limits.

use std::f64::consts::PI;

use super::MotionError;
use super::bounds::{DisplacementLimits, max_displacement};
use super::length_limits::LengthLimit;
use kinopt_kinematics::bad_option::{BadOption, POSITIVE};
use kinopt_kinematics::model::{ParameterMap, Source};
use kinopt_solver::problem::Problem;

/// Assumed absolute value of a variable without limits, for rounding errors, radians or metres.
const UNBOUNDED_SIZE: f64 = 1e4;

/// Returns the displacement bounds of all variables, including those from mimic joints, and of ball joints.
pub(in crate::motion) fn step_limits(
    problem: &Problem,
    speeds: &[f64],
    time_step_s: f64,
) -> Result<DisplacementLimits, MotionError> {
    let map = problem.parameters();
    let mut max_step = vec![f64::INFINITY; problem.variables()];
    let mut lengths = Vec::new();
    for ball in map.balls() {
        let speed = speeds[ball.coordinate];
        if speed.is_finite() {
            let angle = max_displacement(speed, time_step_s, PI);
            BadOption::check("max_speed", angle, POSITIVE)?;
            lengths.extend(LengthLimit::for_rotation(ball, angle));
        }
    }
    for (source, &speed) in map
        .sources()
        .iter()
        .zip(speeds)
        .filter(|(_, s)| s.is_finite())
    {
        match *source {
            Source::Constant(_) | Source::Rotation { .. } => {}
            Source::Variable {
                variable,
                ratio,
                offset,
            } if ratio != 0.0 => {
                let ends = [map.lower()[variable], map.upper()[variable]];
                let size = ends.map(|end| {
                    if end.is_finite() {
                        end.abs()
                    } else {
                        UNBOUNDED_SIZE
                    }
                });
                let size = ratio.abs() * size[0].max(size[1]) + offset.abs();
                let step = max_displacement(speed, time_step_s, size) / ratio.abs();
                BadOption::check("max_speed", step, POSITIVE)?;
                max_step[variable] = max_step[variable].min(step);
            }
            Source::Variable { .. } => {}
        }
    }
    Ok(DisplacementLimits { max_step, lengths })
}

/// Returns the bound on the translation of a free joint, in any direction. `first` is its first coordinate.
pub(super) fn translation_limit(
    map: &ParameterMap,
    first: usize,
    speed: f64,
    time_step_s: f64,
) -> Result<Option<LengthLimit>, MotionError> {
    let max_length = max_displacement(speed, time_step_s, UNBOUNDED_SIZE);
    BadOption::check("max_free_speed", max_length, POSITIVE)?;
    Ok(LengthLimit::for_translation(map, first, max_length))
}
