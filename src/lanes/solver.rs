//! The door of the engine: a chain and options in, poses solved.

use std::f64::consts::TAU;
use std::time::Instant;

use super::atlas::{Atlas, Resolution};
use super::batch::Work;
use super::chain::{Chain, JointKind, MAX_JOINTS};
use super::dispatch;
use super::judge::{self, Errors};
use super::kernel::Settings;
use super::lane::LaneScalar;
use super::links::Links;
use super::options::{LaneError, LaneOptions, Outcome, Search};
use super::race::Query;
use crate::spatial::Placement;

/// Solves poses for one chain. It never changes once built, and is `Send` and `Sync`; solving
/// allocates nothing.
///
/// Joint values are radians and metres, in the chain's order; several queries' values stand one
/// after another in one slice. Every q that comes back lies within the bounds bit for bit, and the
/// errors beside it are those of that q. Where the target is not reached q is the point of least
/// cost `½(|p|² + (metres_per_radian)² · 2(1 − cos θ))` over all attempts.
#[derive(Debug)]
pub struct PoseSolver {
    pub(crate) links: Links,
    pub(crate) settings: Settings,
    pub(crate) options: LaneOptions,
    pub(crate) atlas: Option<Atlas>,
    /// Whether the goal is not the full pose.
    pub(crate) weighted: bool,
    /// Whether some joint can turn once round.
    wide: bool,
}

impl PoseSolver {
    /// Prepares a chain: normalises it and builds the seed atlas.
    ///
    /// # Errors
    /// [`LaneError::Option`] for a tolerance, damping or weight out of range.
    pub fn new(chain: &Chain, options: LaneOptions) -> Result<Self, LaneError> {
        for (name, value) in [
            ("position_tolerance", options.position_tolerance),
            ("orientation_tolerance", options.orientation_tolerance),
            ("metres_per_radian", options.metres_per_radian),
            ("damping", options.damping),
        ] {
            if !(value.is_finite() && value > 0.0) {
                return Err(LaneError::Option(name));
            }
        }
        if !options.axes.is_valid() {
            return Err(LaneError::Option("axes"));
        }
        let weighted = !options.axes.is_full_pose();
        // Slightly inside, so that rounding in the judge's other order of operations cannot refuse.
        let margin = 0.999;
        let smaller = options
            .position_tolerance
            .min(options.orientation_tolerance * options.metres_per_radian);
        let settings = Settings {
            position_tolerance: options.position_tolerance * margin,
            orientation_tolerance: options.orientation_tolerance * margin,
            metres_per_radian: options.metres_per_radian,
            damping: options.damping,
            stall_limit: f64::from(options.stall_limit),
            axes: options.axes,
            // Convergence is quadratic: the error after a step is about its square, in metres.
            closing_cost: CLOSING * smaller,
        };
        let links = Links::new(chain);
        let atlas = if options.atlas {
            Atlas::new(&links, Resolution::default(), options.seed)
        } else {
            None
        };
        let wide = links
            .links
            .iter()
            .any(|link| link.kind == JointKind::Revolute && link.upper - link.lower >= TAU);
        Ok(Self {
            atlas,
            links,
            settings,
            options,
            weighted,
            wide,
        })
    }

    /// Number of moving joints: the length of a q.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.links.links.len()
    }

    /// Bytes the seed atlas holds.
    #[must_use]
    pub fn atlas_memory(&self) -> usize {
        self.atlas.as_ref().map_or(0, Atlas::memory)
    }

    /// Solves for one pose `base_from_target`, and writes the joint values to `q`. With a deadline
    /// it gives up between two iterations after that time; without one, the same question has the
    /// same answer bit for bit.
    ///
    /// # Errors
    /// [`LaneError`] for wrong lengths and numbers that are not finite.
    pub fn solve(
        &self,
        base_from_target: &Placement<f64>,
        start: &[f64],
        search: Search,
        deadline: Option<Instant>,
        q: &mut [f64],
    ) -> Result<Outcome, LaneError> {
        let n = self.joints();
        check_length("start", start.len(), n)?;
        check_length("q", q.len(), n)?;
        check_query(0, base_from_target, start)?;
        let query = Query {
            target: base_from_target,
            start,
            search,
            budget: self.options.total_iterations,
            deadline,
        };
        Ok(dispatch::race(self, &query, false, q))
    }

    /// As [`solve`](Self::solve) for input that is checked already. `lone` runs the start's attempt
    /// by itself first.
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn solve_checked(
        &self,
        base_from_target: &Placement<f64>,
        start: &[f64],
        search: Search,
        budget: u32,
        deadline: Option<Instant>,
        lone: bool,
        q: &mut [f64],
    ) -> Outcome {
        let query = Query {
            target: base_from_target,
            start,
            search,
            budget,
            deadline,
        };
        dispatch::race(self, &query, lone, q)
    }

    /// A solver for the same chain whose bounds may be moved, without an atlas.
    pub(crate) fn without_atlas(&self) -> Self {
        Self {
            links: self.links.clone(),
            settings: self.settings,
            options: self.options.clone(),
            atlas: None,
            weighted: self.weighted,
            wide: self.wide,
        }
    }

    /// Moves the bounds, radians or metres.
    pub(crate) fn set_bounds(&mut self, lower: &[f64], upper: &[f64]) {
        for (link, (&lower, &upper)) in self.links.links.iter_mut().zip(lower.iter().zip(upper)) {
            (link.lower, link.upper) = (lower, upper);
        }
    }

    /// Solves many poses, lanes filled with different queries. What a query gives depends on
    /// nothing but itself, so any split of a batch gives the same bits. The winner of a query is
    /// its lowest attempt that reaches.
    ///
    /// `starts` and `q` hold one q a target, `outcomes` one outcome a target.
    ///
    /// # Errors
    /// [`LaneError`] for wrong lengths and numbers that are not finite.
    pub fn solve_batch(
        &self,
        base_from_targets: &[Placement<f64>],
        starts: &[f64],
        search: Search,
        q: &mut [f64],
        outcomes: &mut [Outcome],
    ) -> Result<(), LaneError> {
        let n = self.joints();
        self.check_batch(base_from_targets, starts, q, outcomes)?;
        for (index, (target, start)) in base_from_targets
            .iter()
            .zip(starts.chunks_exact(n))
            .enumerate()
        {
            check_query(index, target, start)?;
        }
        self.run_batch(base_from_targets, starts, search, q, outcomes);
        Ok(())
    }

    /// [`solve_batch`](Self::solve_batch) over the threads of the current rayon pool.
    ///
    /// # Errors
    /// As there.
    #[cfg(feature = "rayon")]
    pub fn solve_batch_parallel(
        &self,
        base_from_targets: &[Placement<f64>],
        starts: &[f64],
        search: Search,
        q: &mut [f64],
        outcomes: &mut [Outcome],
    ) -> Result<(), LaneError> {
        use rayon::prelude::*;
        /// Queries a task: enough to keep the lanes filled.
        const CHUNK: usize = 128;
        let n = self.joints();
        self.check_batch(base_from_targets, starts, q, outcomes)?;
        for (index, (target, start)) in base_from_targets
            .iter()
            .zip(starts.chunks_exact(n))
            .enumerate()
        {
            check_query(index, target, start)?;
        }
        base_from_targets
            .par_chunks(CHUNK)
            .zip(starts.par_chunks(CHUNK * n))
            .zip(q.par_chunks_mut(CHUNK * n))
            .zip(outcomes.par_chunks_mut(CHUNK))
            .for_each(|(((targets, starts), q), outcomes)| {
                self.run_batch(targets, starts, search, q, outcomes);
            });
        Ok(())
    }

    /// Runs attempts `first`, `first + 1`, … of one query, as many as `outcomes` has places, and
    /// hands out what each gave: the ground for searches that compare solutions. Attempt numbers
    /// mean the same as in [`solve`](Self::solve): under [`Search::Start`] 0 is the start, then
    /// come the atlas's seeds, then random ones; under [`Search::First`] the atlas's come first.
    ///
    /// # Errors
    /// [`LaneError`] for wrong lengths and numbers that are not finite.
    pub fn run_attempts(
        &self,
        base_from_target: &Placement<f64>,
        start: &[f64],
        search: Search,
        first: u32,
        q: &mut [f64],
        outcomes: &mut [Outcome],
    ) -> Result<(), LaneError> {
        let n = self.joints();
        check_length("start", start.len(), n)?;
        check_length("q", q.len(), n * outcomes.len())?;
        check_query(0, base_from_target, start)?;
        self.run_attempts_checked(base_from_target, start, search, first, q, outcomes);
        Ok(())
    }

    /// As [`run_attempts`](Self::run_attempts) for input that is checked already.
    pub(crate) fn run_attempts_checked(
        &self,
        base_from_target: &Placement<f64>,
        start: &[f64],
        search: Search,
        first: u32,
        q: &mut [f64],
        outcomes: &mut [Outcome],
    ) {
        let work = Work {
            targets: std::slice::from_ref(base_from_target),
            starts: start,
            search,
            attempts_from: Some(first),
            q,
            outcomes,
        };
        dispatch::batch(self, work);
    }

    /// Follows a path of targets: each query starts from the q of the one before, and takes that
    /// attempt's solution where it succeeds ([`Search::Start`]).
    ///
    /// # Errors
    /// [`LaneError`] for wrong lengths and numbers that are not finite.
    pub fn track(
        &self,
        base_from_targets: &[Placement<f64>],
        start: &[f64],
        q: &mut [f64],
        outcomes: &mut [Outcome],
    ) -> Result<(), LaneError> {
        let n = self.joints();
        check_length("start", start.len(), n)?;
        check_length("q", q.len(), n * base_from_targets.len())?;
        check_length("outcomes", outcomes.len(), base_from_targets.len())?;
        for (index, target) in base_from_targets.iter().enumerate() {
            check_query(index, target, start)?;
        }
        let mut last = [0.0; MAX_JOINTS];
        last[..n].copy_from_slice(start);
        let steps = base_from_targets
            .iter()
            .zip(q.chunks_exact_mut(n))
            .zip(outcomes);
        for ((target, q), outcome) in steps {
            let query = Query {
                target,
                start: &last[..n],
                search: Search::Start,
                budget: self.options.total_iterations,
                deadline: None,
            };
            *outcome = dispatch::race(self, &query, true, q);
            last[..n].copy_from_slice(q);
        }
        Ok(())
    }

    /// As [`solve_batch`](Self::solve_batch) for input that is checked already.
    pub(crate) fn run_batch(
        &self,
        targets: &[Placement<f64>],
        starts: &[f64],
        search: Search,
        q: &mut [f64],
        outcomes: &mut [Outcome],
    ) {
        let work = Work {
            targets,
            starts,
            search,
            attempts_from: None,
            q,
            outcomes,
        };
        dispatch::batch(self, work);
    }

    fn check_batch(
        &self,
        targets: &[Placement<f64>],
        starts: &[f64],
        q: &[f64],
        outcomes: &[Outcome],
    ) -> Result<(), LaneError> {
        let n = self.joints();
        check_length("starts", starts.len(), n * targets.len())?;
        check_length("q", q.len(), n * targets.len())?;
        check_length("outcomes", outcomes.len(), targets.len())
    }

    /// Judges a q that is to be returned.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn judge<V: LaneScalar, const N: usize, const AXES: bool>(
        &self,
        goal_from_first: &Placement<f64>,
        q: &[f64],
    ) -> (bool, Errors) {
        let errors = judge::errors::<V, N, AXES>(&self.links, &self.settings, goal_from_first, q);
        let reached = errors.position <= self.options.position_tolerance
            && errors.orientation <= self.options.orientation_tolerance;
        (reached, errors)
    }

    /// Adds whole turns to the joints that can make them, as near to the start as bounds allow.
    #[cfg_attr(not(debug_assertions), inline(always))]
    pub(crate) fn unwrap_towards(&self, start: &[f64], q: &mut [f64]) {
        if !self.wide {
            return;
        }
        for ((q, link), start) in q.iter_mut().zip(&self.links.links).zip(start) {
            if link.kind == JointKind::Revolute && link.upper - link.lower >= TAU {
                let lowest = ((link.lower - *q) / TAU).ceil();
                let highest = ((link.upper - *q) / TAU).floor();
                let turns = ((start - *q) / TAU).round().min(highest).max(lowest);
                let turned = *q + turns * TAU;
                if link.lower <= turned && turned <= link.upper {
                    *q = turned;
                }
            }
        }
    }
}

/// One more step is trusted to reach below twice the cost of this times the tolerance, metres.
const CLOSING: f64 = 0.1;

fn check_length(what: &'static str, found: usize, expected: usize) -> Result<(), LaneError> {
    if found == expected {
        Ok(())
    } else {
        Err(LaneError::Length {
            what,
            found,
            expected,
        })
    }
}

fn check_query(index: usize, target: &Placement<f64>, start: &[f64]) -> Result<(), LaneError> {
    if !start.iter().all(|value| value.is_finite()) {
        return Err(LaneError::Start(index));
    }
    if !super::chain::is_rigid(target) {
        return Err(LaneError::Target(index));
    }
    Ok(())
}
