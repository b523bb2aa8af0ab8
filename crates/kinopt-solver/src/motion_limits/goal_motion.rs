//! Prediction of the goal configuration's motion from its last positions.

use super::joint_motion::GoalMotion;

/// Positions of a goal configuration in the last cycles, and the motion estimated from them.
///
/// The step of a joint is the smaller of its last two differences if they have equal signs, otherwise zero. The change
/// of the step is estimated in the same way. A smoothly moving target is therefore followed without lag. A target that
/// is noisy, or constant between updates, counts as resting.
#[derive(Clone, Debug)]
#[doc(hidden)]
pub struct GoalHistory {
    /// The last position; its last step and the last change of the step follow.
    last: Vec<f64>,
    steps: Vec<f64>,
    changes: Vec<f64>,
    motions: Vec<GoalMotion>,
}

/// The smaller in magnitude of two numbers with equal signs; zero for different signs.
fn min_if_same_sign(a: f64, b: f64) -> f64 {
    if a * b <= 0.0 {
        0.0
    } else if a.abs() < b.abs() {
        a
    } else {
        b
    }
}

impl GoalHistory {
    #[doc(hidden)]
    pub fn resting_at(goal: &[f64]) -> Self {
        let n = goal.len();
        Self {
            last: goal.to_vec(),
            steps: vec![0.0; n],
            changes: vec![0.0; n],
            motions: vec![GoalMotion::default(); n],
        }
    }

    /// Sets the goal to rest at `goal`.
    #[doc(hidden)]
    pub fn rest_at(&mut self, goal: &[f64]) {
        self.last.copy_from_slice(goal);
        self.steps.fill(0.0);
        self.changes.fill(0.0);
        self.motions.fill(GoalMotion::default());
    }

    /// Adds the goal of the next cycle.
    #[doc(hidden)]
    pub fn push(&mut self, goal: &[f64]) {
        for (i, &goal) in goal.iter().enumerate() {
            let step = goal - self.last[i];
            let last_step = self.steps[i];
            let change = step - last_step;
            self.motions[i] = GoalMotion {
                step: min_if_same_sign(step, last_step),
                change: min_if_same_sign(change, self.changes[i]),
            };
            self.last[i] = goal;
            self.steps[i] = step;
            self.changes[i] = change;
        }
    }

    /// The predicted motion of each joint, per control cycle.
    #[doc(hidden)]
    pub fn motions(&self) -> &[GoalMotion] {
        &self.motions
    }
}
