//! Dragging: one problem whose targets move from frame to frame.

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

/// How far a joint may move in a frame unless set otherwise, in radians: 9 rad/s at 60 frames a
/// second.
const MOST_MOVE: f64 = 0.15;
/// Steps of a frame at most. A frame that is cut short goes on in the next.
const STEPS: usize = 40;
/// How far the nudge goes, in radians, and for how many steps it may show that it leads on.
const NUDGE: f64 = 0.01;
const NUDGE_STEPS: usize = 10;
/// A joint this near the middle of its range, as a share of it, has no side to go to.
const CENTRED: f64 = 1e-6;
/// The cost at which a nudge, or a search from elsewhere, has led to something better.
pub(super) const BETTER: f64 = 1.0 - 1e-3;

/// A problem that is solved again and again while its targets move, as a hand under a mouse does.
///
/// Each [`advance`](Self::advance) settles from where the last one ended, on the same branch, in a
/// bounded number of steps and without restarts, so that a frame that misses costs no more than a few
/// that reach. No joint moves further in a frame than [`with_max_move`](Self::with_max_move) says:
/// where a target leaps or a branch ends, the body follows over several frames, which
/// [`is_speed_limited`](Self::is_speed_limited) tells. It leaps only where [`with_search`](Self::with_search)
/// asks for a global search on a miss, and then [`jump`](Self::jump) says so.
///
/// A body that [keeps clear](crate::problem::ProblemBuilder::keep_clear) goes only where the straight way of each frame is free, on
/// which all joints move evenly, and so slides along what is in the way; its solution is then not reached and names that
/// ([`Solution::collisions`]). From a place that touches something every frame touches less, until nothing does; where
/// no small step does, an arm in a plate being an example, the body goes straight to a free place not far away, through what it is in.
/// It leaps nowhere.
///
/// Where it comes to rest a little short of targets that it could reach, limits of several joints being in its way, the
/// frames that follow look for a way out on the same branch, one attempt each, and go there as far in a frame as joints may
/// move; [`is_at_rest`](Self::is_at_rest) waits for that.
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
    /// The bounds of a frame.
    pub(super) moves: MoveLimits,
    /// What a variable may move by where `max_move` is 1: 1 rad, or the length that weighs as much.
    pub(super) unit: Vec<f64>,
    /// Where the body stood before, and the way from there.
    pub(super) before: [Vec<f64>; 2],
    pub(super) x: Vec<f64>,
    pub(super) q: Vec<f64>,
    pub(super) workspace: Workspace,
    pub(super) trial: Workspace,
    /// Frames in a row that settled on a miss.
    pub(super) misses: usize,
    /// The furthest that a joint moved in the last frame, in radians.
    pub(super) moved: f64,
    pub(super) way_out: LocalMinimumEscape,
    pub(super) way_out_solvers: WayOutSolvers,
    pub(super) way_out_of_contact: WayOutOfContact,
    pub(super) leap: Option<(usize, f64)>,
    /// Where a frame of a body that keeps clear begins, and room for its checks.
    pub(super) q_before: Vec<f64>,
    pub(super) clear: Option<Box<CollisionWorkspace>>,
    /// Whether something may touch where the body stands.
    pub(super) touches: bool,
    /// The commanded motion, if rates are limited; all other fields are then those of its goal.
    pub(super) motion: Option<Box<DragMotion>>,
}

/// A joint that moved further in a frame than the drag allows, because a search from elsewhere was
/// asked for and found better.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct DragJump<'a> {
    /// The joint that moved furthest for what it may.
    pub joint: &'a str,
    /// How far, in radians or metres.
    pub distance: f64,
}

impl Drag {
    /// A drag of `problem` from the configuration `start` (degrees of freedom; projected into the
    /// limits). The problem's targets may be anywhere: the first [`advance`](Self::advance) looks.
    ///
    /// # Errors
    /// A start of the wrong length, or one that is not finite.
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
        // Its memory before the first frame that needs it, so that frames allocate nothing.
        let look = Stopping::default().with_max_iterations(0);
        let look = Solver::default().with_stopping(look);
        let look = look.with_restarts(Restarts::none());
        solve(&look, (&drag.problem).into(), &drag.q, &mut drag.trial);
        let steps = Stopping::default().with_max_iterations(STEPS);
        Ok(drag.with_solver(Solver::default(), steps)?)
    }

    /// The method of another solver, within these limits a frame: at most 40 steps unless set. Its
    /// restarts are not used.
    ///
    /// # Errors
    /// An option out of its range.
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

    /// How far a joint may move in a frame, in radians: 0.15 unless set; slides as far as a joint
    /// would carry what is a quarter of the model's reach away. Infinity lets a joint go where its
    /// branch takes it.
    ///
    /// # Errors
    /// A number that is not above 0.
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

    /// Keeps limits of velocity, acceleration and jerk in every frame, by finite differences of [`q`](Self::q) over the `time_step`
    /// between two frames, seconds. The drag starts at rest.
    ///
    /// A frame first finds its goal: the configuration that a drag without a time step goes to, no joint faster than its velocity limit.
    /// Each joint then follows its own goal as closely as its limits allow, and always keeps the distance that it
    /// needs to brake before a position limit. [`q`](Self::q) and [`solution`](Self::solution) are those of the commanded configuration.
    ///
    /// The limits come before all tasks. Joints that lag behind their goals by different times move pinned frames: targets that are
    /// themselves within the limits leave pinned frames in place, targets that jump do not. [`settle`](Self::settle) is
    /// [`follow`](Self::follow), and [`set_configuration`](Self::set_configuration) starts again at rest.
    ///
    /// # Errors
    /// A time step that is not a positive number; another number of limits than a configuration has numbers; a limit that is negative or
    /// NaN, or an acceleration or jerk limit of 0; a ball joint with a bounded range; a problem that avoids collisions.
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

    /// Where a frame settles on a miss, searches from other places too, and goes to what is better by
    /// a thousandth of the cost: reported as a [`jump`](Self::jump). Such a frame costs what a whole
    /// solve costs. Without it a drag never leaps.
    ///
    /// # Errors
    /// An option out of its range.
    pub fn with_search(mut self, restarts: Restarts) -> Result<Self, BadOption> {
        restarts.check()?;
        self.search = Some(Solver::default().with_restarts(restarts));
        Ok(self)
    }

    getters! {
        /// What is dragged.
        pub fn problem(&self) -> &Problem = &self.problem;
    }

    /// Where the body stands (degrees of freedom): the commanded configuration.
    #[must_use]
    pub fn q(&self) -> &[f64] {
        match &self.motion {
            Some(motion) => motion.q(),
            None => &self.q,
        }
    }

    /// What the last frame came to: empty before the first. Its
    /// [`active_limits`](Solution::active_limits) tell limits from the most that a joint may move in
    /// a frame.
    #[must_use]
    pub fn solution(&self) -> &Solution {
        match &self.motion {
            Some(motion) => motion.solution(),
            None => &self.workspace.solution,
        }
    }

    /// Whether rates are limited and the commanded configuration is still on its way to the goal.
    fn lags(&self) -> bool {
        (self.motion.as_ref()).is_some_and(|motion| !motion.is_at_rest_on_goal())
    }

    /// What is dragged, with the targets as they are now.
    #[must_use]
    pub fn question(&self) -> ProblemInstance<'_> {
        self.moved_joints.question(&self.problem, &self.targets)
    }

    /// A task's residual, to move its target; as [`Targets::get_mut`].
    ///
    /// # Errors
    /// As there.
    pub fn target_mut<R: Residual>(&mut self, task: TaskId<R>) -> Result<&mut R, ProblemError> {
        self.targets.get_mut(task)
    }

    /// Whether some joint moved as far as a frame allows and would go on: the next frames follow.
    #[must_use]
    pub fn is_speed_limited(&self) -> bool {
        self.goal_catches_up() || self.lags()
    }

    fn goal_catches_up(&self) -> bool {
        let mut limits = self.workspace.solution.active_limits();
        limits.any(|limit| limit.kind == BoundKind::Move)
    }

    /// The leap of the last frame, if it leapt.
    #[must_use]
    pub fn jump(&self) -> Option<DragJump<'_>> {
        let (variable, distance) = self.leap?;
        let joint = self.problem.names().joints.get(variable)?;
        Some(DragJump { joint, distance })
    }

    /// Goes on from another configuration (degrees of freedom; projected into the limits).
    ///
    /// # Errors
    /// One of the wrong length, or one that is not finite.
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

    /// Moves joints and frames on their parents to where `model` has them, which has the joints and frames of the problem's
    /// model in their order. The configuration stays, and the next frame goes on from it.
    ///
    /// A character whose scales shear its bones is dragged by
    /// [`Skeleton::standing_in`](crate::skeleton::Skeleton::standing_in) of its pose after each frame.
    ///
    /// # Errors
    /// A model of other joints or frames; a problem that avoids collisions.
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

    /// One frame: follows the targets as they are now.
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

    /// Puts the commanded configuration at rest on the goal.
    fn command_at_rest(&mut self) {
        if let Some(motion) = &mut self.motion {
            motion.rest_at(&self.problem, &self.x);
        }
    }

    /// Settles within the bounds of the frame, and where that misses looks around.
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

    /// Whether the last frame moved no joint, nor did nudges where it missed, or reached its targets with
    /// nothing else to come: the next would do nothing.
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

    /// The variable that has moved furthest since `before`, and how far, in radians.
    fn furthest_move(&mut self) -> Option<(usize, f64)> {
        let [from, way] = &mut self.before;
        furthest_move(&self.problem, &self.unit, [from, &self.x], way)
    }

    /// Sets off a little beside where the frame settled, and stays with what that leads to if it is
    /// better.
    fn nudge(&mut self) {
        let from = &self.workspace.solution.q;
        let map = self.problem.parameters();
        // Into the other's memory, which has the right size after the first time.
        let start = &mut self.trial.search.start;
        start.resize(self.x.len(), 0.0);
        map.gather(from, start);
        let mut random = RandomStream::new(0, self.misses as u64);
        // First towards the middle of the joints' ranges, which is where both sides of a symmetric body bend
        // alike, then anywhere.
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

    /// Searches from everywhere, where that is asked for.
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
            // It began where the frame settled, so what ended as near did so there.
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

    /// Stays with the trial if it is better; either way the frame has made both.
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
