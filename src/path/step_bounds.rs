//! Bounds on joint displacements between knots and between stations.

use super::knots::Knots;
use crate::arm::Arm;

/// Longest joint displacement between stations, radians; beyond it, configurations count as different branches.
const MAX_STATION_STEP: f64 = 0.3;
/// Longest joint displacement in a part of a long step, relative to that of a step.
const PART_STEP_RATIO: f64 = 0.5;
/// Relative tolerance of the bounds.
const ROUNDING: f64 = 1e-9;

/// Bounds on joint displacements.
#[derive(Debug)]
pub(super) struct StepBounds {
    /// Bound of a step for each joint, radians or metres.
    max_step: Vec<f64>,
    /// Bound between stations for each joint, radians or metres.
    station_step: Vec<f64>,
    /// Velocity limits, rad/s or m/s; empty if times do not count.
    speeds: Vec<f64>,
}

impl StepBounds {
    /// Creates the bounds. `max_step` is in radians; prismatic joints are scaled by the arm.
    pub(super) fn new(arm: &Arm, max_step: f64, speeds: Vec<f64>) -> Self {
        let per_joint = |radians: f64| arm.scales().iter().map(|scale| radians / scale).collect();
        Self {
            max_step: per_joint(max_step),
            station_step: per_joint(max_step.max(MAX_STATION_STEP)),
            speeds,
        }
    }

    /// Writes the displacement bound of each joint from one knot to a later one.
    pub(super) fn write(&self, knots: &Knots, from: usize, to: usize, limits: &mut Vec<f64>) {
        limits.clear();
        let steps = (to - from) as f64;
        let joints = self.max_step.iter().zip(&self.station_step);
        limits.extend(joints.map(|(step, station)| (steps * step).min(*station)));
        let time_limits = self.time_limits(knots, from, to).into_iter().flatten();
        for (limit, time_limit) in limits.iter_mut().zip(time_limits) {
            *limit = limit.min(time_limit);
        }
    }

    /// Returns whether no joint exceeds its bound from one knot to the next.
    pub(super) fn allows(&self, knots: &Knots, to: usize, q_from: &[f64], q_to: &[f64]) -> bool {
        self.allows_scaled(1.0, knots, to, q_from, q_to)
    }

    /// Returns the same for a step with `allowance` times the bound. Velocity limits stay unscaled.
    pub(super) fn allows_scaled(
        &self,
        allowance: f64,
        knots: &Knots,
        to: usize,
        q_from: &[f64],
        q_to: &[f64],
    ) -> bool {
        let limits = self.time_limits(knots, to - 1, to);
        let mut moves = q_from.iter().zip(q_to).zip(limits.into_iter().flatten());
        self.max_relative_step(q_from, q_to) <= allowance + ROUNDING
            && moves.all(|((a, b), limit)| (a - b).abs() / limit <= 1.0 + ROUNDING)
    }

    /// Returns the allowance of a step that was followed in parts: its length plus a margin of 5 %.
    pub(super) fn allowance(&self, q_from: &[f64], q_to: &[f64]) -> f64 {
        (1.05 * self.max_relative_step(q_from, q_to)).max(1.0)
    }

    /// Returns the displacement bound of each joint by velocity limits and times, if these count.
    pub(super) fn time_limits(
        &self,
        knots: &Knots,
        from: usize,
        to: usize,
    ) -> Option<impl Iterator<Item = f64>> {
        let time = match self.speeds.is_empty() {
            true => None,
            false => time(knots, from, to),
        };
        time.map(|time| self.speeds.iter().map(move |speed| time * speed))
    }

    /// Returns the largest joint displacement relative to the step bound, independent of times.
    pub(super) fn max_relative_step(&self, q_from: &[f64], q_to: &[f64]) -> f64 {
        let moves = q_from.iter().zip(q_to).zip(&self.max_step);
        moves.fold(0.0, |excess, ((a, b), limit)| {
            excess.max((a - b).abs() / limit)
        })
    }

    /// Returns whether no joint exceeds the bound of a part of a long step.
    pub(super) fn allows_part<'q>(&self, moves: impl Iterator<Item = (&'q f64, &'q f64)>) -> bool {
        let mut moves = moves.zip(&self.max_step);
        moves.all(|((a, b), limit)| (a - b).abs() <= PART_STEP_RATIO * limit)
    }
}

fn time(knots: &Knots, from: usize, to: usize) -> Option<f64> {
    Some(knots.times.get(to)? - knots.times.get(from)?)
}

#[cfg(test)]
mod tests {
    use super::StepBounds;
    use crate::arm::Arm;
    use crate::model::{Limits, Model};
    use crate::path::CartesianPath;
    use crate::path::knots::Knots;
    use crate::path::tools::Tools;
    use crate::robot::Robot;
    use crate::spatial::{Placement, Vector3};

    /// Between two knots a joint has the time of all steps in between, and may move by that many steps.
    #[test]
    #[allow(clippy::unwrap_used)]
    fn step_bounds_use_time_of_all_steps() {
        let mut builder = Model::builder("one link");
        let link = Placement::translation(Vector3::UNITS[0]);
        let origin = Placement::identity();
        let joint_limits = Limits::new(-3.0, 3.0);
        let base = builder.frame("base", None, origin);
        let joint = builder.revolute("turn", None, origin, Vector3::UNITS[2], joint_limits);
        let tip = builder.frame("tip", Some(joint), link);
        let robot = Robot::new(builder.build().unwrap(), Vec::new()).unwrap();
        let arm = Arm::builder(&robot, base, tip).with_atlas(false);
        let arm = arm.build().unwrap();
        let path = CartesianPath::new(vec![link; 5]).unwrap();
        let path = path.with_times(vec![0.0, 1.0, 1.5, 4.0, 4.1]).unwrap();
        let knots = Knots::of(&path, &Tools::new(&arm));
        let limits_of = |max_step: f64, from: usize, to: usize| {
            let mut limits = Vec::new();
            StepBounds::new(&arm, max_step, vec![0.01]).write(&knots, from, to, &mut limits);
            limits[0]
        };
        for (from, to, seconds) in [(0, 1, 1.0), (0, 3, 4.0), (1, 4, 3.1), (3, 4, 0.1)] {
            let time = limits_of(1.0, from, to);
            assert!(
                (time - 0.01 * seconds).abs() < 1e-15,
                "{from} to {to}: {time}"
            );
            // The number of steps counts if steps are shorter than the time allows.
            let steps = limits_of(1e-4, from, to);
            assert_eq!(steps, 1e-4 * (to - from) as f64);
        }
    }
}
