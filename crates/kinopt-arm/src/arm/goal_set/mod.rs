//! Goal sets: many goals and several arms or tools in one call, ranked by a criterion.

mod criterion;
mod outcome;

pub use criterion::Criterion;
pub use outcome::{GoalOutcome, GoalSetSolution, GoalStatus};

use super::arm::Arm;
use super::{ArmError, PoseOutcome, QueryError};
use criterion::CostOf;
use kinopt_kinematics::spatial::Placement;

/// Goals of one arm that one thread solves at a time.
const GOALS_AT_A_TIME: usize = 128;

/// A set of goals for several arms: for example N grasps for M tools.
///
/// The arms may be those of one robot with [several tools](Self::of_tools), the two arms of a robot, or one arm with
/// several [goal bounds](Arm::with_goal). Each has its own obstacles.
///
/// ```
/// # std::env::set_current_dir("../..")?;
/// # use kinopt::arm::{Arm, Criterion, GoalSet, GoalStatus};
/// # use kinopt::robot::Robot;
/// # use kinopt::spatial::{Placement, Vector3};
/// let robot = Robot::read("models/franka_panda.urdf")?;
/// let arm = Arm::new(&robot, "base", "flange")?;
/// let start = arm.default_start().to_vec();
/// let near = arm.base_from_tool(&[0.3, -0.4, 0.2, -1.9, 0.1, 1.6, 0.5])?;
/// let far = Placement::translation(Vector3::new(5.0, 0.0, 0.0)) * near;
/// let tools = [0.0, 0.1].map(|length| Placement::translation(Vector3::new(0.0, 0.0, length)));
/// let set = GoalSet::of_tools(&arm, &tools)?;
/// let solution = set.solve(&[far, near], &[start.clone(), start], Criterion::Distance)?;
/// let (tool, goal) = solution.best().ok_or("no goal was reached")?;
/// assert_eq!(goal, 1);
/// assert_eq!(solution.outcome(tool, 0).status, GoalStatus::OutOfReach);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct GoalSet {
    arms: Vec<Arm>,
}

impl GoalSet {
    /// A set for several arms.
    #[must_use]
    pub fn new(arms: impl IntoIterator<Item = Arm>) -> Self {
        Self {
            arms: arms.into_iter().collect(),
        }
    }

    /// A set for one arm with each of several tools, `tip_from_tool`.
    ///
    /// # Errors
    /// Returns an error for a placement that is not a rigid motion.
    pub fn of_tools(arm: &Arm, tools: &[Placement<f64>]) -> Result<Self, ArmError> {
        let arms: Result<Vec<Arm>, ArmError> =
            tools.iter().map(|tool| arm.with_tool(*tool)).collect();
        Ok(Self { arms: arms? })
    }

    /// Arms of the set.
    #[must_use]
    pub fn arms(&self) -> &[Arm] {
        &self.arms
    }

    /// Solves every goal with every arm. `starts` has one configuration for each arm.
    ///
    /// Goals are `base_from_tool` of each arm. Configurations are those of [`Arm::solve_batch`], except that a goal is
    /// not searched for if a first bound shows that it is out of reach. [`Arm::reachability`] gives proofs for more.
    ///
    /// # Errors
    /// Returns the errors of [`Arm::solve`], an error for another number of starts than arms, and for a criterion of
    /// clearance an error for an arm without a checker.
    pub fn solve(
        &self,
        goals: &[Placement<f64>],
        starts: &[Vec<f64>],
        criterion: Criterion<'_>,
    ) -> Result<GoalSetSolution, QueryError> {
        self.solve_pieces(goals, starts, criterion, |pieces, solve| {
            pieces.into_iter().try_for_each(solve)
        })
    }

    /// Solves as [`solve`](Self::solve) does over the threads of the current rayon pool, with bitwise equal results.
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve).
    #[cfg(feature = "rayon")]
    pub fn solve_parallel(
        &self,
        goals: &[Placement<f64>],
        starts: &[Vec<f64>],
        criterion: Criterion<'_>,
    ) -> Result<GoalSetSolution, QueryError> {
        use rayon::prelude::*;
        self.solve_pieces(goals, starts, criterion, |pieces, solve| {
            pieces.into_par_iter().try_for_each(solve)
        })
    }

    fn solve_pieces(
        &self,
        goals: &[Placement<f64>],
        starts: &[Vec<f64>],
        criterion: Criterion<'_>,
        run: impl FnOnce(Vec<GoalPiece<'_>>, &SolvePiece<'_>) -> Result<(), QueryError>,
    ) -> Result<GoalSetSolution, QueryError> {
        if starts.len() != self.arms.len() {
            return Err(QueryError::Starts {
                given: starts.len(),
                arms: self.arms.len(),
            });
        }
        let mut solution = GoalSetSolution::new(&self.arms, goals.len());
        let mut pieces = Vec::new();
        let rows = solution.q.iter_mut().zip(&mut solution.outcomes);
        for ((arm, start), (q, outcomes)) in self.arms.iter().zip(starts).zip(rows) {
            arm.check_length("the start", start.len(), arm.joint_count())?;
            for (query, goal) in goals.iter().enumerate() {
                arm.check_query(Some(query), goal, start)?;
            }
            let parts = goals
                .chunks(GOALS_AT_A_TIME)
                .zip(outcomes.chunks_mut(GOALS_AT_A_TIME));
            let q = q.chunks_mut(GOALS_AT_A_TIME * arm.joint_count());
            pieces.extend(parts.zip(q).map(|((goals, outcomes), q)| GoalPiece {
                arm,
                start,
                goals,
                outcomes,
                q,
            }));
        }
        run(pieces, &|piece| piece.solve(criterion))?;
        Ok(solution)
    }
}

type SolvePiece<'a> = dyn Fn(GoalPiece<'_>) -> Result<(), QueryError> + Sync + 'a;

/// Some goals of one arm, and their results, which begin as those of goals that are not searched for.
struct GoalPiece<'a> {
    arm: &'a Arm,
    start: &'a [f64],
    goals: &'a [Placement<f64>],
    outcomes: &'a mut [GoalOutcome],
    q: &'a mut [f64],
}

impl GoalPiece<'_> {
    fn solve(self, criterion: Criterion<'_>) -> Result<(), QueryError> {
        let Self {
            arm,
            start,
            goals,
            outcomes,
            q,
        } = self;
        let n = arm.joint_count();
        let search = arm.box_search();
        let is_excluded =
            |goal: &Placement<f64>| search.as_ref().is_some_and(|search| search.is_far(goal));
        let searched: Vec<usize> = (0..goals.len())
            .filter(|&goal| !is_excluded(&goals[goal]))
            .collect();
        let targets: Vec<Placement<f64>> = searched.iter().map(|&goal| goals[goal]).collect();
        let starts = start.repeat(targets.len());
        let mut found_q = vec![0.0; n * targets.len()];
        let mut found = vec![PoseOutcome::default(); targets.len()];
        arm.solve_batch_into(&targets, &starts, &mut found_q, &mut found)?;
        let mut cost = CostOf::new(arm, start, criterion)?;
        for ((&goal, outcome), found_q) in searched.iter().zip(&found).zip(found_q.chunks(n)) {
            q[goal * n..(goal + 1) * n].copy_from_slice(found_q);
            outcomes[goal] = GoalOutcome::new(arm, outcome);
            if outcome.reached {
                outcomes[goal].cost = cost.at(found_q)?;
            }
        }
        Ok(())
    }
}
