//! Targets of inverse kinematics over clips.

use kinopt::animation::curve::{KeyError, KeyedCurve};
use kinopt::glam::DVec3;

/// Curve of a reach through points at times in seconds, by default spread evenly over a span.
///
/// # Errors
/// If the times do not ascend, or their number is another one.
pub fn reach_curve(
    points: Vec<DVec3>,
    times: Option<Vec<f64>>,
    [from, to]: [f64; 2],
) -> Result<KeyedCurve<DVec3>, KeyError> {
    let times = times.unwrap_or_else(|| {
        let steps = points.len().saturating_sub(1).max(1) as f64;
        let times = (0..points.len()).map(|k| from + (to - from) * k as f64 / steps);
        times.collect()
    });
    KeyedCurve::catmull_rom(times, points)
}
