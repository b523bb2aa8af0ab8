//! `--interval` and `--free-axis`: goal bounds on single axes.

use kinopt::spatial::{Placement, Vector3};
use kinopt::task::{Axis, PoseBounds};

use super::arguments::Arguments;
use super::goals::Goals;
use super::interval::Interval;
use crate::failure::Outcome;

/// What of a target counts.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Room {
    pub(crate) goal: PoseBounds,
    /// Where the middle of the room lies in the target, where it is not the target itself.
    shift: Option<Placement<f64>>,
}

impl Room {
    /// As the options say of a target with an orientation that counts, or of one without.
    pub(super) fn of(arguments: &Arguments, turns: bool) -> Outcome<Self> {
        Self::beside(arguments, turns, turns)
    }

    /// Of every target, where an option gives them room: turns to those whose orientation counts.
    pub(super) fn of_targets(arguments: &Arguments, goals: &Goals) -> Outcome<Vec<Option<Self>>> {
        let targets = goals.targets.iter();
        if arguments.arm.free_axis.is_none() && arguments.arm.intervals.is_empty() {
            return Ok(vec![None; targets.len()]);
        }
        if targets.len() == 0 {
            return Err(usage!(
                "--interval and --free-axis give targets room, of which there are none"
            ));
        }
        let some_turn = targets.clone().any(|target| target.turns);
        targets
            .map(|target| Self::beside(arguments, target.turns, some_turn).map(Some))
            .collect()
    }

    /// Of a target beside others, of which some may turn.
    fn beside(arguments: &Arguments, turns: bool, some_turn: bool) -> Outcome<Self> {
        let options = &arguments.arm;
        let (free_axis, intervals) = (options.free_axis, options.intervals.as_slice());
        let counts = (turns, some_turn);
        Self::of_options(free_axis, intervals, counts, arguments.degrees)
    }

    /// As `--free-axis` and `--interval` say of a target that turns or not, beside others of which some may.
    pub(crate) fn of_options(
        free_axis: Option<Axis>,
        intervals: &[Interval],
        (turns, some_turn): (bool, bool),
        degrees: bool,
    ) -> Outcome<Self> {
        let only_turning = match free_axis {
            _ if some_turn => None,
            _ if intervals.iter().any(Interval::turns) => Some("--interval of a turn"),
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

    /// Where to stand for a target, the room about it even.
    pub(crate) fn middle(&self, target: Placement<f64>) -> Placement<f64> {
        self.shift.map_or(target, |shift| target * shift)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    #[test]
    fn the_middle_of_the_room_is_the_target() {
        let intervals =
            ["x=-0.01..0.03", "y=free", "rz=90"].map(|text| Interval::parse(text).unwrap());
        let Room { goal, shift } = Room::within([0.0; 6], &intervals, true);
        let quarter = std::f64::consts::FRAC_PI_2;
        assert_eq!(
            goal.half_widths(),
            [0.02, f64::INFINITY, 0.0, 0.0, 0.0, quarter]
        );
        assert!((shift.unwrap().translation.x - 0.01).abs() < 1e-15);
    }
}
