//! Pose search of a skeleton: converges on the current branch, then searches if the target is not reached.

use std::time::{Duration, Instant};

use kinopt::ik::{Drag, MoveLimits};
use kinopt::solver::{Observer, Silent, Stopping};
use kinopt::{Problem, Solution, Solver, Workspace};

use super::arguments::Arguments;
use super::backend::microseconds;
use super::max_move;
use super::query::{Answer, Settled, Way};
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;

/// Largest number of frames until a skeleton converges. In a path, at 0.15 rad each, several full rotations.
const FRAMES: usize = 200;
/// Number of intermediate targets on the motion to a target.
const STEPS_OF_A_WAY: u32 = 30;
/// Largest number of iterations of a frame.
const FRAME_STEPS: usize = 40;
/// Ratio of costs below which another attempt counts as better.
const BETTER: f64 = 1.0 - 1e-3;

/// Sets the targets of a drag to a share of the motion.
pub(super) type Aim<'a> = dyn Fn(&mut Drag, f64) -> Outcome<()> + 'a;

/// Pose search of a model.
#[derive(Clone, Debug)]
pub(super) struct PoseFinder {
    solver: Solver,
    stopping: Stopping,
    settles: bool,
    /// True if a target that is not reached starts a search.
    searches: bool,
    /// True if the result of that search counts although it is not reached.
    anywhere: bool,
    limit: Option<Duration>,
    /// Largest displacement of each coordinate from a start.
    moves: Option<Vec<f64>>,
}

impl PoseFinder {
    /// Skeletons converge on their branch first, and so does a model on a free base with held feet.
    ///
    /// # Errors
    /// A wrong number of displacement limits.
    pub(super) fn new(loaded: &LoadedModel, arguments: &Arguments, stands: bool) -> Outcome<Self> {
        Ok(Self {
            moves: max_move::max_moves(loaded, arguments)?,
            solver: arguments.general_solver(),
            stopping: arguments.stopping(),
            settles: (loaded.rig.is_some() || stands) && arguments.settles(),
            searches: arguments.attempts() != Some(1),
            anywhere: arguments.arm.global_search_on_miss,
            limit: arguments.time_limit,
        })
    }

    /// Pose for the current targets, from `start`. A skeleton that converges on its branch follows the motion `way`
    /// first; `way` sets the targets to a share of the motion.
    pub(super) fn find(
        &self,
        body: &mut Drag,
        (start, way): (&[f64], Option<&Aim<'_>>),
        workspace: &mut Workspace,
        observer: &mut dyn Observer,
    ) -> Outcome<Answer> {
        let began = Instant::now();
        let answer = |solution: Solution, settled| Answer {
            settled,
            ..Answer::new(solution.q.clone(), solution, Some(microseconds(began)))
        };
        if !self.settles {
            let (solver, mut question) = (&self.solver, body.question());
            let moves = self.moves.as_ref();
            let moves = moves.map(|most| MoveLimits::new(body.problem(), most, start));
            let moves = moves.transpose()?;
            if let Some(moves) = &moves {
                question = question.with_moves(moves)?;
            }
            let solved = solver.solve_observed(question, start, workspace, observer)?;
            return Ok(answer(solved.clone(), None));
        }
        body.set_configuration(start)?;
        if let Some(aim) = way {
            for step in 1..=STEPS_OF_A_WAY {
                aim(body, f64::from(step) / f64::from(STEPS_OF_A_WAY))?;
                body.advance();
            }
        }
        let settled = body.settle(FRAMES).clone();
        let left = self
            .limit
            .map(|limit| limit.saturating_sub(began.elapsed()));
        if settled.reached || !self.searches || left.is_some_and(|left| left.is_zero()) {
            let own = Settled {
                way: Way::Own,
                lower_cost_elsewhere: None,
            };
            return Ok(answer(settled, Some(own)));
        }
        let (solver, question) = (self.search(left), body.question());
        let searched = solver.solve_observed(question, start, workspace, observer)?;
        let better = searched.cost < BETTER * settled.cost;
        // If the targets are reached only in collision, that solution is reported, as for an arm.
        let only_touches = searched.goals_reached() && !settled.goals_reached();
        let taken = searched.reached || only_touches || (self.anywhere && better);
        let (way, best) = match taken {
            true => (Way::Another, searched),
            false => (Way::Own, &settled),
        };
        let mut solution = best.clone();
        solution.iterations = settled.iterations + searched.iterations;
        solution.counts = settled.counts;
        solution.counts += searched.counts;
        solution.attempts = searched.attempts + 1;
        if !taken {
            // Attempts with a higher cost do not count as agreeing.
            solution.agreeing = if better { 1 } else { searched.agreeing + 1 };
        }
        let lower_cost_elsewhere = (better && !taken).then_some(searched.cost);
        let settled = Settled {
            way,
            lower_cost_elsewhere,
        };
        Ok(answer(solution, Some(settled)))
    }

    /// Drag at a problem's start.
    pub(super) fn body(&self, problem: Problem, start: &[f64]) -> Outcome<Drag> {
        let drag = Drag::new(problem, start)?;
        let Some(limit) = self.limit.filter(|_| self.settles) else {
            return Ok(drag);
        };
        let frame = Stopping::default().with_max_iterations(FRAME_STEPS);
        Ok(drag.with_solver(Solver::default(), frame.with_time_limit(limit))?)
    }

    /// Step of a path: until the target is reached or the drag converges. With a method or limits of the caller, one
    /// frame is all that they allow.
    ///
    /// # Errors Invalid displacement limits.
    pub(super) fn follow(&self, body: &mut Drag, workspace: &mut Workspace) -> Outcome<Solution> {
        if self.moves.is_some() {
            let start = body.q().to_vec();
            let answer = self.find(body, (&start, None), workspace, &mut Silent)?;
            body.set_configuration(&answer.q)?;
            return Ok(answer.solution);
        }
        if self.settles {
            return Ok(body.follow(FRAMES).clone());
        }
        body.advance();
        for _ in 1..FRAMES {
            if !body.is_speed_limited() {
                break;
            }
            body.advance();
        }
        Ok(body.solution().clone())
    }

    /// Drag that follows a path by the solver's method.
    pub(super) fn follower(&self, body: Drag) -> Outcome<Drag> {
        Ok(body.with_solver(self.solver.clone(), self.stopping)?)
    }

    /// Solver with the remaining time.
    fn search(&self, left: Option<Duration>) -> Solver {
        let solver = self.solver.clone();
        match left {
            Some(left) => solver.with_stopping(self.stopping.with_time_limit(left)),
            None => solver,
        }
    }
}
