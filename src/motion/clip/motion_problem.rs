//! Tasks of many frames of one model, put together.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use super::MotionProblemBuilder;
use super::bounds::FrameBounds;
use super::contact::Contact;
use super::rate_cost::CompiledRateCost;
use super::space::FrameSpace;
use crate::model::Model;
use crate::problem::{Problem, ProblemError, Share, Targets};
use crate::search::slide_per_radian;

/// What moves the targets of one task to where they are in a frame.
pub(super) type Follow = Arc<dyn Fn(usize, &mut Targets) -> Result<(), ProblemError> + Send + Sync>;

/// The motion of one model over T frames as one bounded nonlinear least-squares problem:
///
/// ```text
/// minimise    Σ_t ½ ‖w_t ∘ r_t(q_t)‖²  +  Σ_k ½ w_k² Σ_t ‖Δᵏ q_t / Δtᵏ‖²
/// subject to  q_min ≤ q_t ≤ q_max,   |q_{t+1} − q_t| ≤ v_max Δt,   q_0 and q_{T−1} fixed if asked for,
///             balls within their cones, ranges of twist and angles,   ‖log(R_tᵀ R_{t+1})‖ ≤ ω_max Δt,
///             places of free joints ‖p_{t+1} − p_t‖ ≤ v_max Δt,
///             points of frames standing still over their spans, the model's loops closed
/// ```
///
/// r_t are the tasks of a frame, whose targets and weights change from frame to frame; the k-th difference Δᵏ, of
/// velocities, accelerations or jerks, is a [`RateCost`](super::RateCost). All tasks are weighed together, preferences as
/// well; goals on several levels are refused. [`MotionSolver`](super::MotionSolver) solves it.
///
/// ```
/// use kinopt::model::{Limits, Model};
/// use kinopt::motion::clip::{MotionProblem, MotionSolver, RateCost};
/// use kinopt::spatial::{Placement, Vector3};
/// use kinopt::task::Point;
///
/// let mut builder = Model::builder("planar arm");
/// let z = Vector3::new(0.0, 0.0, 1.0);
/// let link = Placement::translation(Vector3::new(1.0, 0.0, 0.0));
/// let shoulder = builder.revolute("shoulder", None, Placement::identity(), z, Limits::new(-3.0, 3.0));
/// let elbow = builder.revolute("elbow", Some(shoulder), link, z, Limits::new(-3.0, 3.0));
/// let tip = builder.frame("tip", Some(elbow), link);
/// let model = builder.build()?;
///
/// // A target that leaps in the middle, at 60 frames a second; the elbow turns by 6 rad/s at most.
/// let mut motion = MotionProblem::builder(&model, 40, 1.0 / 60.0);
/// let hand = motion.add(Point::new(tip, [1.5, 0.5, 0.0]));
/// motion.follow(hand, |frame, point| {
///     let up = if frame < 20 { 0.5 } else { -0.5 };
///     point.set_target([1.5, up, 0.0]);
/// });
/// motion.rate_cost(RateCost::acceleration(1e-4));
/// motion.max_speed("elbow", 6.0);
/// let motion = motion.build()?;
///
/// let solved = MotionSolver::default().solve(&motion, &[0.1, 0.5])?;
/// for pair in solved.q().chunks(2).collect::<Vec<_>>().windows(2) {
///     assert!((pair[1][1] - pair[0][1]).abs() * 60.0 <= 6.0);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct MotionProblem {
    pub(super) problem: Problem,
    pub(super) frames: usize,
    pub(super) time_step_s: f64,
    pub(super) space: FrameSpace,
    pub(super) bounds: FrameBounds,
    pub(super) follow: Vec<Follow>,
    /// By task, one a frame; empty for 1 in all.
    pub(super) weights: Vec<Vec<f64>>,
    pub(super) rate_costs: Vec<CompiledRateCost>,
    pub(super) contacts: Vec<Contact>,
    /// The points of all contacts, as residuals to the world's origin.
    pub(super) held: Option<Problem>,
    /// What a metre that they slip costs, or that a loop is open, as a weight.
    pub(super) stiffness: f64,
    /// The first and the last frame, as variables.
    pub(super) ends: [Option<Vec<f64>>; 2],
}

impl fmt::Debug for MotionProblem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("MotionProblem")
            .field("problem", &self.problem)
            .field("frames", &self.frames)
            .field("time_step_s", &self.time_step_s)
            .finish_non_exhaustive()
    }
}

impl MotionProblem {
    /// Starts a motion of `frames` frames that are `time_step_s` seconds apart, with every joint free.
    #[must_use]
    pub fn builder(model: &Model, frames: usize, time_step_s: f64) -> MotionProblemBuilder<'_> {
        MotionProblemBuilder::new(model, frames, time_step_s)
    }

    getters! {
        /// How many frames there are.
        pub fn frames(&self) -> usize = self.frames;
        /// The time from a frame to the next, in seconds.
        pub fn time_step_s(&self) -> f64 = self.time_step_s;
        /// The tasks of one frame, with the targets that they were built with.
        pub fn problem(&self) -> &Problem = &self.problem;
        /// What stands still, and when.
        pub fn contacts(&self) -> &[Contact] = &self.contacts;
        /// How many numbers a configuration has.
        pub fn configuration_len(&self) -> usize = self.problem.configuration_len();
        /// How many variables a frame has.
        pub(super) fn variables(&self) -> usize = self.problem.variables();
    }

    /// What of a variable counts as much as a radian.
    pub(super) fn unit(&self, variable: usize) -> f64 {
        match self.problem.names().variable_is_angle[variable] {
            true => 1.0,
            false => slide_per_radian(&self.problem),
        }
    }

    /// How far from its own frame a frame's cost reaches.
    pub(super) fn bandwidth(&self) -> usize {
        let orders = self.rate_costs.iter().map(|cost| cost.order);
        orders.fold(1, usize::max)
    }

    /// The first of the rows that close the model's loops, which come after the tasks'.
    pub(super) fn rows_of_tasks(&self) -> usize {
        let tasks = self.problem.compiled_tasks().iter();
        let mut loops = tasks.filter(|task| task.is_loop);
        loops
            .next()
            .map_or(self.problem.rows(), |task| task.rows.start)
    }

    pub(super) fn has_loops(&self) -> bool {
        self.rows_of_tasks() < self.problem.rows()
    }

    /// How far loops are open at most, in metres and radians, by rows that are not weighed.
    pub(super) fn open_by(&self, residual: &[f64]) -> f64 {
        let errors = self.problem.errors(Share::All, residual);
        let tasks = self.problem.compiled_tasks();
        let loops = errors.filter(|block| tasks[block.task].is_loop);
        loops.map(|block| block.error).fold(0.0, f64::max)
    }

    /// A task's weight in a frame.
    pub(super) fn weight(&self, task: usize, frame: usize) -> f64 {
        let weights = self
            .weights
            .get(task)
            .and_then(|weights| weights.get(frame));
        weights.copied().unwrap_or(1.0)
    }

    /// Whether any task has a weight of its own in some frames.
    pub(super) fn weighs(&self, frame: usize) -> bool {
        (0..self.weights.len()).any(|task| self.weight(task, frame) != 1.0)
    }

    /// Moves targets to where they are in a frame.
    pub(super) fn move_targets(&self, frame: usize, targets: &mut Targets) {
        for follow in &self.follow {
            // Built with these very tasks.
            let moved = follow(frame, targets);
            debug_assert!(moved.is_ok(), "a task of another problem");
        }
    }

    /// Whether a frame of a stretch of frames stays where it is given.
    pub(super) fn fixed(&self, window: &Range<usize>, held: usize) -> Vec<bool> {
        let [first, last] = self.ends.each_ref().map(Option::is_some);
        let is_fixed = |frame: usize| {
            frame < window.start + held
                || (first && frame == 0)
                || (last && frame + 1 == self.frames)
        };
        window.clone().map(is_fixed).collect()
    }
}
