//! Goal bounds of targets, from intervals of single axes.

use kinopt::spatial::{Placement, Vector3};
use kinopt::task::PoseBounds;
use kinopt_bindings::problem_file::ProblemSettings;
use kinopt_bindings::problem_file::interval::Interval;

use super::goals::Goals;
use crate::failure::Outcome;

/// Goal bounds of a target.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GoalBounds {
    pub(crate) goal: PoseBounds,
    /// Offset of the middle of the bounds from the target, in the target's frame; `None` if it is zero.
    shift: Option<Placement<f64>>,
}

impl GoalBounds {
    /// Bounds of every target, or `None` without intervals; bounds of rotations apply if the orientation counts.
    pub(super) fn of_targets(
        problem: &ProblemSettings,
        goals: &Goals,
    ) -> Outcome<Vec<Option<Self>>> {
        let intervals = problem.goal.interval.as_slice();
        let targets = goals.targets.iter();
        if intervals.is_empty() {
            return Ok(vec![None; targets.len()]);
        }
        if targets.len() == 0 {
            return Err(usage!("--interval needs targets, and there are none"));
        }
        let some_turn = targets.clone().any(|target| target.turns);
        targets
            .map(|target| Self::new(intervals, (target.turns, some_turn)).map(Some))
            .collect()
    }

    /// Bounds of a target; `turns` if its orientation counts, `some_turn` if the orientation of any target does.
    ///
    /// # Errors
    /// Bounds of a rotation, if no orientation counts.
    pub(crate) fn new(intervals: &[Interval], (turns, some_turn): (bool, bool)) -> Outcome<Self> {
        if !some_turn && intervals.iter().any(Interval::turns) {
            return Err(usage!(
                "--interval of a rotation is for targets with an orientation (x,y,z,qw,qx,qy,qz)"
            ));
        }
        let goal = match turns {
            true => PoseBounds::pose(),
            false => PoseBounds::position(),
        };
        let counts = |interval: &&Interval| turns || !interval.turns();
        let intervals = intervals.iter().filter(counts);
        Ok(Self::within(goal.half_widths(), intervals))
    }

    fn within<'i>(
        mut half_widths: [f64; 6],
        intervals: impl IntoIterator<Item = &'i Interval>,
    ) -> Self {
        let mut middle = [0.0; 3];
        for interval in intervals {
            let half = match interval.high.is_finite() {
                true => 0.5 * (interval.high - interval.low),
                false => f64::INFINITY,
            };
            half_widths[interval.axis] = half;
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
        let intervals = ["x=-0.01..0.03", "y=free", "rz=90"].map(|text| text.parse().unwrap());
        let intervals = intervals.map(|interval: Interval| interval.typed(true));
        let GoalBounds { goal, shift } = GoalBounds::within([0.0; 6], &intervals);
        let quarter = std::f64::consts::FRAC_PI_2;
        assert_eq!(
            goal.half_widths(),
            [0.02, f64::INFINITY, 0.0, 0.0, 0.0, quarter]
        );
        assert!((shift.unwrap().translation.x - 0.01).abs() < 1e-15);
    }
}
