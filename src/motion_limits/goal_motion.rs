//! Prediction of the goal configuration's motion from its last positions.

use super::joint_motion::GoalMotion;

/// Positions of a goal configuration in the last cycles, and the motion that they agree on.
///
/// The step of a joint is the smaller of its last two differences where they have one sign, else zero; its change likewise.
/// So a target that moves smoothly is followed without lag, and one that is noisy, or held between updates, is taken for
/// resting.
#[derive(Clone, Debug)]
pub(crate) struct GoalHistory {
    /// The last position, its last step and the last change of that.
    last: Vec<f64>,
    steps: Vec<f64>,
    changes: Vec<f64>,
    motions: Vec<GoalMotion>,
}

/// The number of smaller size of two with one sign; zero for two with different signs.
fn agreed(a: f64, b: f64) -> f64 {
    if a * b <= 0.0 {
        0.0
    } else if a.abs() < b.abs() {
        a
    } else {
        b
    }
}

impl GoalHistory {
    pub(crate) fn resting_at(goal: &[f64]) -> Self {
        let n = goal.len();
        Self {
            last: goal.to_vec(),
            steps: vec![0.0; n],
            changes: vec![0.0; n],
            motions: vec![GoalMotion::default(); n],
        }
    }

    /// Forgets all motion: the goal rests.
    pub(crate) fn rest_at(&mut self, goal: &[f64]) {
        self.last.copy_from_slice(goal);
        self.steps.fill(0.0);
        self.changes.fill(0.0);
        self.motions.fill(GoalMotion::default());
    }

    /// Takes the goal of the next cycle.
    pub(crate) fn push(&mut self, goal: &[f64]) {
        for (i, &goal) in goal.iter().enumerate() {
            let step = goal - self.last[i];
            let newest = self.steps[i];
            let change = step - newest;
            self.motions[i] = GoalMotion {
                step: agreed(step, newest),
                change: agreed(change, self.changes[i]),
            };
            self.last[i] = goal;
            self.steps[i] = step;
            self.changes[i] = change;
        }
    }

    /// The predicted motion of each joint, a control cycle.
    pub(crate) fn motions(&self) -> &[GoalMotion] {
        &self.motions
    }
}
