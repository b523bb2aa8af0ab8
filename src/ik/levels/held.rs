//! What a descent holds: the ranks above the one that it is of, where their own searches left them.
//!
//! A rank that is reached is held by its rows: J Δ = 0, and Newton's method brings back what a step's square
//! has moved. A rank that is missed stands at the lowest cost that the ranks above it leave. There its rows
//! lose rank where a limb is stretched, though bending it would cost, so the [curvature](super::curvature) of its
//! cost takes the place of its Jacobian: a step that keeps the cost's slope at zero keeps the cost.

use nalgebra::DMatrix;

use super::asked::Asked;
use super::curvature::{Curvature, NEW, NEW_CURVATURE, add_rows};
use super::edges::Edges;
use crate::problem::{Evaluation, Problem, Share};
use crate::solver::{
    AnyMethod, HeldStep, LevenbergMarquardt, RowSpan, Silent, StepBounds, half_squared,
    negligible_slope,
};

/// Corrections back after a step.
const CORRECTIONS: usize = 6;
/// Steps of a missed first rank's own search after one.
const SETTLING: usize = 20;
/// Places tried along a step that leads out of a room, until one is at its edge.
const LANDINGS: usize = 60;
/// How much of a missed rank's cost counts as the same.
pub(super) const SAME_MISS: f64 = 1e-9;
/// What a descent gains at least, as a share of its cost, for a step to make sense.
const WORTHWHILE: f64 = 1e-9;
/// The same below a miss, where what is held is known to fewer digits.
const WORTHWHILE_BELOW_A_MISS: f64 = 1e-7;

/// How the ranks above came out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Above {
    /// All are reached.
    #[default]
    Reached,
    /// There is one, and it is missed.
    FirstMissed,
    /// Some are reached, some missed.
    Mixed,
}

/// A rank that is held.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeldRank {
    pub(super) rank: usize,
    pub(super) reached: bool,
    /// ½‖r‖² where its own search left it.
    pub(super) cost: f64,
}

/// Whether a row of the ranks above one is of one that is reached.
pub(super) fn is_of_reached(problem: &Problem, ranks: &[HeldRank], row: usize) -> bool {
    let mut reached = ranks.iter().filter(|held| held.reached);
    reached.any(|held| problem.ranks().rows_of(held.rank).contains(&row))
}

/// The ranks above one, and room to keep them where they are.
#[derive(Clone, Debug, Default)]
pub(super) struct Held {
    ranks: Vec<HeldRank>,
    above: Above,
    /// Their residual where their searches ended, and at a trial.
    kept: Vec<f64>,
    now: Vec<f64>,
    jacobian: DMatrix<f64>,
    curvature: Curvature,
    edges: Edges,
    /// Where a correction starts, and the correction.
    uncorrected: Vec<f64>,
    back: Vec<f64>,
}

impl Held {
    /// Makes room for the ranks above one; how many rows it may hold.
    pub(super) fn fit(&mut self, problem: &Problem, rank: usize) -> usize {
        let n = problem.variables();
        let rows = problem.rows_of(Share::above(rank));
        self.kept.resize(rows, 0.0);
        self.now.resize(rows, 0.0);
        self.uncorrected.resize(n, 0.0);
        self.back.resize(n, 0.0);
        if self.jacobian.shape() != (rows, n) {
            self.jacobian = DMatrix::zeros(rows, n);
        }
        self.ranks.clear();
        self.ranks.reserve(rank);
        rows.max(self.curvature.fit(problem, rank))
    }

    fn share(&self) -> Share {
        Share::above(self.ranks.len())
    }

    /// What a descent gains at least, as a share of its cost, for a step to make sense.
    pub(super) fn worthwhile(&self) -> f64 {
        match self.above {
            Above::Reached => WORTHWHILE,
            Above::FirstMissed | Above::Mixed => WORTHWHILE_BELOW_A_MISS,
        }
    }

    /// Holds the ranks above `rank` where they are at x, by their residual there, and fixes the variables that
    /// stand on a bound for a missed one's sake. Whether all are reached.
    pub(super) fn take(
        &mut self,
        asked: &mut Asked<'_, '_>,
        rank: usize,
        x: &[f64],
        residual: &[f64],
        fixed: &mut [bool],
    ) -> bool {
        let problem = asked.question.problem;
        self.kept.copy_from_slice(residual);
        self.ranks.clear();
        self.ranks.extend((0..rank).map(|rank| {
            let own = &residual[problem.ranks().rows_of(rank)];
            let binds = rank < problem.ranks().levels();
            HeldRank {
                rank,
                reached: binds && problem.is_reached_by(Share::rank(rank), own),
                cost: half_squared(own),
            }
        }));
        let missed = self.ranks.iter().filter(|rank| !rank.reached).count();
        self.above = match missed {
            0 => Above::Reached,
            1 if rank == 1 => Above::FirstMissed,
            _ => Above::Mixed,
        };
        self.edges.take(asked.question, &self.ranks, residual.len());
        fixed.fill(false);
        match self.above {
            Above::Reached => {}
            Above::FirstMissed => self.fix_for_a_missed_first(asked, x, fixed),
            Above::Mixed => {
                let share = self.share();
                asked.held_jacobian(share, x, &mut self.jacobian);
                self.curvature
                    .fix(asked, &self.ranks, x, &self.jacobian, &self.kept, fixed);
            }
        }
        self.above == Above::Reached
    }

    /// Holds the first rows at these values; what they were held at.
    pub(super) fn keep(&mut self, values: &[f64]) -> Vec<f64> {
        let own = &mut self.kept[..values.len()];
        let before = own.to_vec();
        own.copy_from_slice(values);
        before
    }

    fn fix_for_a_missed_first(&mut self, asked: &mut Asked<'_, '_>, x: &[f64], fixed: &mut [bool]) {
        let share = self.share();
        let mut goals = Evaluation::of(share, asked.question, asked.scratch);
        let (slope, column_norm) = asked.memory.slope_at(&mut goals, x, &self.kept);
        let cost = half_squared(&self.kept);
        let negligible = negligible_slope(column_norm, cost, &asked.stopping);
        for (j, fixed) in fixed.iter_mut().enumerate() {
            *fixed = asked.question.space().holds(x, j, slope[j], negligible);
        }
    }

    /// Takes C, for steps from x with C Δ = 0.
    pub(super) fn take_rows(&mut self, asked: &mut Asked<'_, '_>, x: &[f64], fixed: &[bool]) {
        self.edges.hold_all();
        let share = self.share();
        if self.above == Above::FirstMissed {
            return self.curvature.of_first(asked, x, &[]);
        }
        asked.held_jacobian(share, x, &mut self.jacobian);
        if self.above == Above::Mixed || self.edges.any() {
            asked.residual(share, x, &mut self.now);
        }
        self.take_curvature(asked, x, fixed);
    }

    /// Whether anything that is held may have an edge.
    pub(super) fn has_edges(&self) -> bool {
        self.above != Above::FirstMissed && self.edges.any()
    }

    /// The rows of missed ranks below reached ones.
    fn take_curvature(&mut self, asked: &mut Asked<'_, '_>, x: &[f64], fixed: &[bool]) {
        if self.above == Above::Mixed {
            let here = (&self.jacobian, &self.now[..]);
            self.curvature.of_all(asked, &self.ranks, x, here, fixed);
        }
    }

    /// Takes a row out of C that stands at the edge of its room while the multipliers of the rows pull it inward, and
    /// no missed rank pushes it outward; whether there was one.
    pub(super) fn let_go(
        &mut self,
        asked: &mut Asked<'_, '_>,
        x: &[f64],
        fixed: &[bool],
        multipliers: &[f64],
    ) -> bool {
        if !self.has_edges() {
            return false;
        }
        let Self {
            ranks,
            above,
            edges,
            curvature,
            jacobian,
            now,
            ..
        } = self;
        let multiplier = |row: usize| match *above == Above::Mixed && curvature.weighs(ranks, row) {
            true => 0.0,
            false => multipliers[row],
        };
        let lets = edges.let_go(asked, ranks, x, (jacobian, now), multiplier);
        if lets {
            edges.take_out(jacobian);
            self.take_curvature(asked, x, fixed);
        }
        lets
    }

    /// C as it was taken last.
    pub(super) fn rows(&self) -> &DMatrix<f64> {
        match self.above {
            Above::Reached => &self.jacobian,
            Above::FirstMissed | Above::Mixed => self.curvature.rows(),
        }
    }

    /// What of a rank's gain at a trial that was brought back is due to rows at an edge, by their multipliers.
    pub(super) fn let_through(&self, multipliers: &[f64]) -> f64 {
        match self.has_edges() {
            true => self.edges.let_through(multipliers),
            false => 0.0,
        }
    }

    /// How much of a step from x leads to the edge of the first room that held nothing there, all of it if none is
    /// left; `trial` is where all of it leads, and then where so much does.
    pub(super) fn share_to_an_edge(
        &mut self,
        asked: &mut Asked<'_, '_>,
        x: &[f64],
        step: &[f64],
        trial: &mut [f64],
    ) -> f64 {
        if !self.has_edges() {
            return 1.0;
        }
        // By the secant through the last two places beyond, halved where that leads back within.
        let space = asked.question.space();
        let (mut within, mut beyond, mut last) = (0.0, (1.0, self.beyond(asked, trial)), None);
        for _ in 0..LANDINGS {
            let (share, by) = beyond;
            if by <= 1.0 {
                break;
            }
            let slope = last.map(|(at, before): (f64, f64)| (before - by) / (at - share));
            let aim = slope.map(|slope| share - (by - 0.5) / slope);
            let next = aim.filter(|aim| within < *aim && *aim < share);
            let next = next.unwrap_or(0.5 * (within + share));
            space.integrate_share(x, next, step, trial);
            space.project(trial);
            match self.beyond(asked, trial) {
                0.0 => {
                    within = next;
                    last = None;
                }
                by => last = Some(std::mem::replace(&mut beyond, (next, by))),
            }
        }
        space.integrate_share(x, beyond.0, step, trial);
        space.project(trial);
        beyond.0
    }

    fn beyond(&mut self, asked: &mut Asked<'_, '_>, trial: &[f64]) -> f64 {
        asked.residual(self.share(), trial, &mut self.now);
        self.edges.beyond(&self.now)
    }

    /// Adds C's rows, of the variables that are not fixed, to a span.
    pub(super) fn span(&self, problem: &Problem, span: &mut RowSpan, fixed: &[bool]) {
        let (rows, n) = (self.kept.len(), fixed.len());
        for held in &self.ranks {
            let (own, share) = match (self.above, held.reached) {
                (Above::FirstMissed, _) => (0..n, NEW_CURVATURE),
                (_, true) => (problem.ranks().rows_of(held.rank), NEW),
                (_, false) => {
                    let first = rows + held.rank * n;
                    (first..first + n, NEW_CURVATURE)
                }
            };
            add_rows(span, self.rows(), own, fixed, share);
        }
    }

    /// Adds what the span's rows take of a slope to it, and writes the multipliers of those of reached ranks.
    pub(super) fn multiply(
        &self,
        problem: &Problem,
        span: &mut RowSpan,
        slope: &mut [f64],
        weights: &mut [f64],
    ) {
        let rows = self.rows();
        for (row, multiplier) in span.multipliers(slope) {
            let columns = rows.as_slice().chunks_exact(rows.nrows().max(1));
            for (slope, column) in slope.iter_mut().zip(columns) {
                *slope += multiplier * column[row];
            }
            if is_of_reached(problem, &self.ranks, row) {
                weights[row] = multiplier;
            }
        }
    }

    /// Moves a trial to where the held ranks are what they were; whether it came there.
    pub(super) fn bring_back(
        &mut self,
        asked: &mut Asked<'_, '_>,
        trial: &mut [f64],
        step: &mut HeldStep,
        fixed: &[bool],
    ) -> bool {
        match self.above {
            Above::Reached | Above::Mixed => self.correct(asked, trial, step, fixed),
            Above::FirstMissed => self.settle(asked, trial),
        }
    }

    /// Newton's method on what has changed: the residuals of reached ranks, and the slopes of missed ones.
    fn correct(
        &mut self,
        asked: &mut Asked<'_, '_>,
        trial: &mut [f64],
        step: &mut HeldStep,
        fixed: &[bool],
    ) -> bool {
        let question = asked.question;
        let share = self.share();
        for round in 0..=CORRECTIONS {
            asked.residual(share, trial, &mut self.now);
            let stands = self.stand(question.problem);
            if self.above == Above::Mixed && round < CORRECTIONS {
                self.curvature.slopes(asked, &self.ranks, trial, fixed);
            }
            self.edges.change(&mut self.now, &self.kept);
            // One correction at least: what is left of a step's square would drown what it gains.
            if round > 0 && stands && self.is_kept(question.problem) {
                return true;
            }
            if round == CORRECTIONS || !self.now.iter().all(|v| v.is_finite()) {
                break;
            }
            asked.held_jacobian(share, trial, &mut self.jacobian);
            let (held, miss) = match self.above {
                Above::Mixed => {
                    self.curvature
                        .system(asked, &self.ranks, &self.jacobian, &self.now)
                }
                _ => (&self.jacobian, &self.now[..]),
            };
            let within = StepBounds {
                x: trial,
                space: question.space(),
                fixed,
            };
            step.restore(held, miss, &within, &mut self.back);
            self.uncorrected.copy_from_slice(trial);
            let space = question.space();
            space.integrate(&self.uncorrected, &self.back, trial);
            space.project(trial);
        }
        false
    }

    /// Whether, by the residual now, every rank is as good as it was: reached, or missed by no more.
    fn stand(&self, problem: &Problem) -> bool {
        self.ranks.iter().all(|held| {
            let own = &self.now[problem.ranks().rows_of(held.rank)];
            match held.reached {
                true => problem.is_reached_by(Share::rank(held.rank), own),
                false => half_squared(own) <= held.cost * (1.0 + SAME_MISS),
            }
        })
    }

    /// Whether, by the change of the residual, reached ranks are where they were.
    fn is_kept(&self, problem: &Problem) -> bool {
        let mut reached = self.ranks.iter().filter(|held| held.reached);
        reached.all(|held| {
            let own = &self.now[problem.ranks().rows_of(held.rank)];
            problem.is_kept(Share::rank(held.rank), own)
        })
    }

    /// A missed first rank's own search from the trial; whether its cost is as low as it was.
    fn settle(&mut self, asked: &mut Asked<'_, '_>, trial: &mut [f64]) -> bool {
        let stopping = asked.stopping.with_max_iterations(SETTLING);
        let share = self.share();
        let memory = &mut *asked.memory;
        LevenbergMarquardt::default().minimise(
            &mut Evaluation::of(share, asked.question, asked.scratch),
            trial,
            &stopping,
            asked.deadline,
            &mut Silent,
            memory,
        );
        asked.counts += memory.counts();
        trial.copy_from_slice(memory.x());
        memory.cost() <= half_squared(&self.kept) * (1.0 + SAME_MISS)
    }
}
