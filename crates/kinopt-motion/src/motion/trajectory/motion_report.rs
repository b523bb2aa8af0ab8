//! Report of trajectory optimisation: costs, task errors and active limits of each sample.

use std::ops::Range;
use std::sync::Arc;

use super::MotionProblem;
use super::evaluator::SampleEvaluator;
use super::interior_point::InteriorPointOutcome;
use super::stretch::SampleSpan;
use kinopt_kinematics::Trajectory;
use kinopt_solver::problem::{ReportNames, TaskSubset};
use kinopt_solver::solver::Side;
use kinopt_solver::task::{Quantity, Role};

/// Reason why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum MotionTermination {
    /// The predicted decrease is within tolerance. Contacts stay fixed, or their multiplier updates are used up.
    Stationary,
    /// No step decreased the cost.
    SmallStep,
    /// A window reached the iteration limit.
    IterationLimit,
}

/// Numbers of evaluations and factorisations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionCounts {
    /// Number of samples whose residual was evaluated.
    pub residuals: usize,
    /// Number of samples whose Jacobian was evaluated.
    pub jacobians: usize,
    /// Number of samples whose gradient was evaluated without a Jacobian.
    pub gradients: usize,
    /// Number of samples whose rows of the normal equations were factorised.
    pub factored_frames: usize,
}

/// Kind of a bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum MotionBound {
    /// Joint limit.
    Position,
    /// Velocity limit between the previous sample and this one.
    Speed,
}

/// Active limit at a sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionLimit<'a> {
    /// Name of the joint.
    pub joint: &'a str,
    /// Kind of the bound.
    pub bound: MotionBound,
    /// Lower or upper bound. For a velocity it is the sign of the motion.
    pub side: Side,
    /// Multiplier: decrease of the cost per radian or metre beyond the bound.
    pub push: f64,
}

/// Error of one task in one quantity at one sample.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionMiss<'a> {
    /// Name of the task.
    pub task: &'a str,
    /// Unit of the error.
    pub quantity: Quantity,
    /// Euclidean norm of the unweighted rows.
    pub error: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Held {
    frame: usize,
    variable: usize,
    bound: MotionBound,
    side: Side,
    push: f64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
struct Missed {
    frame: usize,
    task: usize,
    quantity: Quantity,
    error: f64,
}

/// Errors and active limits of an optimised trajectory.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionReport {
    costs: Vec<f64>,
    rates: f64,
    termination: MotionTermination,
    iterations: usize,
    counts: MotionCounts,
    slip: f64,
    loop_gap: f64,
    held: Vec<Held>,
    missed: Vec<Missed>,
    names: Arc<ReportNames>,
}

impl MotionReport {
    /// Cost ½ Σ ‖w ∘ r‖² of all tasks and rate costs.
    #[must_use]
    pub fn cost(&self) -> f64 {
        self.costs.iter().sum::<f64>() + self.rates
    }

    /// Part of the cost from velocities, accelerations and jerks.
    #[must_use]
    pub fn cost_of_rates(&self) -> f64 {
        self.rates
    }

    /// Reason why the search ended; with windows, that of a window that did not converge, if any.
    #[must_use]
    pub fn termination(&self) -> MotionTermination {
        self.termination
    }

    /// Number of iterations of all windows.
    #[must_use]
    pub fn iterations(&self) -> usize {
        self.iterations
    }

    /// Numbers of evaluations and factorisations of all windows.
    #[must_use]
    pub fn counts(&self) -> MotionCounts {
        self.counts
    }

    /// Largest distance of a contact point from its position at the start of its contact, metres.
    #[must_use]
    pub fn slip(&self) -> f64 {
        self.slip
    }

    /// Largest closure error of a loop at any sample, metres or radians.
    ///
    /// If it exceeds [`Loop::TOLERANCE`](kinopt_kinematics::model::Loop::TOLERANCE), [`missed`](Self::missed) lists the loop at
    /// those samples.
    #[must_use]
    pub fn loop_gap(&self) -> f64 {
        self.loop_gap
    }

    /// Returns whether every required task is within its tolerance at every sample.
    #[must_use]
    pub fn reached(&self) -> bool {
        self.missed.is_empty()
    }

    /// Cost ½ ‖w ∘ r‖² of a sample's tasks.
    #[must_use]
    pub fn frame_cost(&self, frame: usize) -> Option<f64> {
        self.costs.get(frame).copied()
    }

    /// Returns the required tasks with errors beyond their tolerances at a sample.
    pub fn missed(&self, frame: usize) -> impl Iterator<Item = MotionMiss<'_>> {
        let entries = entries_of_frame(&self.missed, frame, |missed| missed.frame);
        entries.iter().map(|missed| MotionMiss {
            task: self.names.tasks.get(missed.task).map_or("", String::as_str),
            quantity: missed.quantity,
            error: missed.error,
        })
    }

    /// Returns the active limits of a sample.
    pub fn active_limits(&self, frame: usize) -> impl Iterator<Item = MotionLimit<'_>> {
        let entries = entries_of_frame(&self.held, frame, |held| held.frame);
        entries.iter().map(|held| MotionLimit {
            joint: self
                .names
                .variables
                .get(held.variable)
                .map_or("", String::as_str),
            bound: held.bound,
            side: held.side,
            push: held.push,
        })
    }
}

/// Returns the entries of one sample from a list sorted by sample.
fn entries_of_frame<T>(list: &[T], frame: usize, frame_of: impl Fn(&T) -> usize) -> &[T] {
    let begin = list.partition_point(|entry| frame_of(entry) < frame);
    let end = list.partition_point(|entry| frame_of(entry) <= frame);
    &list[begin..end]
}

/// Multiplier times size, relative to the cost, below which a limit counts as inactive.
const MIN_RELATIVE_PUSH: f64 = 1e-6;

/// Collects the results of windows.
pub(super) struct WindowResults<'a> {
    motion: &'a MotionProblem,
    termination: MotionTermination,
    iterations: usize,
    held: Vec<Held>,
}

impl<'a> WindowResults<'a> {
    pub(super) fn new(motion: &'a MotionProblem) -> Self {
        Self {
            motion,
            termination: MotionTermination::Stationary,
            iterations: 0,
            held: Vec::new(),
        }
    }

    /// Adds the result of a window that begins at sample `first` and keeps the samples in `kept_frames`.
    pub(super) fn add(
        &mut self,
        outcome: &InteriorPointOutcome<'_>,
        first: usize,
        kept_frames: Range<usize>,
    ) {
        self.iterations += outcome.iterations;
        if outcome.termination != MotionTermination::Stationary {
            self.termination = outcome.termination;
        }
        let n = self.motion.variables();
        let barrier = &outcome.barrier;
        let kind = |limits_displacement: bool| match limits_displacement {
            true => MotionBound::Speed,
            false => MotionBound::Position,
        };
        // The product of slack and multiplier is nearly the same for all bounds, so one of them is small.
        let is_active = |slack: f64, push: f64, size: f64| {
            let (relative_slack, relative_push) = (slack / size, push * size / outcome.cost);
            relative_push > MIN_RELATIVE_PUSH && relative_push > relative_slack
        };
        let pairs = barrier.slacks.iter().zip(&barrier.multipliers);
        for (bound, (&slack, &push)) in barrier.bounds.iter().zip(pairs) {
            let (frame, variable) = (first + bound.index / n, bound.index % n);
            if kept_frames.contains(&frame) && is_active(slack, push, bound.size) {
                self.held.push(Held {
                    frame,
                    variable,
                    bound: kind(bound.before.is_some()),
                    side: match bound.sign > 0.0 {
                        true => Side::Upper,
                        false => Side::Lower,
                    },
                    push,
                });
            }
        }
        for (bound, slack, push) in barrier.with_lengths() {
            let (frame, limit) = (first + bound.frame, bound.limit);
            if kept_frames.contains(&frame) && is_active(slack, push, limit.max_length) {
                self.held.push(Held {
                    frame,
                    variable: limit.variables[0],
                    bound: kind(limit.limits_displacement()),
                    side: Side::Upper,
                    push,
                });
            }
        }
    }

    /// Evaluates the complete trajectory.
    pub(super) fn finish(
        mut self,
        evaluator: &mut SampleEvaluator<'_>,
        x: &[f64],
    ) -> Trajectory<MotionReport> {
        // Bounds of lengths come last within each window.
        self.held.sort_by_key(|held| held.frame);
        let motion = self.motion;
        let problem = &motion.problem;
        let counts = evaluator.counts;
        let (n, width) = (motion.variables(), motion.configuration_len());
        let mut q = vec![0.0; motion.frames * width];
        let (mut costs, mut missed) = (Vec::with_capacity(motion.frames), Vec::new());
        let mut loop_gap = 0.0_f64;
        let frames = x.chunks_exact(n).zip(q.chunks_exact_mut(width));
        for (frame, (x, q)) in frames.enumerate() {
            problem.parameters().scatter_within_limits(x, q);
            let residual = evaluator.unweighted(frame, x);
            loop_gap = loop_gap.max(motion.max_closure_error(residual));
            let errors = problem.errors(TaskSubset::All, residual);
            missed.extend(errors.filter_map(|block| {
                let is_required =
                    block.role == Role::Goal && motion.weight(block.task, frame) > 0.0;
                (is_required && !block.reached).then_some(Missed {
                    frame,
                    task: block.task,
                    quantity: block.quantity,
                    error: block.error,
                })
            }));
            costs.push(evaluator.frame_cost(frame, x)[0]);
        }
        let whole = SampleSpan {
            first: 0,
            fixed_count: 0,
        };
        let rates = evaluator.rates(whole, x);
        let slip = evaluator.contact_springs.slip(whole, x);
        let report = MotionReport {
            costs,
            rates,
            termination: self.termination,
            iterations: self.iterations,
            counts,
            slip,
            loop_gap,
            held: self.held,
            missed,
            names: Arc::clone(problem.names()),
        };
        let times = (0..motion.frames).map(|frame| frame as f64 * motion.time_step_s);
        Trajectory {
            times: times.collect(),
            q,
            nq: width,
            report,
        }
    }
}
