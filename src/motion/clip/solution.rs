//! What came of a motion: where it goes, what it misses in which frame, and which limits are in its way.

use std::ops::Range;
use std::sync::Arc;

use super::MotionProblem;
use super::evaluator::{Evaluator, Stretch};
use super::interior_point::Outcome;
use crate::problem::{ReportNames, Share};
use crate::solver::Side;
use crate::task::{Quantity, Role};

/// Why a motion's search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum MotionTermination {
    /// Nothing more is to be won within the tolerance, and what is held stands still.
    Stationary,
    /// No step won anything.
    SmallStep,
    /// Too many iterations in some window.
    IterationLimit,
}

/// How often a motion's parts were evaluated and factorised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionCounts {
    /// Frames whose residual was evaluated.
    pub residuals: usize,
    /// Frames whose Jacobian was.
    pub jacobians: usize,
    /// Frames whose gradient was, by itself.
    pub gradients: usize,
    /// Frames whose rows of the normal equations were factorised.
    pub factored_frames: usize,
}

/// Whose bound it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum MotionBound {
    /// The joint's own limit.
    Position,
    /// Its speed, from the frame before to this one.
    Speed,
}

/// A limit that holds a motion back in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionLimit<'a> {
    /// The joint's name.
    pub joint: &'a str,
    /// What is limited.
    pub bound: MotionBound,
    /// Which end: of a speed, whether it falls or rises.
    pub side: Side,
    /// How fast the cost would fall beyond it, per radian or metre.
    pub push: f64,
}

/// The error of one task's rows of one quantity in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct MotionMiss<'a> {
    /// The task's name.
    pub task: &'a str,
    /// The unit of the error.
    pub quantity: Quantity,
    /// Euclidean norm of the rows, whatever their weight.
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

/// A motion, and the truth about it.
#[derive(Clone, Debug)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub struct MotionSolution {
    q: Vec<f64>,
    configuration_len: usize,
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

impl MotionSolution {
    getters! {
        /// All configurations, frame after frame, within all limits of position and speed, to the bit.
        pub fn q(&self) -> &[f64] = &self.q;
        /// How many frames there are.
        pub fn frames(&self) -> usize = self.costs.len();
        /// ½ Σ ‖w ∘ r‖² of all tasks and rate costs.
        pub fn cost(&self) -> f64 = self.costs.iter().sum::<f64>() + self.rates;
        /// What of the cost is of velocities, accelerations and jerks.
        pub fn cost_of_rates(&self) -> f64 = self.rates;
        /// Why the search ended; of windows, why that of the worst did.
        pub fn termination(&self) -> MotionTermination = self.termination;
        /// Iterations of all windows.
        pub fn iterations(&self) -> usize = self.iterations;
        /// Evaluations and factorisations of all windows.
        pub fn counts(&self) -> MotionCounts = self.counts;
        /// How far a point that is held still is from where its contact began, at most, in metres.
        pub fn slip(&self) -> f64 = self.slip;
        /// How far a loop of the model is open in any frame, at most, in metres and radians: within
        /// [`Loop::TOLERANCE`](crate::model::Loop::TOLERANCE), or the frames that leave it open name it among what they miss.
        pub fn loop_gap(&self) -> f64 = self.loop_gap;
        /// Whether every goal is within its tolerance in every frame.
        pub fn reached(&self) -> bool = self.missed.is_empty();
        /// ½ ‖w ∘ r‖² of a frame's tasks.
        pub fn frame_cost(&self, frame: usize) -> Option<f64> = self.costs.get(frame).copied();
    }

    /// The configuration of a frame.
    #[must_use]
    pub fn frame(&self, frame: usize) -> Option<&[f64]> {
        let n = self.configuration_len;
        self.q.get(frame * n..(frame + 1) * n)
    }

    /// The goals that a frame misses, beyond their tolerances.
    pub fn missed(&self, frame: usize) -> impl Iterator<Item = MotionMiss<'_>> {
        let own = of_frame(&self.missed, frame, |missed| missed.frame);
        own.iter().map(|missed| MotionMiss {
            task: self.names.tasks.get(missed.task).map_or("", String::as_str),
            quantity: missed.quantity,
            error: missed.error,
        })
    }

    /// The limits that hold a frame back.
    pub fn active_limits(&self, frame: usize) -> impl Iterator<Item = MotionLimit<'_>> {
        let own = of_frame(&self.held, frame, |held| held.frame);
        own.iter().map(|held| MotionLimit {
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

/// The part of a list in order of frames that is of one.
fn of_frame<T>(list: &[T], frame: usize, of: impl Fn(&T) -> usize) -> &[T] {
    let begin = list.partition_point(|own| of(own) < frame);
    let end = list.partition_point(|own| of(own) <= frame);
    &list[begin..end]
}

/// A push that would win less than this share of the cost over the whole room of its bound is none.
const NEGLIGIBLE: f64 = 1e-6;

/// Collects what windows come to.
pub(super) struct Report<'a> {
    motion: &'a MotionProblem,
    termination: MotionTermination,
    iterations: usize,
    held: Vec<Held>,
}

impl<'a> Report<'a> {
    pub(super) fn new(motion: &'a MotionProblem) -> Self {
        Self {
            motion,
            termination: MotionTermination::Stationary,
            iterations: 0,
            held: Vec::new(),
        }
    }

    /// Takes the outcome of a window whose first frame is `first`, and of which some frames are kept.
    pub(super) fn take(&mut self, outcome: &Outcome<'_>, first: usize, kept: Range<usize>) {
        self.iterations += outcome.iterations;
        if outcome.termination != MotionTermination::Stationary {
            self.termination = outcome.termination;
        }
        let n = self.motion.variables();
        let barrier = &outcome.barrier;
        let kind = |is_of_move: bool| match is_of_move {
            true => MotionBound::Speed,
            false => MotionBound::Position,
        };
        // The product of slack and push is nearly the same for all: one of them is small.
        let holds = |slack: f64, push: f64, size: f64| {
            let (room_left, pushed) = (slack / size, push * size / outcome.cost);
            pushed > NEGLIGIBLE && pushed > room_left
        };
        let pairs = barrier.slacks.iter().zip(&barrier.multipliers);
        for (bound, (&slack, &push)) in barrier.bounds.iter().zip(pairs) {
            let (frame, variable) = (first + bound.at / n, bound.at % n);
            if kept.contains(&frame) && holds(slack, push, bound.size) {
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
            if kept.contains(&frame) && holds(slack, push, limit.most) {
                self.held.push(Held {
                    frame,
                    variable: limit.variables[0],
                    bound: kind(limit.is_of_move()),
                    side: Side::Upper,
                    push,
                });
            }
        }
    }

    /// Measures the whole.
    pub(super) fn finish(mut self, evaluator: &mut Evaluator<'_>, x: &[f64]) -> MotionSolution {
        // Of each window those of lengths come last.
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
            let residual = evaluator.unweighed(frame, x);
            loop_gap = loop_gap.max(motion.open_by(residual));
            let errors = problem.errors(Share::All, residual);
            missed.extend(errors.filter_map(|block| {
                let asked = block.role == Role::Goal && motion.weight(block.task, frame) > 0.0;
                (asked && !block.reached).then_some(Missed {
                    frame,
                    task: block.task,
                    quantity: block.quantity,
                    error: block.error,
                })
            }));
            costs.push(evaluator.frame_cost(frame, x)[0]);
        }
        let all = Stretch { first: 0, held: 0 };
        let rates = evaluator.rates(all, x);
        let slip = evaluator.held.slip(all, x);
        MotionSolution {
            q,
            configuration_len: width,
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
        }
    }
}
