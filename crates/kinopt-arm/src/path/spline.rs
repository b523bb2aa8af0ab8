//! Spline paths.
//!
//! Positions follow the cubic Hermite segments of a Catmull-Rom spline over key times (Catmull & Rom 1974). The tangent
//! at a key is the displacement between its neighbours divided by the time between them, one-sided at the ends.
//! Orientations rotate at a constant rate from key to key.

use glam::DVec3;

use super::{CartesianPath, PathError};
use kinopt_kinematics::bad_option::{AT_LEAST_ONE, BadOption};
use kinopt_kinematics::curve::{Hermite, KeyedCurve};
use kinopt_kinematics::spatial::Placement;

impl CartesianPath {
    /// Creates a spline through keys (`base_from_tool`), sampled in `steps` uniform steps per segment, at least 1.
    ///
    /// The keys are among the points. The distance of the curve from the straight steps is part of the
    /// [deviation](super::PathReport::largest_deviation). Key times are uniform by default. Given times become the
    /// points' times.
    ///
    /// # Errors
    /// Returns the errors of [`new`](Self::new) and [`with_times`](Self::with_times) for the keys. Returns an error if
    /// `steps` is 0, or if the distances of keys overflow.
    pub fn spline(
        keys: impl Into<Vec<Placement<f64>>>,
        key_times: Option<&[f64]>,
        steps: usize,
    ) -> Result<Self, PathError> {
        let mut keyed = Self::new(keys)?;
        if let Some(times) = key_times {
            keyed = keyed.with_times(times)?;
        }
        BadOption::check("steps", steps as f64, AT_LEAST_ONE)?;
        let keys = &keyed.points;
        let times = match key_times {
            Some(times) => times.to_vec(),
            None => (0..keys.len()).map(|k| k as f64).collect(),
        };
        let positions = keys.iter().map(|key| key.translation.into());
        let curve = KeyedCurve::<DVec3>::catmull_rom(times, positions.collect())?;
        let mut path = Self::new(keys[..1].to_vec())?;
        if key_times.is_some() {
            path.times.extend(curve.times().first());
        }
        for (ends, (segment, times)) in keys.windows(2).zip(curve.cubics()) {
            path.append_cubic(&segment, ends[1], steps);
            if key_times.is_some() {
                let fractions = (1..=steps).map(|step| step as f64 / steps as f64);
                let times = fractions.map(|fraction| times[0] + fraction * (times[1] - times[0]));
                path.times.extend(times);
            }
        }
        Ok(path)
    }

    /// Appends a cubic segment from the last point to `to`, in `steps` uniform steps.
    pub(super) fn append_cubic(
        &mut self,
        segment: &Hermite<DVec3>,
        to: Placement<f64>,
        steps: usize,
    ) {
        self.append_segment(to, steps, |fraction, before| {
            let bulge = bulge(segment, before, fraction);
            (segment.position(fraction).into(), bulge)
        });
    }
}

/// Returns a bound on the distance of a curve from the chord between two of its points.
///
/// The second derivative is linear, so its maximum is at an end. The distance is at most an eighth of that maximum,
/// times the squared length of the interval.
fn bulge(curve: &Hermite<DVec3>, from: f64, to: f64) -> f64 {
    let bend = |t: f64| {
        (curve.start - curve.end) * (12.0 * t - 6.0)
            + curve.leaving * (6.0 * t - 4.0)
            + curve.arriving * (6.0 * t - 2.0)
    };
    let longest = bend(from).length().max(bend(to).length());
    0.125 * (to - from) * (to - from) * longest
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::{Hermite, bulge};

    /// The curvature of an S-curve is zero in the middle and largest at its ends, so the outer end bounds either half.
    #[test]
    fn chord_distance_stays_within_bulge() {
        let tangent = DVec3::new(1.0, 1.0, 0.0);
        let curve = Hermite {
            start: DVec3::ZERO,
            end: DVec3::X,
            leaving: tangent,
            arriving: tangent,
        };
        for (from, to) in [
            (0.0, 0.5),
            (0.5, 1.0),
            (0.25, 0.75),
            (0.0, 1.0),
            (0.5, 0.75),
        ] {
            let position_at = |fraction: f64| curve.position(from + fraction * (to - from));
            let distance = |fraction: f64| {
                (position_at(fraction) - position_at(0.0).lerp(position_at(1.0), fraction)).length()
            };
            let max_distance = (0..=100).map(|k| distance(f64::from(k) / 100.0));
            let max_distance = max_distance.fold(0.0, f64::max);
            let bound = bulge(&curve, from, to);
            assert!(
                max_distance <= bound && bound < 8.0 * max_distance,
                "{from} {to}: {max_distance} {bound}"
            );
        }
    }
}
