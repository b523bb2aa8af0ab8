//! Trajectory optimisation problem.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use super::Contact;
use super::bounds::FrameBounds;
use super::rate_cost::CompiledRateCost;
use super::space::FrameSpace;
use kinopt_solver::problem::{Problem, ProblemError, Targets, TaskSubset};
use kinopt_solver::search::slide_per_radian;

/// Function that sets the targets of one task at a sample.
pub(super) type SetTargets =
    Arc<dyn Fn(usize, &mut Targets) -> Result<(), ProblemError> + Send + Sync>;

/// Trajectory of one model over T samples as a bounded nonlinear least-squares problem:
///
/// ```text
/// minimise    Σ_t ½ ‖w_t ∘ r_t(q_t)‖²  +  Σ_k ½ w_k² Σ_t ‖Δᵏ q_t / Δtᵏ‖²
/// subject to  q_min ≤ q_t ≤ q_max,   |q_{t+1} − q_t| ≤ v_max Δt,   q_0 and q_{T−1} fixed on request,
///             ball joints within their swing, twist and angle limits,   ‖log(R_tᵀ R_{t+1})‖ ≤ ω_max Δt,
///             positions of free joints ‖p_{t+1} − p_t‖ ≤ v_max Δt,
///             contact points fixed over their spans, the model's loops closed
/// ```
///
/// The r_t are the tasks at a sample. Their targets and weights change from sample to sample. The k-th difference Δᵏ,
/// of velocities, accelerations or jerks, is a [`RateCost`](super::RateCost). All tasks are weighted together, soft
/// tasks too. Required tasks on several levels are an error. [`MotionSolver`](super::MotionSolver) solves the problem.
///
/// ```
/// use kinopt::model::{Limits, Model};
/// use kinopt::motion::trajectory::{MotionProblem, MotionSolver, RateCost};
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
/// // A target with a jump in the middle, at 60 samples per second. The elbow is limited to 6 rad/s.
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
/// for pair in solved.rows().collect::<Vec<_>>().windows(2) {
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
    pub(super) follow: Vec<SetTargets>,
    /// Weights by task and sample; empty for 1 at all samples.
    pub(super) weights: Vec<Vec<f64>>,
    pub(super) rate_costs: Vec<CompiledRateCost>,
    pub(super) contacts: Vec<Contact>,
    /// Points of all contacts, as residuals to the world's origin.
    pub(super) contact_points: Option<Problem>,
    /// Weight of contact sliding and of loop closure errors, per metre.
    pub(super) stiffness: f64,
    /// Fixed variables of the first and the last sample.
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
    /// Number of samples.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// Time between samples, seconds.
    #[must_use]
    pub fn time_step_s(&self) -> f64 {
        self.time_step_s
    }

    /// Tasks of one sample, with their initial targets.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// Contacts with their spans.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// Length of a configuration.
    #[must_use]
    pub fn configuration_len(&self) -> usize {
        self.problem.configuration_len()
    }

    /// Number of variables of a sample.
    #[must_use]
    pub(super) fn variables(&self) -> usize {
        self.problem.variables()
    }

    /// Returns the equivalent of one radian for a variable.
    pub(super) fn unit(&self, variable: usize) -> f64 {
        match self.problem.names().variable_is_angle[variable] {
            true => 1.0,
            false => slide_per_radian(&self.problem),
        }
    }

    /// Returns the largest distance between samples that share a cost.
    pub(super) fn bandwidth(&self) -> usize {
        let orders = self.rate_costs.iter().map(|cost| cost.order);
        orders.fold(1, usize::max)
    }

    /// Returns the index of the first loop row. Loop rows follow those of tasks.
    #[doc(hidden)]
    pub fn task_rows(&self) -> usize {
        let tasks = self.problem.compiled_tasks().iter();
        let mut loops = tasks.filter(|task| task.is_loop);
        loops
            .next()
            .map_or(self.problem.rows(), |task| task.rows.start)
    }

    pub(super) fn has_loops(&self) -> bool {
        self.task_rows() < self.problem.rows()
    }

    /// Returns the largest loop closure error in unweighted rows, metres or radians.
    pub(super) fn max_closure_error(&self, residual: &[f64]) -> f64 {
        let errors = self.problem.errors(TaskSubset::All, residual);
        let tasks = self.problem.compiled_tasks();
        let loops = errors.filter(|block| tasks[block.task].is_loop);
        loops.map(|block| block.error).fold(0.0, f64::max)
    }

    /// Returns a task's weight at a sample.
    pub(super) fn weight(&self, task: usize, frame: usize) -> f64 {
        let weights = self
            .weights
            .get(task)
            .and_then(|weights| weights.get(frame));
        weights.copied().unwrap_or(1.0)
    }

    /// Returns whether any task has a weight other than 1 at a sample.
    pub(super) fn has_weights(&self, frame: usize) -> bool {
        (0..self.weights.len()).any(|task| self.weight(task, frame) != 1.0)
    }

    /// Sets the targets of a sample.
    pub(super) fn set_targets(&self, frame: usize, targets: &mut Targets) {
        for follow in &self.follow {
            // Cannot fail, because the problem is built with these tasks.
            let moved = follow(frame, targets);
            debug_assert!(moved.is_ok(), "a task of another problem");
        }
    }

    /// Returns for each sample of a window whether it is fixed.
    pub(super) fn fixed(&self, window: &Range<usize>, fixed_count: usize) -> Vec<bool> {
        let [first, last] = self.ends.each_ref().map(Option::is_some);
        let is_fixed = |frame: usize| {
            frame < window.start + fixed_count
                || (first && frame == 0)
                || (last && frame + 1 == self.frames)
        };
        window.clone().map(is_fixed).collect()
    }
}
