//! Scratch memory of a solver, owned by the caller.

use super::Solution;
use super::collision_avoidance::AvoidanceWorkspace;
use super::priority::{LevelWorkspace, is_better};
use crate::problem::{Evaluation, Problem, ProblemInstance, ReducedWorkspace, Scratch, TaskSubset};
use crate::search::{Attempts, End, PreferenceConflict, SearchResult};
use crate::solver::{LeastSquares, SolverState, Stopping, half_squared};

/// Scratch memory and storage of the solution.
///
/// Reuse it between solves: after the first solve of a problem, further solves allocate nothing. It fits any problem,
/// one at a time.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    pub(super) state: SolverState,
    /// Memory for tasks that move only few of the variables.
    pub(super) moved_variables: ReducedWorkspace,
    pub(super) scratch: Option<Scratch>,
    pub(super) search: Attempts,
    /// Residual of all tasks.
    whole_residual: Vec<f64>,
    pub(super) levels: LevelWorkspace,
    pub(super) solution: Solution,
    /// Workspace of collision avoidance.
    pub(super) collision: Option<Box<AvoidanceWorkspace>>,
}

impl Workspace {
    /// Creates an empty workspace. The first solve allocates its memory.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Solution of the last solve.
    #[must_use]
    pub fn solution(&self) -> &Solution {
        &self.solution
    }

    /// Cost ½ Σ ‖W r‖² of the searched tasks at the end of the last solve.
    ///
    /// If soft tasks act in the null space, the searched tasks are the required tasks only.
    pub(super) fn searched_cost(&self) -> f64 {
        half_squared(&self.search.keeper.residual)
    }

    /// Returns whether the required tasks of the last solve cost less than `max_ratio` times those of another
    /// workspace.
    pub(super) fn is_better(&self, problem: &Problem, max_ratio: f64, other: &Self) -> bool {
        match problem.ranks().levels() > 1 {
            true => {
                let [residual, other_residual] =
                    [self, other].map(|workspace| &workspace.search.keeper.residual);
                is_better(problem, max_ratio, residual, other_residual)
            }
            false => self.searched_cost() < max_ratio * other.searched_cost(),
        }
    }

    /// Resizes the memory for the problem and returns scratch memory, which is new only for a new problem.
    pub(super) fn fit(&mut self, instance: ProblemInstance<'_>) -> Scratch {
        let problem = instance.problem;
        let subset = problem.searched_subset();
        self.search.fit(instance, subset);
        if subset != TaskSubset::All {
            self.whole_residual.resize(problem.rows(), 0.0);
            self.levels.fit(instance);
        }
        self.solution.reserve(problem.tasks(), problem.variables());
        match self.scratch.take() {
            Some(mut scratch) if scratch.fits(problem) => {
                if instance.has_moved_tree() {
                    scratch.invalidate();
                }
                scratch
            }
            _ => problem.scratch(),
        }
    }

    /// Fills in the solution from a search result.
    pub(super) fn report(
        &mut self,
        instance: ProblemInstance<'_>,
        stopping: &Stopping,
        scratch: &mut Scratch,
        result: &SearchResult,
    ) {
        let problem = instance.problem;
        let solution = &mut self.solution;
        let (subset, keeper) = (problem.searched_subset(), &self.search.keeper);
        let residual = match subset {
            TaskSubset::All => &keeper.residual,
            _ => {
                let mut evaluation = Evaluation::new(instance, scratch);
                evaluation.residual(&keeper.x, &mut self.whole_residual);
                &self.whole_residual
            }
        };
        let end = End {
            question: instance,
            x: &keeper.x,
            share: subset,
            searched: match problem.ranks().levels() > 1 {
                true => &self.levels.multipliers,
                false => &keeper.residual,
            },
            residual,
        };
        solution.record(result);
        let slope = solution.measure(&end, stopping, scratch, &mut self.state);
        if solution.reached || !result.termination.is_settled() {
            solution.agreeing = 0;
        }
        if solution.reached {
            return;
        }
        solution.find_out_of_reach(instance);
        if let (Some(slope), TaskSubset::All, true) = (slope, subset, problem.has_preferences()) {
            let conflict = PreferenceConflict {
                question: instance,
                jacobian: self.state.jacobian(),
                residual,
                negligible: slope.negligible,
            };
            conflict.list(&keeper.x, &mut self.search.x, &mut solution.pulling);
        }
    }
}
