//! Joint values, velocities and accelerations over time, between the rows of a path.

use super::cell::{CurveState, GridCell};
use super::cubic_curve::CubicCurve;
use super::easing::SmoothstepEasing;

/// Joint values and their derivatives at one time of a [`TimedSpline`].
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct TrajectoryPoint {
    /// Joint values, radians or metres.
    pub q: Vec<f64>,
    /// Joint velocities, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Joint accelerations, rad/s² or m/s².
    pub acceleration: Vec<f64>,
}

/// Joint values over time between the rows of a path: the report of a path's [`Trajectory`](kinopt_kinematics::Trajectory).
///
/// Created by [`JointPath::trajectory`](crate::arm::JointPath::trajectory).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct TimedSpline {
    pub(super) joints: usize,
    /// First row, used if there is no motion.
    pub(super) first: Vec<f64>,
    pub(super) motions: Vec<Motion>,
    pub(super) duration: f64,
}

/// Motion along one curve, from rest to rest.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Motion {
    /// Time at the start, seconds.
    pub(super) time: f64,
    pub(super) curve: CubicCurve,
    /// Curve parameter as a function of the cells' parameter; `None` if they are the same.
    pub(super) easing: Option<SmoothstepEasing>,
    pub(super) cells: Vec<GridCell>,
}

impl TimedSpline {
    /// Number of stretches from rest to rest, including reconfigurations.
    #[must_use]
    pub fn stretch_count(&self) -> usize {
        self.motions.len()
    }

    /// Returns joint values, velocities and accelerations at a time in seconds. Before the start and after the end the
    /// arm is at rest. NaN counts as the start.
    #[must_use]
    pub fn at(&self, time: f64) -> TrajectoryPoint {
        let mut point = TrajectoryPoint::default();
        self.write_at(time, &mut point);
        point
    }

    /// Writes [`at`](Self::at) into an existing point, without allocation once the point has been used.
    pub fn write_at(&self, time: f64, point: &mut TrajectoryPoint) {
        for numbers in [&mut point.q, &mut point.velocity, &mut point.acceleration] {
            numbers.clear();
        }
        let is_outside = time < 0.0 || time > self.duration;
        // `max` ignores NaN, which becomes the start.
        let time = time.max(0.0).min(self.duration);
        let after = self.motions.partition_point(|motion| motion.time <= time);
        let Some(motion) = self.motions.get(after.saturating_sub(1)) else {
            point.q.extend(&self.first);
            point.velocity.resize(self.joints, 0.0);
            point.acceleration.resize(self.joints, 0.0);
            return;
        };
        let state = motion.state(time - motion.time);
        let curve = &motion.curve;
        for jet in curve.jets(curve.piece(state.position), state.position) {
            point.q.push(jet.value);
            point.velocity.push(jet.first * state.speed);
            let along = jet.first * state.acceleration;
            point
                .acceleration
                .push(jet.second * state.speed * state.speed + along);
        }
        if time <= 0.0 || time >= self.duration {
            point.velocity.fill(0.0);
        }
        if is_outside {
            point.acceleration.fill(0.0);
        }
    }
}

impl Motion {
    /// Duration, seconds.
    pub(super) fn duration(&self) -> f64 {
        let last = self.cells.last();
        last.map_or(0.0, |cell| cell.time + cell.time_to(cell.length))
    }

    /// Returns the state of the curve parameter at a time from the start of the motion, seconds.
    pub(super) fn state(&self, time: f64) -> CurveState {
        let after = self.cells.partition_point(|cell| cell.time <= time);
        let cell = &self.cells[after.saturating_sub(1)];
        let state = cell.at(time - cell.time);
        let state = match &self.easing {
            Some(easing) => easing.state(state),
            None => state,
        };
        CurveState {
            position: state.position.clamp(self.curve.start(), self.curve.end()),
            ..state
        }
    }

    /// Returns the time at which the motion reaches a curve parameter, seconds from its start.
    pub(super) fn time_at(&self, s: f64) -> f64 {
        let parameter = match &self.easing {
            Some(easing) => easing.parameter(s),
            None => s,
        };
        let after = self.cells.partition_point(|cell| cell.start <= parameter);
        let cell = &self.cells[after.saturating_sub(1)];
        cell.time + cell.time_to((parameter - cell.start).min(cell.length))
    }
}
