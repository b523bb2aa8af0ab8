//! Drag: one problem whose targets move from frame to frame.

use super::collision_avoidance::CollisionWorkspace;
use super::depenetration::WayOutOfContact;
use super::drag_frame::{MovedJoints, NUDGE_EVERY, REST, near, solve};
use super::drag_motion::DragMotion;
use super::escape::{LocalMinimumEscape, WayOutSolvers};
use super::joint_interpolation::furthest_move;
use super::priority::Extent;
use super::{
    BoundKind, MotionLimits, MoveLimits, Restarts, Solution, SolveError, Solver, Workspace,
};
use crate::bad_option::BadOption;
use crate::model::Model;
use crate::problem::{Problem, ProblemError, ProblemInstance, Targets, TaskId};
use crate::random::RandomStream;
use crate::search::{check_start, slide_per_radian};
use crate::solver::Stopping;
use crate::task::Residual;

/// Default largest displacement of a joint per frame, radians: 9 rad/s at 60 frames per second.
const MOST_MOVE: f64 = 0.15;
/// Default maximum number of steps per frame. A frame that is cut short continues in the next one.
const STEPS: usize = 40;
/// Size of a perturbation, radians, and maximum number of steps from it.
const NUDGE: f64 = 0.01;
const NUDGE_STEPS: usize = 10;
/// Distance from the middle of a range, relative to the range, below which a joint is perturbed to neither side.
const CENTRED: f64 = 1e-6;
/// Largest ratio of costs at which the result of a perturbation or search is accepted.
pub(super) const BETTER: f64 = 1.0 - 1e-3;

/// Solver for a problem whose targets move from frame to frame, such as a hand that follows the mouse.
///
/// Each [`advance`](Self::advance) starts from the end of the last frame and stays on the same branch. It takes a
/// bounded number of steps and no restarts, so a frame that does not reach costs no more than a few that do.
///
/// No joint moves further in a frame than [`with_max_move`](Self::with_max_move) allows. If a target jumps or a branch
/// ends, the joints catch up over several frames; see [`is_speed_limited`](Self::is_speed_limited). Only
/// [`with_search`](Self::with_search) enables a global search, whose result is a [`jump`](Self::jump).
///
/// With [collision avoidance](crate::problem::ProblemBuilder::keep_clear) the linear joint-space motion of every frame
/// is collision-free, so the model slides along obstacles. Such a frame is not reached, and [`Solution::collisions`]
/// lists the blocking pairs. If the configuration is in collision, every frame reduces the penetration. If no small
/// step does, as for an arm that pierces a plate, the drag finds a collision-free configuration nearby. It then moves
/// there in a straight line, through the penetrated obstacle. The drag never jumps to another place.
///
/// A drag can stop short of reachable targets if several joints are at their limits. The following frames then attempt
/// an escape on the same branch, one attempt each. They move to a better solution as fast as the joints may.
/// [`is_at_rest`](Self::is_at_rest) is false until the attempts end.
///
/// ```
/// use kinopt::ik::Drag;
/// use kinopt::model::{Limits, Model};
/// use kinopt::spatial::{Placement, Vector3};
/// use kinopt::task::Point;
/// use kinopt::Problem;
///
/// let mut builder = Model::builder("planar arm");
/// let axis = Vector3::new(0.0, 0.0, 1.0);
/// let limits = Limits::new(-3.0, 3.0);
/// let link = Placement::translation(Vector3::new(1.0, 0.0, 0.0));
/// let shoulder = builder.revolute("shoulder", None, Placement::identity(), axis, limits);
/// let elbow = builder.revolute("elbow", Some(shoulder), link, axis, limits);
/// let tip = builder.frame("tip", Some(elbow), link);
/// let model = builder.build()?;
///
/// let mut tasks = Problem::builder(&model);
/// let hand = tasks.add(Point::new(tip, [1.5, 0.5, 0.0]));
/// let mut drag = Drag::new(tasks.build()?, &[0.1, 0.5])?;
/// for frame in 0..100 {
///     let mouse = [1.5 + 0.02 * f64::from(frame), 0.5, 0.0];
///     drag.target_mut(hand)?.set_target(mouse);
///     let reached = drag.advance().reached;
///     // It catches up with the first target, and from frame 22 on the mouse is beyond its reach.
///     assert!(reached || frame < 5 || frame > 21);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct Drag {
    pub(super) problem: Problem,
    pub(super) moved_joints: MovedJoints,
    pub(super) targets: Targets,
    pub(super) solver: Solver,
    nudged: Solver,
    pub(super) search: Option<Solver>,
    pub(super) max_move: f64,
    /// Joint displacement bounds of a frame.
    pub(super) moves: MoveLimits,
    /// Displacement of each variable for a `max_move` of 1: 1 rad, or the equivalent length.
    pub(super) unit: Vec<f64>,
    /// Variables before the frame, and the displacement from there.
    pub(super) before: [Vec<f64>; 2],
    pub(super) x: Vec<f64>,
    pub(super) q: Vec<f64>,
    pub(super) workspace: Workspace,
    pub(super) trial: Workspace,
    /// Number of consecutive frames that settled without reaching.
    pub(super) misses: usize,
    /// Largest displacement of a joint in the last frame, radians.
    pub(super) moved: f64,
    pub(super) way_out: LocalMinimumEscape,
    pub(super) way_out_solvers: WayOutSolvers,
    pub(super) way_out_of_contact: WayOutOfContact,
    pub(super) leap: Option<(usize, f64)>,
    /// Configuration at the start of a frame, and the workspace of collision avoidance.
    pub(super) q_before: Vec<f64>,
    pub(super) clear: Option<Box<CollisionWorkspace>>,
    /// True if the configuration may be in collision.
    pub(super) touches: bool,
    /// Commanded motion, if there are motion limits. All other fields then describe its goal.
    pub(super) motion: Option<Box<DragMotion>>,
}

/// Joint displacement that exceeds the bound of a frame, from the global search of [`Drag::with_search`].
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DragJump<'a> {
    /// Joint with the largest displacement relative to its bound.
    pub joint: &'a str,
    /// Displacement, radians or metres.
    pub distance: f64,
}

impl Drag {
    /// Creates a drag of `problem` from the configuration `start`, which is projected into the joint limits. The
    /// problem's targets may be anywhere. The first [`advance`](Self::advance) computes the first solution.
    ///
    /// # Errors
    /// Returns an error if `start` has the wrong length or a number that is not finite.
    pub fn new(problem: Problem, start: &[f64]) -> Result<Self, SolveError> {
        check_start(&problem, start)?;
        let n = problem.variables();
        let slide = slide_per_radian(&problem);
        let angles = problem.names().variable_is_angle.iter();
        let unit = angles.map(|&angle| if angle { 1.0 } else { slide });
        let mut drag = Self {
            solver: Solver::default(),
            nudged: Solver::default(),
            search: None,
            max_move: MOST_MOVE,
            targets: problem.targets(),
            moves: MoveLimits::by_angle(&problem, MOST_MOVE, start)?,
            unit: unit.collect(),
            before: [vec![0.0; n], vec![0.0; n]],
            x: vec![0.0; n],
            q: start.to_vec(),
            workspace: Workspace::new(),
            trial: Workspace::new(),
            misses: 0,
            moved: 0.0,
            way_out: LocalMinimumEscape::new(n),
            way_out_solvers: WayOutSolvers::new(&Solver::default(), Stopping::default()),
            way_out_of_contact: WayOutOfContact::new(n),
            leap: None,
            q_before: Vec::new(),
            clear: None,
            touches: true,
            motion: None,
            moved_joints: MovedJoints::default(),
            problem,
        };
        drag.set_configuration(start)?;
        // Allocates the memory of all solves now, so that frames allocate nothing.
        let look = Stopping::default().with_max_iterations(0);
        let look = Solver::default().with_stopping(look);
        let look = look.with_restarts(Restarts::none());
        solve(&look, (&drag.problem).into(), &drag.q, &mut drag.trial);
        let steps = Stopping::default().with_max_iterations(STEPS);
        Ok(drag.with_solver(Solver::default(), steps)?)
    }

    /// Sets the solver and the stopping criteria of a frame. The default maximum is 40 steps. The solver's restarts are
    /// ignored.
    ///
    /// # Errors
    /// Returns an error if an option is out of its range.
    pub fn with_solver(mut self, solver: Solver, stopping: Stopping) -> Result<Self, BadOption> {
        stopping.check()?;
        self.way_out_solvers = WayOutSolvers::new(&solver, stopping);
        let few = stopping.max_iterations().min(NUDGE_STEPS);
        let once = solver.with_restarts(Restarts::none());
        once.check()?;
        let nudged = once.clone().with_refining(Extent::Goals);
        self.nudged = nudged.with_stopping(stopping.with_max_iterations(few));
        self.solver = once.with_refining(Extent::Frame).with_stopping(stopping);
        Ok(self)
    }

    /// Sets the largest displacement of a joint per frame, radians. Default 0.15. The bound of a prismatic joint is the
    /// displacement that this angle causes at a quarter of the model's reach. With infinity a joint may move anywhere
    /// on its branch.
    ///
    /// # Errors
    /// Returns an error if `radians` is not above 0.
    pub fn with_max_move(mut self, radians: f64) -> Result<Self, BadOption> {
        let above = |radians| radians > 0.0;
        BadOption::check("max_move", radians, (above, "a number above 0"))?;
        self.set_max_move(radians);
        Ok(self)
    }

    pub(super) fn set_max_move(&mut self, radians: f64) {
        self.max_move = radians;
        self.moves.set_angle(&self.problem, radians);
        if let Some(motion) = &self.motion {
            self.moves.lower_to(&self.problem, motion.largest_steps());
        }
    }

    /// Enforces limits of velocity, acceleration and jerk in every frame. The rates are finite differences of
    /// [`q`](Self::q) over `time_step`, the time between two frames in seconds. The drag starts at rest.
    ///
    /// A frame first computes its goal: the configuration of a drag without motion limits, with every joint within its
    /// velocity limit. Each joint then follows its goal as closely as its limits allow. It always keeps the distance
    /// that it needs to brake before a position limit. [`q`](Self::q) and [`solution`](Self::solution) describe the
    /// commanded configuration.
    ///
    /// The limits take precedence over all tasks. Joints that lag behind their goals by different times displace pinned
    /// frames. Pinned frames stay in place if the targets move within the limits, but not if targets jump.
    /// [`settle`](Self::settle) then acts like [`follow`](Self::follow). [`set_configuration`](Self::set_configuration)
    /// restarts at rest.
    ///
    /// # Errors
    /// Returns an error for:
    ///
    /// - a time step that is not positive and finite,
    /// - a number of limits that differs from the length of a configuration,
    /// - a limit that is negative or NaN, or an acceleration or jerk limit of 0,
    /// - a ball joint with a bounded range,
    /// - a problem with collision avoidance.
    pub fn with_motion_limits(
        mut self,
        time_step: f64,
        limits: &MotionLimits,
    ) -> Result<Self, SolveError> {
        let motion = DragMotion::new(&self.problem, time_step, limits, &self.x)?;
        self.motion = Some(Box::new(motion));
        self.set_max_move(self.max_move);
        self.command_at_rest();
        Ok(self)
    }

    /// Enables a global search from other starts if a frame settles without reaching. Its result is used if it lowers
    /// the cost by at least a thousandth, and may be a [`jump`](Self::jump). Such a frame takes as long as a whole
    /// solve. By default there is no search, and a drag never jumps.
    ///
    /// # Errors
    /// Returns an error if an option is out of its range.
    pub fn with_search(mut self, restarts: Restarts) -> Result<Self, BadOption> {
        restarts.check()?;
        self.search = Some(Solver::default().with_restarts(restarts));
        Ok(self)
    }

    getters! {
        /// Problem of the drag.
        pub fn problem(&self) -> &Problem = &self.problem;
    }

    /// Returns the commanded configuration.
    #[must_use]
    pub fn q(&self) -> &[f64] {
        match &self.motion {
            Some(motion) => motion.q(),
            None => &self.q,
        }
    }

    /// Returns the solution of the last frame; empty before the first one. Its
    /// [`active_limits`](Solution::active_limits) distinguish joint limits from displacement bounds of the frame.
    #[must_use]
    pub fn solution(&self) -> &Solution {
        match &self.motion {
            Some(motion) => motion.solution(),
            None => &self.workspace.solution,
        }
    }

    /// Returns whether there are motion limits and the commanded configuration has not arrived at the goal.
    fn lags(&self) -> bool {
        (self.motion.as_ref()).is_some_and(|motion| !motion.is_at_rest_on_goal())
    }

    /// Returns the problem with the current targets.
    #[must_use]
    pub fn question(&self) -> ProblemInstance<'_> {
        self.moved_joints.question(&self.problem, &self.targets)
    }

    /// Returns the residual of a task, to move its target, like [`Targets::get_mut`].
    ///
    /// # Errors
    /// Returns the errors of [`Targets::get_mut`].
    pub fn target_mut<R: Residual>(&mut self, task: TaskId<R>) -> Result<&mut R, ProblemError> {
        self.targets.get_mut(task)
    }

    /// Returns whether a joint moved as far as a frame allows and is still catching up. The next frames continue the
    /// motion.
    #[must_use]
    pub fn is_speed_limited(&self) -> bool {
        self.goal_catches_up() || self.lags()
    }

    fn goal_catches_up(&self) -> bool {
        let mut limits = self.workspace.solution.active_limits();
        limits.any(|limit| limit.kind == BoundKind::Move)
    }

    /// Returns the jump of the last frame, if there was one.
    #[must_use]
    pub fn jump(&self) -> Option<DragJump<'_>> {
        let (variable, distance) = self.leap?;
        let joint = self.problem.names().joints.get(variable)?;
        Some(DragJump { joint, distance })
    }

    /// Continues from another configuration, which is projected into the joint limits.
    ///
    /// # Errors
    /// Returns an error if `q` has the wrong length or a number that is not finite.
    pub fn set_configuration(&mut self, q: &[f64]) -> Result<(), SolveError> {
        check_start(&self.problem, q)?;
        self.problem.parameters().gather(q, &mut self.x);
        ProblemInstance::from(&self.problem)
            .space()
            .project(&mut self.x);
        let map = self.problem.parameters();
        map.scatter_within_limits(&self.x, &mut self.q);
        self.misses = 0;
        self.touches = true;
        self.way_out.clear();
        self.way_out_of_contact.clear();
        self.command_at_rest();
        Ok(())
    }

    /// Moves joints and frames on their parents to their placements in `model`. Its joints and frames must be those of
    /// the problem's model, in the same order. The configuration stays, and the next frame starts from it.
    ///
    /// If scales shear the bones of a character, call this after each frame with the model of
    /// [`Skeleton::standing_in`](crate::skeleton::Skeleton::standing_in) for its pose.
    ///
    /// # Errors
    /// Returns an error if the joints or frames of `model` differ, or if the problem has collision avoidance.
    pub fn move_joints(&mut self, model: &Model) -> Result<(), SolveError> {
        let names = self.problem.names();
        let frames = self.problem.tree().frames().map(|frame| frame.index());
        let (given, expected) = (model.configuration_len(), self.problem.configuration_len());
        if given != expected
            || frames
                .max()
                .is_some_and(|last| last >= model.frames().len())
        {
            return Err(SolveError::OtherModel {
                model: names.model.clone(),
                expected,
                given,
            });
        }
        if self.problem.fence().is_some() {
            return Err(SolveError::JointsOfCollisions {
                model: names.model.clone(),
            });
        }
        self.moved_joints.take(&self.problem, model);
        Ok(())
    }

    /// Computes one frame for the current targets.
    pub fn advance(&mut self) -> &Solution {
        self.leap = None;
        self.q_before.clone_from(&self.q);
        self.moves.start_from(&self.problem, &self.x);
        if !self.go_out() {
            self.settle_frame();
        }
        self.keep_way_clear();
        let solution = &self.workspace.solution;
        self.moved = 0.0;
        if solution.q.iter().all(|value| value.is_finite()) {
            self.q.copy_from_slice(&solution.q);
            let [from, _] = &mut self.before;
            from.copy_from_slice(&self.x);
            self.problem.parameters().gather(&self.q, &mut self.x);
            self.moved = self.furthest_move().map_or(0.0, |(_, moved)| moved);
        }
        if let Some(motion) = &mut self.motion {
            motion.follow(&self.problem, &self.x);
            let question = self.moved_joints.question(&self.problem, &self.targets);
            motion.report(question, &self.workspace.solution);
        }
        self.solution()
    }

    /// Resets the commanded configuration to rest at the goal.
    fn command_at_rest(&mut self) {
        if let Some(motion) = &mut self.motion {
            motion.rest_at(&self.problem, &self.x);
        }
    }

    /// Solves within the bounds of the frame. If that settles without reaching, attempts a perturbation, a search and
    /// an escape.
    fn settle_frame(&mut self) {
        let question = near(
            &self.problem,
            &self.targets,
            &self.moves,
            &self.moved_joints,
        );
        solve(&self.solver, question, &self.q, &mut self.workspace);
        let solution = &self.workspace.solution;
        let settled = !solution.reached && solution.termination.is_settled();
        let stuck = settled && !self.goal_catches_up();
        self.misses = if stuck { self.misses + 1 } else { 0 };
        if stuck && self.misses % NUDGE_EVERY == 1 {
            self.nudge();
        }
        if stuck {
            self.search();
            self.seek_way_out();
        }
    }

    /// Returns whether further frames would change nothing. Either the targets are reached without soft tasks, or the
    /// last frame moved no joint and no perturbation or escape is pending.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        let stays = !self.moved_joints.any() || self.moved < REST;
        let done = self.workspace.solution.reached && !self.problem.has_preferences() && stays;
        let nudged = self.misses == 0 || self.misses > NUDGE_EVERY;
        let seeks = self.seeks_way_out() || self.seeks_way_out_of_contact();
        if self.lags() {
            return false;
        }
        done || (self.moved < REST && nudged && !seeks)
    }

    /// Returns the variable with the largest displacement since `before`, and that displacement in radians.
    fn furthest_move(&mut self) -> Option<(usize, f64)> {
        let [from, way] = &mut self.before;
        furthest_move(&self.problem, &self.unit, [from, &self.x], way)
    }

    /// Solves from a small perturbation of the settled configuration, and uses the result if it is better.
    fn nudge(&mut self) {
        let from = &self.workspace.solution.q;
        let map = self.problem.parameters();
        // The buffer of the other workspace has the right size after the first use.
        let start = &mut self.trial.search.start;
        start.resize(self.x.len(), 0.0);
        map.gather(from, start);
        let mut random = RandomStream::new(0, self.misses as u64);
        // The first perturbation is towards the middle of the joint ranges, so that both sides of a symmetric model
        // bend equally. Later ones are random.
        let inward = self.misses % (2 * NUDGE_EVERY) == 1;
        let (lower, upper) = (self.problem.lower(), self.problem.upper());
        for (j, value) in start.iter_mut().enumerate() {
            let drawn = 2.0 * random.unit() - 1.0;
            let off = 0.5 * (lower[j] + upper[j]) - *value;
            let aside = match inward {
                true if off.is_finite() && off.abs() > CENTRED * (upper[j] - lower[j]) => {
                    off.signum()
                }
                true => 0.0,
                false => drawn,
            };
            if self.problem.moves_a_task(j) {
                *value += self.unit[j] * NUDGE * aside;
            }
        }
        let question = near(
            &self.problem,
            &self.targets,
            &self.moves,
            &self.moved_joints,
        );
        question.space().project(start);
        map.scatter_within_limits(start, &mut self.q);
        solve(&self.nudged, question, &self.q, &mut self.trial);
        self.take_trial();
    }

    /// Searches globally, if enabled.
    fn search(&mut self) {
        let Some(search) = &self.search else {
            return;
        };
        let question = self.moved_joints.question(&self.problem, &self.targets);
        solve(
            search,
            question,
            &self.workspace.solution.q,
            &mut self.trial,
        );
        if !self.take_trial() {
            // The search included the settled configuration, so its count of agreeing attempts also applies there.
            self.workspace.solution.agreeing = self.trial.solution.agreeing;
            return;
        }
        let [from, _] = &mut self.before;
        from.copy_from_slice(&self.x);
        let map = self.problem.parameters();
        map.gather(&self.workspace.solution.q, &mut self.x);
        let furthest = self.furthest_move();
        let [from, _] = &self.before;
        self.x.copy_from_slice(from);
        self.leap = furthest
            .filter(|&(_, moved)| moved > self.max_move)
            .map(|(variable, moved)| (variable, moved * self.unit[variable]));
    }

    /// Uses the trial if it is better. The effort of both solves counts.
    fn take_trial(&mut self) -> bool {
        let (kept, trial) = (&mut self.workspace, &mut self.trial);
        let better = trial.solution.reached || trial.is_better(&self.problem, BETTER, kept);
        if better {
            std::mem::swap(kept, trial);
        }
        kept.solution.iterations += trial.solution.iterations;
        kept.solution.attempts += trial.solution.attempts;
        kept.solution.counts += trial.solution.counts;
        better
    }
}
