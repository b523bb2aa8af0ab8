//! The door of the engine: a chain and options in, poses solved.

use std::time::Instant;

use super::atlas::{Atlas, Resolution};
use super::chain::Chain;
use super::dispatch;
use super::judge::{self, Errors};
use super::lane::LaneScalar;
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
    pub(crate) fn deadline_passed(&self) -> bool {
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
    pub(crate) settings: Settings,
    pub(crate) options: LaneOptions,
    pub(crate) atlas: Option<Atlas>,
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
            closing_cost: std::env::var("CLOSE").ok().and_then(|v| v.parse().ok()).unwrap_or(0.1)
                * options.position_tolerance.min(options.orientation_tolerance * options.metres_per_radian),
        };
        let links = Links::new(chain);
        let env = |n: &str, d: usize| std::env::var(n).ok().and_then(|v| v.parse().ok()).unwrap_or(d);
        let resolution = Resolution { radius: env("AR", 8), height: env("AH", 12), direction: env("AD", 8), samples: env("AS", 16) };
        let atlas = if env("AR", 8) == 0 { None } else { Atlas::new(&links, resolution, options.seed) };
        Self {
            atlas,
            links,
            settings,
            options,
        }
    }

    /// Bytes of the seed atlas.
    #[must_use]
    pub fn atlas_memory(&self) -> usize {
        self.atlas.as_ref().map_or(0, Atlas::memory)
    }

    /// Solves one pose.
    pub fn solve(
        &self,
        target: &Placement<f64>,
        start: &[f64],
        search: Search,
        q: &mut [f64],
    ) -> Outcome {
        dispatch::race(self, &Query { target, start, search }, false, q)
    }

    /// Solves many poses.
    pub fn solve_batch(
        &self,
        targets: &[Placement<f64>],
        starts: &[f64],
        search: Search,
        q: &mut [f64],
        outcomes: &mut [Outcome],
    ) {
        dispatch::batch(self, (targets, starts, search, q, outcomes));
    }

    /// Follows a path of targets.
    pub fn track(
        &self,
        path: &[Placement<f64>],
        start: &[f64],
        q: &mut [f64],
        outcomes: &mut [Outcome],
    ) {
        let n = self.links.links.len();
        let mut last = [0.0; super::chain::MAX_JOINTS];
        last[..n].copy_from_slice(&start[..n]);
        for ((target, q), outcome) in path.iter().zip(q.chunks_exact_mut(n)).zip(outcomes) {
            let query = Query { target, start: &last[..n], search: Search::Start };
            *outcome = dispatch::race(self, &query, true, q);
            last[..n].copy_from_slice(q);
        }
    }

    /// Brings `q` to the form in which it is returned, and judges it there.
    #[inline(always)]
    pub(crate) fn judge<V: LaneScalar>(
        &self,
        goal_from_first: &Placement<f64>,
        q: &[f64],
    ) -> (bool, Errors) {
        let errors = judge::errors::<V>(&self.links, goal_from_first, q);
        let reached = errors.position <= self.options.position_tolerance
            && errors.orientation <= self.options.orientation_tolerance;
        (reached, errors)
    }
}
