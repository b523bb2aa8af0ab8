//! Pose search of a skeleton: converges on the current branch, then searches if the target is not reached.

use std::time::{Duration, Instant};

use kinopt::ik::{Drag, MoveLimits};
use kinopt::solver::{Observer, Silent, Stopping};
use kinopt::{Solution, Solver, Workspace};
use kinopt_bindings::problem_file::ProblemSettings;

use super::backend::microseconds;
use super::max_move;
use super::query::{Answer, PoseOrigin, Settled};
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;

/// Largest number of frames until a skeleton converges. In a path, at 0.15 rad each, several full rotations.
const MAX_FRAMES: usize = 200;
/// Number of intermediate targets on the motion to a target.
const INTERMEDIATE_TARGETS: u32 = 30;
/// Largest number of iterations of a frame.
const FRAME_ITERATIONS: usize = 40;
/// Ratio of costs below which another attempt counts as better.
const BETTER_COST_RATIO: f64 = 1.0 - 1e-3;

/// Sets the targets of a drag to a share of the motion.
pub(super) type TargetMotion<'a> = dyn Fn(&mut Drag, f64) -> Outcome<()> + 'a;

/// Pose search of a model.
#[derive(Clone, Debug)]
pub(super) struct PoseFinder {
    solver: Solver,
    stopping: Stopping,
    converges_first: bool,
    /// True if a target that is not reached starts a search.
    searches: bool,
    /// True if the result of that search counts although it is not reached.
    accepts_closest: bool,
    time_limit: Option<Duration>,
    /// Largest displacement of each coordinate from a start.
    max_moves: Option<Vec<f64>>,
}

impl PoseFinder {
    /// Skeletons converge on their branch first, and so does a model on a free base with held feet.
    ///
    /// # Errors
    /// A wrong number of displacement limits.
    pub(super) fn new(
        loaded: &LoadedModel,
        problem: &ProblemSettings,
        has_held_feet: bool,
    ) -> Outcome<Self> {
        Ok(Self {
            max_moves: max_move::max_moves(loaded, problem.solve.max_move.as_ref())?,
            solver: problem.solve.general_solver(),
            stopping: problem.solve.stopping(),
            converges_first: (loaded.rig.is_some() || has_held_feet) && problem.solve.settles(),
            searches: problem.solve.attempts() != Some(1),
            accepts_closest: problem.solve.global_search_on_miss,
            time_limit: problem.solve.time_limit,
        })
    }

    /// Pose for the current targets, from `start`. A skeleton that converges on its branch follows `motion`
    /// first; `motion` sets the targets to a share of the motion.
    pub(super) fn find(
        &self,
        drag: &mut Drag,
        (start, motion): (&[f64], Option<&TargetMotion<'_>>),
        workspace: &mut Workspace,
        observer: &mut dyn Observer,
    ) -> Outcome<Answer> {
        let started = Instant::now();
        let answer = |solution: Solution, settled| Answer {
            settled,
            ..Answer::new(solution.q.clone(), solution, Some(microseconds(started)))
        };
        if !self.converges_first {
            let (solver, mut instance) = (&self.solver, drag.question());
            let moves = self.max_moves.as_ref();
            let moves = moves.map(|max_moves| MoveLimits::new(drag.problem(), max_moves, start));
            let moves = moves.transpose()?;
            if let Some(moves) = &moves {
                instance = instance.with_moves(moves)?;
            }
            let solved = solver.solve_observed(instance, start, workspace, observer)?;
            return Ok(answer(solved.clone(), None));
        }
        drag.set_configuration(start)?;
        if let Some(set_targets) = motion {
            for step in 1..=INTERMEDIATE_TARGETS {
                set_targets(drag, f64::from(step) / f64::from(INTERMEDIATE_TARGETS))?;
                drag.advance();
            }
        }
        let converged = drag.settle(MAX_FRAMES).clone();
        let remaining = self
            .time_limit
            .map(|time_limit| time_limit.saturating_sub(started.elapsed()));
        if converged.reached
            || !self.searches
            || remaining.is_some_and(|remaining| remaining.is_zero())
        {
            let on_start_branch = Settled {
                way: PoseOrigin::Own,
                lower_cost_elsewhere: None,
            };
            return Ok(answer(converged, Some(on_start_branch)));
        }
        let (solver, instance) = (self.search_solver(remaining), drag.question());
        let searched = solver.solve_observed(instance, start, workspace, observer)?;
        let is_better = searched.cost < BETTER_COST_RATIO * converged.cost;
        // If the targets are reached only in collision, that solution is reported, as for an arm.
        let only_in_contact = searched.goals_reached() && !converged.goals_reached();
        let accepted = searched.reached || only_in_contact || (self.accepts_closest && is_better);
        let (origin, best) = match accepted {
            true => (PoseOrigin::Another, searched),
            false => (PoseOrigin::Own, &converged),
        };
        let mut solution = best.clone();
        solution.iterations = converged.iterations + searched.iterations;
        solution.counts = converged.counts;
        solution.counts += searched.counts;
        solution.attempts = searched.attempts + 1;
        if !accepted {
            // Attempts with a higher cost do not count as agreeing.
            solution.agreeing = if is_better { 1 } else { searched.agreeing + 1 };
        }
        let lower_cost_elsewhere = (is_better && !accepted).then_some(searched.cost);
        let settled = Settled {
            way: origin,
            lower_cost_elsewhere,
        };
        Ok(answer(solution, Some(settled)))
    }

    /// Drag at a problem's start.
    pub(super) fn drag(&self, problem: kinopt::Problem, start: &[f64]) -> Outcome<Drag> {
        let drag = Drag::new(problem, start)?;
        let Some(time_limit) = self.time_limit.filter(|_| self.converges_first) else {
            return Ok(drag);
        };
        let frame = Stopping::default().with_max_iterations(FRAME_ITERATIONS);
        Ok(drag.with_solver(Solver::default(), frame.with_time_limit(time_limit))?)
    }

    /// Step of a path: until the target is reached or the drag converges. With a method or limits of the caller, one
    /// frame is all that they allow.
    ///
    /// # Errors Invalid displacement limits.
    pub(super) fn follow(&self, drag: &mut Drag, workspace: &mut Workspace) -> Outcome<Solution> {
        if self.max_moves.is_some() {
            let start = drag.q().to_vec();
            let answer = self.find(drag, (&start, None), workspace, &mut Silent)?;
            drag.set_configuration(&answer.q)?;
            return Ok(answer.solution);
        }
        if self.converges_first {
            return Ok(drag.follow(MAX_FRAMES).clone());
        }
        drag.advance();
        for _ in 1..MAX_FRAMES {
            if !drag.is_speed_limited() {
                break;
            }
            drag.advance();
        }
        Ok(drag.solution().clone())
    }

    /// Drag that follows a path by the solver's method.
    pub(super) fn follower(&self, drag: Drag) -> Outcome<Drag> {
        Ok(drag.with_solver(self.solver.clone(), self.stopping)?)
    }

    /// Solver with the remaining time.
    fn search_solver(&self, remaining: Option<Duration>) -> Solver {
        let solver = self.solver.clone();
        match remaining {
            Some(remaining) => solver.with_stopping(self.stopping.with_time_limit(remaining)),
            None => solver,
        }
    }
}
