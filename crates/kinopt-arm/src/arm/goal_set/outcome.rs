//! Outcomes of the goals of a goal set.

use super::super::PoseOutcome;
use super::super::arm::Arm;

/// Result of one goal for one arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum GoalStatus {
    /// The configuration reaches the goal, free of collisions if the arm has a checker.
    Reached,
    /// The arm reaches the goal, but no collision-free configuration was found.
    InCollision,
    /// No configuration within the joint limits reaches the goal: it is proven.
    OutOfReach,
    /// No attempt reached the goal. [`Arm::reachability`] looks for a proof that it is out of reach.
    Missed,
}

/// Result of one goal for one arm, with its errors and its cost.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct GoalOutcome {
    /// Result of the search.
    pub status: GoalStatus,
    /// Cost of the configuration by the criterion, smallest for the best; infinite unless the goal is reached.
    pub cost: f64,
    /// Distance of the tool from the goal, metres; infinite if the goal was not searched for.
    pub position_error: f64,
    /// Angle between tool and goal, radians; infinite if the goal was not searched for.
    pub orientation_error: f64,
}

impl GoalOutcome {
    /// Outcome of a goal that is excluded before the search.
    pub(super) const OUT_OF_REACH: Self = Self {
        status: GoalStatus::OutOfReach,
        cost: f64::INFINITY,
        position_error: f64::INFINITY,
        orientation_error: f64::INFINITY,
    };

    pub(super) fn new(arm: &Arm, outcome: &PoseOutcome) -> Self {
        let PoseOutcome {
            position_error,
            orientation_error,
            ..
        } = *outcome;
        let at_goal = position_error <= arm.options.position_tolerance
            && orientation_error <= arm.options.orientation_tolerance;
        Self {
            status: match (outcome.reached, at_goal) {
                (true, _) => GoalStatus::Reached,
                (false, true) => GoalStatus::InCollision,
                (false, false) => GoalStatus::Missed,
            },
            cost: f64::INFINITY,
            position_error,
            orientation_error,
        }
    }
}

/// Result of a [`GoalSet`](super::GoalSet): a configuration and an outcome for each arm and goal.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct GoalSetSolution {
    /// Number of goals.
    pub goals: usize,
    /// Configurations of each arm, one row a goal, radians or metres. A row is NaN if the goal was not searched for, and
    /// the closest one found if the goal is not reached.
    pub q: Vec<Vec<f64>>,
    /// Outcomes of each arm, one a goal.
    pub outcomes: Vec<Vec<GoalOutcome>>,
}

impl GoalSetSolution {
    pub(super) fn new(arms: &[Arm], goals: usize) -> Self {
        let rows = |arm: &Arm| vec![f64::NAN; arm.joint_count() * goals];
        Self {
            goals,
            q: arms.iter().map(rows).collect(),
            outcomes: vec![vec![GoalOutcome::OUT_OF_REACH; goals]; arms.len()],
        }
    }

    /// Outcome of a goal for an arm.
    ///
    /// # Panics
    /// Panics if there is no such arm or goal.
    #[must_use]
    pub fn outcome(&self, arm: usize, goal: usize) -> &GoalOutcome {
        &self.outcomes[arm][goal]
    }

    /// Configuration of an arm for a goal; `None` if there is no such arm or goal.
    #[must_use]
    pub fn configuration(&self, arm: usize, goal: usize) -> Option<&[f64]> {
        let rows = self.q.get(arm)?;
        rows.chunks_exact(rows.len().checked_div(self.goals)?.max(1))
            .nth(goal)
    }

    /// The reached goals as pairs of arm and goal, least cost first; those of equal cost in the order of arms and goals.
    #[must_use]
    pub fn ranking(&self) -> Vec<(usize, usize)> {
        let pairs = self
            .outcomes
            .iter()
            .enumerate()
            .flat_map(|(arm, outcomes)| {
                let reached = |outcome: &GoalOutcome| outcome.status == GoalStatus::Reached;
                let goals = outcomes.iter().enumerate();
                goals
                    .filter(move |(_, outcome)| reached(outcome))
                    .map(move |(goal, _)| (arm, goal))
            });
        let mut pairs: Vec<(usize, usize)> = pairs.collect();
        let cost = |(arm, goal): (usize, usize)| self.outcomes[arm][goal].cost;
        pairs.sort_by(|&a, &b| cost(a).total_cmp(&cost(b)));
        pairs
    }

    /// The arm and the goal of least cost; `None` if no goal is reached.
    #[must_use]
    pub fn best(&self) -> Option<(usize, usize)> {
        self.ranking().first().copied()
    }
}
