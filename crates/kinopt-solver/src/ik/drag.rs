//! Drag: one problem whose targets move from frame to frame.

use super::collision_avoidance::AvoidanceWorkspace;
use super::depenetration::Depenetration;
use super::drag_frame::{
    FRAMES_PER_PERTURBATION, MAX_REST_MOVE, MovedJoints, frame_instance, solve,
};
use super::drag_motion::DragMotion;
use super::escape::{EscapeSolvers, LocalMinimumEscape};
use super::joint_interpolation::max_displacement;
use super::priority::Extent;
use super::{
    BoundKind, JointJump, MotionLimits, MoveLimits, Restarts, Solution, SolveError, Solver,
    Workspace,
};
use crate::problem::{Problem, ProblemError, ProblemInstance, Targets, TaskId};
use crate::search::{check_start, slide_per_radian};
use crate::solver::Stopping;
use crate::task::Residual;
use kinopt_kinematics::bad_option::BadOption;
use kinopt_kinematics::model::Model;
use kinopt_kinematics::random::RandomStream;

/// Default largest displacement of a joint per frame, radians: 9 rad/s at 60 frames per second.
const DEFAULT_MAX_MOVE: f64 = 0.15;
/// Default maximum number of steps per frame. A frame that is cut short continues in the next one.
const DEFAULT_STEPS: usize = 40;
/// Size of a perturbation, radians, and maximum number of steps from it.
const PERTURBATION: f64 = 0.01;
const PERTURBATION_STEPS: usize = 10;
/// Distance from the middle of a range, relative to the range, below which a joint is perturbed to neither side.
const CENTRE_TOLERANCE: f64 = 1e-6;
/// Largest ratio of costs at which the result of a perturbation or search is accepted.
pub(super) const MAX_ACCEPTED_COST_RATIO: f64 = 1.0 - 1e-3;

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
    perturbation_solver: Solver,
    pub(super) search: Option<Solver>,
    pub(super) max_move: f64,
    /// Joint displacement bounds of a frame.
    pub(super) move_limits: MoveLimits,
    /// Displacement of each variable for a `max_move` of 1: 1 rad, or the equivalent length.
    pub(super) units: Vec<f64>,
    /// Variables before the frame, and the displacement from there.
    pub(super) last_motion: [Vec<f64>; 2],
    pub(super) x: Vec<f64>,
    pub(super) q: Vec<f64>,
    pub(super) workspace: Workspace,
    pub(super) trial: Workspace,
    /// Number of consecutive frames that settled without reaching.
    pub(super) unreached_frames: usize,
    /// Largest displacement of a joint in the last frame, radians.
    pub(super) last_move: f64,
    pub(super) escape: LocalMinimumEscape,
    pub(super) escape_solvers: EscapeSolvers,
    pub(super) depenetration: Depenetration,
    /// Number of frames so far.
    frames: usize,
    pub(super) last_jump: Option<JointJump>,
    /// Configuration at the start of a frame, and the workspace of collision avoidance.
    pub(super) q_before: Vec<f64>,
    pub(super) collision_workspace: Option<Box<AvoidanceWorkspace>>,
    /// True if the configuration may be in collision.
    pub(super) may_collide: bool,
    /// Commanded motion, if there are motion limits. All other fields then describe its goal.
    pub(super) motion: Option<Box<DragMotion>>,
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
        let length_per_radian = slide_per_radian(&problem);
        let angles = problem.names().variable_is_angle.iter();
        let unit = angles.map(|&angle| if angle { 1.0 } else { length_per_radian });
        let mut drag = Self {
            solver: Solver::default(),
            perturbation_solver: Solver::default(),
            search: None,
            max_move: DEFAULT_MAX_MOVE,
            targets: problem.targets(),
            move_limits: MoveLimits::by_angle(&problem, DEFAULT_MAX_MOVE, start)?,
            units: unit.collect(),
            last_motion: [vec![0.0; n], vec![0.0; n]],
            x: vec![0.0; n],
            q: start.to_vec(),
            workspace: Workspace::new(),
            trial: Workspace::new(),
            unreached_frames: 0,
            last_move: 0.0,
            escape: LocalMinimumEscape::new(n),
            escape_solvers: EscapeSolvers::new(&Solver::default(), Stopping::default()),
            depenetration: Depenetration::new(n),
            frames: 0,
            last_jump: None,
            q_before: Vec::new(),
            collision_workspace: None,
            may_collide: true,
            motion: None,
            moved_joints: MovedJoints::default(),
            problem,
        };
        drag.set_configuration(start)?;
        // Allocates the memory of all solves now, so that frames allocate nothing.
        let evaluator = Stopping::default().with_max_iterations(0);
        let evaluator = Solver::default().with_stopping(evaluator);
        let evaluator = evaluator.with_restarts(Restarts::none());
        solve(&evaluator, (&drag.problem).into(), &drag.q, &mut drag.trial);
        let steps = Stopping::default().with_max_iterations(DEFAULT_STEPS);
        Ok(drag.with_solver(Solver::default(), steps)?)
    }

    /// Sets the solver and the stopping criteria of a frame. The default maximum is 40 steps. The solver's restarts are
    /// ignored.
    ///
    /// # Errors
    /// Returns an error if an option is out of its range.
    pub fn with_solver(mut self, solver: Solver, stopping: Stopping) -> Result<Self, BadOption> {
        stopping.check()?;
        self.escape_solvers = EscapeSolvers::new(&solver, stopping);
        let perturbation_steps = stopping.max_iterations().min(PERTURBATION_STEPS);
        let single_attempt = solver.with_restarts(Restarts::none());
        single_attempt.check()?;
        let perturbation_solver = single_attempt.clone().with_extent(Extent::Goals);
        self.perturbation_solver =
            perturbation_solver.with_stopping(stopping.with_max_iterations(perturbation_steps));
        self.solver = single_attempt
            .with_extent(Extent::Frame)
            .with_stopping(stopping);
        Ok(self)
    }

    /// Sets the largest displacement of a joint per frame, radians. Default 0.15. The bound of a prismatic joint is the
    /// displacement that this angle causes at a quarter of the model's reach. With infinity a joint may move anywhere
    /// on its branch.
    ///
    /// # Errors
    /// Returns an error if `radians` is not above 0.
    pub fn with_max_move(mut self, radians: f64) -> Result<Self, BadOption> {
        let is_positive = |radians| radians > 0.0;
        BadOption::check("max_move", radians, (is_positive, "a number above 0"))?;
        self.set_max_move(radians);
        Ok(self)
    }

    pub(super) fn set_max_move(&mut self, radians: f64) {
        self.max_move = radians;
        self.move_limits.set_angle(&self.problem, radians);
        if let Some(motion) = &self.motion {
            self.move_limits
                .lower_to(&self.problem, motion.largest_steps());
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

    /// Problem of the drag.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.problem
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
    fn is_behind_goal(&self) -> bool {
        (self.motion.as_ref()).is_some_and(|motion| !motion.is_at_rest_on_goal())
    }

    /// Returns the problem with the current targets.
    #[must_use]
    pub fn question(&self) -> ProblemInstance<'_> {
        self.moved_joints.instance(&self.problem, &self.targets)
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
        self.is_goal_speed_limited() || self.is_behind_goal()
    }

    fn is_goal_speed_limited(&self) -> bool {
        let mut limits = self.workspace.solution.active_limits();
        limits.any(|limit| limit.kind == BoundKind::Move)
    }

    /// Returns the jump of the last frame, if the global search of [`with_search`](Self::with_search) made one.
    #[must_use]
    pub fn jump(&self) -> Option<JointJump> {
        self.last_jump
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
        self.unreached_frames = 0;
        self.may_collide = true;
        self.escape.clear();
        self.depenetration.clear();
        self.moved_joints.restart();
        self.command_at_rest();
        Ok(())
    }

    /// Moves joints and frames on their parents to their placements in `model`. Its joints and frames must be those of
    /// the problem's model, in the same order. The configuration stays, and the next frame starts from it.
    ///
    /// If scales shear the bones of a character, call this after each frame with the model of
    /// `FramePose::posed_skeleton` for its pose. If the placements of successive
    /// calls oscillate, joints move only part of the way, so that the frames converge.
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
                .is_some_and(|last_index| last_index >= model.frames().len())
        {
            return Err(SolveError::OtherModel {
                model: names.model.clone(),
                expected,
                given,
            });
        }
        if self.problem.collision_constraint().is_some() {
            return Err(SolveError::JointsOfCollisions {
                model: names.model.clone(),
            });
        }
        self.moved_joints.follow_placements(&self.problem, model);
        Ok(())
    }

    /// Computes one frame for the current targets.
    pub fn advance(&mut self) -> &Solution {
        self.last_jump = None;
        self.frames += 1;
        self.q_before.clone_from(&self.q);
        self.move_limits.start_from(&self.problem, &self.x);
        if !self.step_escape() {
            self.solve_frame();
        }
        self.keep_motion_collision_free();
        let solution = &self.workspace.solution;
        self.last_move = 0.0;
        if solution.q.iter().all(|value| value.is_finite()) {
            self.q.copy_from_slice(&solution.q);
            let [x_before, _] = &mut self.last_motion;
            x_before.copy_from_slice(&self.x);
            self.problem.parameters().gather(&self.q, &mut self.x);
            self.last_move = self
                .max_displacement()
                .map_or(0.0, |(_, distance)| distance);
        }
        if let Some(motion) = &mut self.motion {
            motion.follow(&self.problem, &self.x);
            let instance = self.moved_joints.instance(&self.problem, &self.targets);
            motion.report(instance, &self.workspace.solution);
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
    fn solve_frame(&mut self) {
        let instance = frame_instance(
            &self.problem,
            &self.targets,
            &self.move_limits,
            &self.moved_joints,
        );
        solve(&self.solver, instance, &self.q, &mut self.workspace);
        let solution = &self.workspace.solution;
        let settled = !solution.reached && solution.termination.is_settled();
        let at_minimum = settled && !self.is_goal_speed_limited();
        self.unreached_frames = if at_minimum {
            self.unreached_frames + 1
        } else {
            0
        };
        if at_minimum && self.unreached_frames % FRAMES_PER_PERTURBATION == 1 {
            self.perturb();
        }
        if at_minimum {
            self.search();
            self.attempt_escape();
        }
    }

    /// Returns whether further frames would change nothing. Either the targets are reached without soft tasks, or the
    /// last frame moved no joint and no perturbation or escape is pending.
    #[must_use]
    pub fn is_at_rest(&self) -> bool {
        let joints_on_parents = !self.moved_joints.has_moved() || self.last_move < MAX_REST_MOVE;
        let is_finished =
            self.workspace.solution.reached && !self.problem.has_preferences() && joints_on_parents;
        let no_perturbation_pending =
            self.unreached_frames == 0 || self.unreached_frames > FRAMES_PER_PERTURBATION;
        let escaping = self.is_escaping() || self.is_depenetrating();
        if self.is_behind_goal() {
            return false;
        }
        is_finished || (self.last_move < MAX_REST_MOVE && no_perturbation_pending && !escaping)
    }

    /// Returns the variable with the largest displacement in `last_motion`, and that displacement in radians.
    fn max_displacement(&mut self) -> Option<(usize, f64)> {
        let [from, displacement] = &mut self.last_motion;
        max_displacement(&self.problem, &self.units, [from, &self.x], displacement)
    }

    /// Solves from a small perturbation of the settled configuration, and uses the result if it is better.
    fn perturb(&mut self) {
        let from = &self.workspace.solution.q;
        let map = self.problem.parameters();
        // The buffer of the other workspace has the right size after the first use.
        let start = &mut self.trial.search.start;
        start.resize(self.x.len(), 0.0);
        map.gather(from, start);
        let mut random = RandomStream::new(0, self.unreached_frames as u64);
        // The first perturbation is towards the middle of the joint ranges, so that both sides of a symmetric model
        // bend equally. Later ones are random.
        let inward = self.unreached_frames % (2 * FRAMES_PER_PERTURBATION) == 1;
        let (lower, upper) = (self.problem.lower(), self.problem.upper());
        for (j, value) in start.iter_mut().enumerate() {
            let sample = 2.0 * random.unit() - 1.0;
            let centre_offset = 0.5 * (lower[j] + upper[j]) - *value;
            let direction = match inward {
                true if centre_offset.is_finite()
                    && centre_offset.abs() > CENTRE_TOLERANCE * (upper[j] - lower[j]) =>
                {
                    centre_offset.signum()
                }
                true => 0.0,
                false => sample,
            };
            if self.problem.moves_a_task(j) {
                *value += self.units[j] * PERTURBATION * direction;
            }
        }
        let instance = frame_instance(
            &self.problem,
            &self.targets,
            &self.move_limits,
            &self.moved_joints,
        );
        instance.space().project(start);
        map.scatter_within_limits(start, &mut self.q);
        solve(
            &self.perturbation_solver,
            instance,
            &self.q,
            &mut self.trial,
        );
        self.accept_better_trial();
    }

    /// Searches globally, if enabled.
    fn search(&mut self) {
        let Some(search) = &self.search else {
            return;
        };
        let instance = self.moved_joints.instance(&self.problem, &self.targets);
        solve(
            search,
            instance,
            &self.workspace.solution.q,
            &mut self.trial,
        );
        if !self.accept_better_trial() {
            // The search included the settled configuration, so its count of agreeing attempts also applies there.
            self.workspace.solution.agreeing = self.trial.solution.agreeing;
            return;
        }
        let [from, _] = &mut self.last_motion;
        from.copy_from_slice(&self.x);
        let map = self.problem.parameters();
        map.gather(&self.workspace.solution.q, &mut self.x);
        let max_move = self.max_displacement();
        let [from, _] = &self.last_motion;
        self.x.copy_from_slice(from);
        self.last_jump = max_move
            .filter(|&(_, distance)| distance > self.max_move)
            .map(|(variable, distance)| JointJump {
                index: self.frames - 1,
                joint: self.problem.parameters().leaders()[variable],
                distance: distance * self.units[variable],
                reconfiguration: true,
            });
    }

    /// Uses the trial if it is better. The effort of both solves counts.
    fn accept_better_trial(&mut self) -> bool {
        let (current, trial) = (&mut self.workspace, &mut self.trial);
        let better = trial.solution.reached
            || trial.is_better(&self.problem, MAX_ACCEPTED_COST_RATIO, current);
        if better {
            std::mem::swap(current, trial);
        }
        current.solution.iterations += trial.solution.iterations;
        current.solution.attempts += trial.solution.attempts;
        current.solution.counts += trial.solution.counts;
        better
    }
}
