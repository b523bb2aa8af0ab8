//! The loop of the geometric methods: sweep, evaluate, stop.

use crate::ik::{Restarts, Solution};
use crate::problem::{Evaluation, ProblemInstance, Scratch, TaskSubset};
use crate::search::{Attempts, End, Engine, Schedule, SearchResult, SolveError, run, variables_at};
use crate::solver::{
    Counts, Iteration, LeastSquares, Observer, SolverState, Stopping, Termination, half_squared,
};
use kinopt_kinematics::clock::{Instant, is_past};

/// Relative decrease of the cost below which a sweep counts as flat.
const MAX_FLAT_DECREASE: f64 = 1e-13;
/// Number of consecutive flat sweeps after which an attempt ends.
const MAX_FLAT_SWEEPS: usize = 5;

/// One geometric method applied to one problem.
pub(super) trait Sweep {
    /// Starts at a new start within the bounds.
    fn begin(&mut self, _x: &[f64]) {}

    /// True if the start itself may be the solution. False for methods that guarantee more than their targets, such as
    /// an elbow's side.
    fn accepts_start(&self) -> bool {
        true
    }

    /// Moves the variables once, from bounds to within bounds.
    fn sweep(&mut self, x: &mut [f64]);
}

/// Limits of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Limits {
    pub(super) stopping: Stopping,
    pub(super) restarts: Restarts,
}

impl Default for Limits {
    /// More iterations than an optimiser has, because sweeps are cheap and each gains little, and an end if they stall.
    fn default() -> Self {
        let stopping = Stopping::default().with_max_iterations(500);
        Self {
            stopping: stopping.with_patience(Some(60)),
            restarts: Restarts::default().with_steps(2000),
        }
    }
}

/// Searches from the configuration `start`, which is projected into the limits.
///
/// A search that stopped at a stationary point ends as stationary.
pub(super) fn solve(
    instance: ProblemInstance<'_>,
    start: &[f64],
    limits: Limits,
    method: &mut dyn Sweep,
    observer: &mut dyn Observer,
) -> Result<Solution, SolveError> {
    let Limits { stopping, restarts } = limits;
    stopping.check().map_err(SolveError::from)?;
    restarts.check().map_err(SolveError::from)?;
    let mut search = Attempts::default();
    search.start = variables_at(instance, start)?;
    search.fit(instance, TaskSubset::All);
    let deadline = stopping.deadline();
    let mut sweeps = Sweeps::new(instance, &search.start, method, observer, deadline);
    let schedule = Schedule::of_sweeps(instance, restarts, stopping);
    let result = run(
        instance,
        TaskSubset::All,
        &schedule,
        deadline,
        &mut sweeps,
        &mut search,
    );
    let mut solution = Solution::default();
    solution.record(&result);
    let end = End {
        question: instance,
        x: &search.keeper.x,
        share: TaskSubset::All,
        searched: &search.keeper.residual,
        residual: &search.keeper.residual,
    };
    let mut scratch = sweeps.scratch;
    let slope = solution.measure(&end, &stopping, &mut scratch, &mut SolverState::default());
    let is_level = slope.is_some_and(|slope| slope.is_level);
    if is_level && solution.termination == Termination::SmallStep {
        solution.termination = Termination::Stationary;
    }
    solution.check_collisions(instance);
    Ok(solution)
}

/// A geometric method as an engine of the search.
struct Sweeps<'a> {
    instance: ProblemInstance<'a>,
    method: &'a mut dyn Sweep,
    observer: &'a mut dyn Observer,
    deadline: Option<Instant>,
    scratch: Scratch,
    counts: Counts,
    residual_at_start: Vec<f64>,
    /// Variables after the last sweep; those before it follow.
    x: Vec<f64>,
    previous: Vec<f64>,
    residual: Vec<f64>,
    /// Variables of lowest cost, with their residual.
    best_x: Vec<f64>,
    best_residual: Vec<f64>,
}

impl<'a> Sweeps<'a> {
    fn new(
        instance: ProblemInstance<'a>,
        start: &[f64],
        method: &'a mut dyn Sweep,
        observer: &'a mut dyn Observer,
        deadline: Option<Instant>,
    ) -> Self {
        let rows = vec![0.0; instance.rows()];
        let mut sweeps = Self {
            instance,
            method,
            observer,
            deadline,
            scratch: instance.scratch(),
            counts: Counts::default(),
            residual_at_start: rows.clone(),
            x: start.to_vec(),
            previous: start.to_vec(),
            residual: rows.clone(),
            best_x: start.to_vec(),
            best_residual: rows,
        };
        sweeps.evaluate();
        sweeps.residual_at_start.copy_from_slice(&sweeps.residual);
        sweeps
    }

    /// Updates the residual at the present variables and returns the cost.
    fn evaluate(&mut self) -> f64 {
        let mut evaluation = Evaluation::new(self.instance, &mut self.scratch);
        evaluation.residual(&self.x, &mut self.residual);
        self.counts.residuals += 1;
        half_squared(&self.residual)
    }

    fn keep_best(&mut self) {
        self.best_x.copy_from_slice(&self.x);
        self.best_residual.copy_from_slice(&self.residual);
    }

    /// True if the last sweep moved no variable by more than tolerance · max(1, |x|).
    fn is_still(&self, tolerance: f64) -> bool {
        let mut pairs = self.x.iter().zip(&self.previous);
        pairs.all(|(a, b)| (a - b).abs() - tolerance * a.abs().max(1.0) <= 0.0)
    }
}

impl Engine for Sweeps<'_> {
    fn residual_at_start(&mut self, _start: &[f64]) -> &[f64] {
        &self.residual_at_start
    }

    fn end(&self) -> (&[f64], &[f64]) {
        (&self.best_x, &self.best_residual)
    }

    /// Returns the variables of lowest cost, because not every sweep decreases it.
    fn attempt(&mut self, start: &[f64], stopping: &Stopping) -> SearchResult {
        let instance = self.instance;
        self.x.copy_from_slice(start);
        instance.space().project(&mut self.x);
        let (mut best_cost, mut reached) = (f64::INFINITY, false);
        let (mut index, mut step, mut flat_sweeps) = (0, 0.0, 0);
        let mut milestone = (0, f64::INFINITY);
        self.method.begin(&self.x);
        let termination = loop {
            let cost = self.evaluate();
            if index == 0 {
                self.keep_best();
            }
            if !cost.is_finite() {
                best_cost = if index == 0 { cost } else { best_cost };
                break Termination::NonFinite;
            }
            let is_reached = instance
                .problem
                .is_reached_by(TaskSubset::All, &self.residual);
            let is_flat = best_cost - cost <= MAX_FLAT_DECREASE * cost;
            flat_sweeps = if is_flat { flat_sweeps + 1 } else { 0 };
            let may_be_best = index > 0 || self.method.accepts_start();
            if may_be_best && (cost < best_cost || is_reached) {
                self.keep_best();
                (best_cost, reached) = (cost, is_reached);
            }
            let observation = self.observer.observe(&Iteration {
                index,
                cost,
                projected_gradient: None,
                step,
                control: 0.0,
                x: &self.x,
            });
            if cost < 0.5 * milestone.1 {
                milestone = (index, cost);
            }
            let sweeps_since_milestone = index - milestone.0;
            let is_still = index > 0 && self.is_still(stopping.step_tolerance());
            if reached {
                break Termination::Reached;
            }
            if observation.is_break() {
                break Termination::Cancelled;
            }
            if is_still || flat_sweeps >= MAX_FLAT_SWEEPS {
                break Termination::SmallStep;
            }
            if stopping
                .patience()
                .is_some_and(|patience| sweeps_since_milestone >= patience)
            {
                break Termination::Stalled;
            }
            if index >= stopping.max_iterations() {
                break Termination::IterationLimit;
            }
            if is_past(self.deadline) {
                break Termination::TimeLimit;
            }
            self.previous.copy_from_slice(&self.x);
            self.method.sweep(&mut self.x);
            step = largest_move(&self.x, &self.previous);
            index += 1;
        };
        SearchResult {
            cost: best_cost,
            reached,
            counts: std::mem::take(&mut self.counts),
            ..SearchResult::single_attempt(termination, index)
        }
    }
}

/// ‖x − previous‖∞.
fn largest_move(x: &[f64], previous: &[f64]) -> f64 {
    let displacements = x.iter().zip(previous).map(|(a, b)| (a - b).abs());
    displacements.fold(0.0, f64::max)
}
