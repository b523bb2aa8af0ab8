//! `--interval` and `--free-axis`: goal bounds on single axes.

use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Axis, PoseBounds};

use super::arguments::Arguments;
use super::goals::Goals;
use super::interval::Interval;
use crate::failure::Outcome;

/// Goal bounds of a target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GoalBounds {
    pub(crate) goal: PoseBounds,
    /// Offset of the middle of the bounds from the target, in the target's frame; `None` if it is zero.
    shift: Option<Placement<f64>>,
}

impl GoalBounds {
    /// Bounds from the options, for a target whose orientation counts (`turns`) or not.
    pub(super) fn of(arguments: &Arguments, turns: bool) -> Outcome<Self> {
        Self::for_target(arguments, turns, turns)
    }

    /// Bounds of every target, or `None` without options; orientation bounds apply if the orientation counts.
    pub(super) fn of_targets(arguments: &Arguments, goals: &Goals) -> Outcome<Vec<Option<Self>>> {
        let targets = goals.targets.iter();
        if arguments.arm.free_axis.is_none() && arguments.arm.intervals.is_empty() {
            return Ok(vec![None; targets.len()]);
        }
        if targets.len() == 0 {
            return Err(usage!(
                "--interval and --free-axis need targets, and there are none"
            ));
        }
        let some_turn = targets.clone().any(|target| target.turns);
        targets
            .map(|target| Self::for_target(arguments, target.turns, some_turn).map(Some))
            .collect()
    }

    /// Bounds of one of several targets; `some_turn` if the orientation of any of them counts.
    fn for_target(arguments: &Arguments, turns: bool, some_turn: bool) -> Outcome<Self> {
        let options = &arguments.arm;
        let (free_axis, intervals) = (options.free_axis, options.intervals.as_slice());
        let counts = (turns, some_turn);
        Self::of_options(free_axis, intervals, counts, arguments.degrees)
    }

    /// Bounds from `--free-axis` and `--interval`; `turns` for this target, `some_turn` for any target.
    pub(crate) fn of_options(
        free_axis: Option<Axis>,
        intervals: &[Interval],
        (turns, some_turn): (bool, bool),
        degrees: bool,
    ) -> Outcome<Self> {
        let only_turning = match free_axis {
            _ if some_turn => None,
            _ if intervals.iter().any(Interval::turns) => Some("--interval of a rotation"),
            free_axis => free_axis.map(|_| "--free-axis"),
        };
        if let Some(option) = only_turning {
            return Err(usage!(
                "{option} is for targets with an orientation (x,y,z,qw,qx,qy,qz)"
            ));
        }
        let goal = match free_axis {
            _ if !turns => PoseBounds::position(),
            Some(axis) => PoseBounds::free_about(axis),
            None => PoseBounds::pose(),
        };
        let counts = |interval: &&Interval| turns || !interval.turns();
        let intervals = intervals.iter().filter(counts);
        Ok(Self::within(goal.half_widths(), intervals, degrees))
    }

    fn within<'i>(
        mut half_widths: [f64; 6],
        intervals: impl IntoIterator<Item = &'i Interval>,
        degrees: bool,
    ) -> Self {
        let mut middle = [0.0; 3];
        for interval in intervals {
            let half = match interval.high.is_finite() {
                true => 0.5 * (interval.high - interval.low),
                false => f64::INFINITY,
            };
            half_widths[interval.axis] = match interval.turns() && degrees {
                true => half.to_radians(),
                false => half,
            };
            if let (Some(middle), true) = (middle.get_mut(interval.axis), half.is_finite()) {
                *middle = 0.5 * (interval.low + interval.high);
            }
        }
        let shifted = middle != [0.0; 3];
        Self {
            goal: PoseBounds::within(half_widths),
            shift: shifted.then(|| Placement::translation(Vector3::from(middle))),
        }
    }

    /// Pose at the middle of the bounds about a target.
    pub(crate) fn middle(&self, target: Placement<f64>) -> Placement<f64> {
        self.shift.map_or(target, |shift| target * shift)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn target_is_at_the_middle_of_goal_bounds() {
        let intervals =
            ["x=-0.01..0.03", "y=free", "rz=90"].map(|text| Interval::parse(text).unwrap());
        let GoalBounds { goal, shift } = GoalBounds::within([0.0; 6], &intervals, true);
        let quarter = std::f64::consts::FRAC_PI_2;
        assert_eq!(
            goal.half_widths(),
            [0.02, f64::INFINITY, 0.0, 0.0, 0.0, quarter]
        );
        assert!((shift.unwrap().translation.x - 0.01).abs() < 1e-15);
    }
}
