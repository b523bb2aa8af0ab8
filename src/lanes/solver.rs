//! The door of the engine: a chain and options in, poses solved.

use std::time::Instant;

use super::chain::Chain;
use super::dispatch;
use super::judge::Judge;
use super::kernel::Settings;
use super::links::Links;
use super::race::Query;
use crate::spatial::Placement;

/// Which of several solutions is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Search {
    /// The one from the start, if that attempt succeeds; others only rescue it.
    #[default]
    Start,
    /// Whichever is found first, in iterations.
    First,
}

/// Options of a [`PoseSolver`].
#[derive(Clone, Debug)]
pub struct LaneOptions {
    /// Metres.
    pub position_tolerance: f64,
    /// Radians.
    pub orientation_tolerance: f64,
    /// Metres that weigh as much as one radian.
    pub metres_per_radian: f64,
    /// Initial damping.
    pub damping: f64,
    /// Stall limit.
    pub stall_limit: u32,
    /// Most iterations an attempt.
    pub iterations: u32,
    /// Most attempts.
    pub attempts: u32,
    /// Seed of random restarts.
    pub seed: u64,
    /// Deadline.
    pub deadline: Option<Instant>,
}

impl Default for LaneOptions {
    fn default() -> Self {
        Self {
            position_tolerance: 1e-6,
            orientation_tolerance: 1e-6,
            metres_per_radian: 0.3,
            damping: 0.07,
            stall_limit: 4,
            iterations: 60,
            attempts: 200,
            seed: 0,
            deadline: None,
        }
    }
}

impl LaneOptions {
    pub(crate) fn deadline_passed(&self, _search: Search, _steps: u32) -> bool {
        self.deadline.is_some_and(|at| Instant::now() >= at)
    }
}

/// How a query ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Within both tolerances.
    pub reached: bool,
    /// Distance of the tip from the target, metres.
    pub position_error: f64,
    /// Angle between tip and target, radians.
    pub orientation_error: f64,
    /// Iterations of all attempts.
    pub iterations: u32,
    /// Attempts begun.
    pub attempts: u32,
    /// The attempt that reached.
    pub attempt: Option<u32>,
}

/// Solves poses for one chain.
#[derive(Debug)]
pub struct PoseSolver {
    pub(crate) links: Links,
    pub(crate) judge: Judge,
    pub(crate) settings: Settings,
    pub(crate) options: LaneOptions,
}

impl PoseSolver {
    /// Prepares a chain.
    #[must_use]
    pub fn new(chain: &Chain, options: LaneOptions) -> Self {
        let settings = Settings {
            position_tolerance: options.position_tolerance * 0.999,
            orientation_tolerance: options.orientation_tolerance * 0.999,
            metres_per_radian: options.metres_per_radian,
            damping: options.damping,
            stall_limit: f64::from(options.stall_limit),
        };
        Self {
            links: Links::new(chain),
            judge: Judge::new(chain),
            settings,
            options,
        }
    }

    /// Solves one pose.
    pub fn solve(
        &self,
        target: &Placement<f64>,
        start: &[f64],
        search: Search,
        q: &mut [f64],
    ) -> Outcome {
        dispatch::race(self, &Query { target, start, search }, q)
    }

    #[inline(always)]
    pub(crate) fn finish(
        &self,
        query: &Query<'_>,
        q: &mut [f64],
        iterations: u32,
        attempt: Option<u32>,
        attempts: u32,
    ) -> Outcome {
        let (position_error, orientation_error) = self.judge.errors(query.target, q);
        Outcome {
            reached: position_error <= self.options.position_tolerance
                && orientation_error <= self.options.orientation_tolerance,
            position_error,
            orientation_error,
            iterations,
            attempts,
            attempt,
        }
    }
}
