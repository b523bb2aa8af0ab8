//! Preferences within what the goals leave free.
//!
//! Minimise ½‖r‖² of the pulls over the configurations at which the goals are what they were when
//! their own search ended, by successive projection: a step that is best for the linearised pulls and
//! leaves the linearised goals alone, then the shortest steps that bring the goals back. At a miss the
//! goals' rows lose rank where a limb is stretched, though bending it would cost; there the curvature of
//! their cost takes the place of their Jacobian, and their own search brings them back. Steps are conjugate
//! to the last one (Polak & Ribière 1969), as the goals bend what the pulls see.

use std::time::Instant;

use nalgebra::DMatrix;

use crate::problem::{Evaluation, Problem, Question, Scratch, Share};
use crate::solver::{
    AnyMethod, Counts, HeldStep, Iteration, LeastSquares, LevenbergMarquardt, Observer, Silent,
    SolverState, StepBounds, Stopping, Termination, half_squared, negligible_slope,
};

/// Steps along the goals, …
const STEPS: usize = 60;
/// … and at a miss, where each costs a curvature.
const STEPS_AT_A_MISS: usize = 15;
/// Steps along the goals in a frame of a drag, …
const STEPS_A_FRAME: usize = 2;
/// … which at a miss waits until the goals' own search takes no more steps than these.
const AT_REST: usize = 3;
/// Halvings of a step that gains nothing.
const HALVINGS: usize = 6;
/// Corrections back to the goals after a step.
const CORRECTIONS: usize = 6;
/// Steps of the goals' own search after one at a miss.
const SETTLING: usize = 20;
/// Longest step of one joint, as a share of half a turn or of the reach.
const LONGEST: f64 = 0.25;
/// What the pulls gain at least, as a share of their cost, for a step to make sense.
const WORTHWHILE: f64 = 1e-9;
/// The same at a miss, where the goals' curvature is known to fewer digits.
const WORTHWHILE_AT_A_MISS: f64 = 1e-7;
/// A direction that falls by less than this share of the steepest one forgets the last one.
const CONJUGATE: f64 = 0.2;
/// What the pulls may be bent more or less than their rows say.
const BENDS: (f64, f64) = (0.1, 20.0);
/// At a miss: how much of the goals' cost counts as the same.
const SAME_MISS: f64 = 1e-9;

/// How a refinement went; where it ended is in its x.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Refined {
    pub(super) iterations: usize,
    pub(super) counts: Counts,
    /// What ended it early.
    pub(super) cut: Option<Termination>,
}

/// What a refinement starts from.
pub(super) struct Start<'a> {
    pub(super) x: &'a [f64],
    /// The goals' residual there.
    pub(super) residual: &'a [f64],
    pub(super) reached: bool,
}

/// How far a refinement goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Extent {
    /// To where nothing more is gained.
    Whole,
    /// A frame's share of it: the next ones go on.
    Frame,
    /// Nowhere.
    Nothing,
}

impl Extent {
    /// Steps along the goals at most, and halvings of one.
    fn most(self, reached: bool) -> (usize, usize) {
        match (self, reached) {
            (Self::Whole, true) => (STEPS, HALVINGS),
            (Self::Whole, false) => (STEPS_AT_A_MISS, HALVINGS),
            (Self::Frame, true) => (STEPS_A_FRAME, HALVINGS),
            (Self::Frame, false) => (1, 1),
            (Self::Nothing, _) => (0, 0),
        }
    }

    /// Whether it makes sense after a search of the goals that took so many steps. While a body still
    /// goes after a target that it misses, its posture can wait: a step there costs a curvature.
    pub(super) fn follows(self, reached: bool, iterations: usize) -> bool {
        match self {
            Self::Whole => true,
            Self::Frame => reached || iterations <= AT_REST,
            Self::Nothing => false,
        }
    }
}

/// How long it goes on.
pub(super) struct Limits {
    pub(super) stopping: Stopping,
    pub(super) extent: Extent,
    pub(super) deadline: Option<Instant>,
}

/// What is asked, the memory to evaluate it, and how often that was done.
struct Asked<'q, 'm> {
    question: Question<'q>,
    scratch: &'m mut Scratch,
    memory: &'m mut SolverState,
    counts: Counts,
}

impl Asked<'_, '_> {
    fn evaluate(&mut self, share: Share) -> Evaluation<'_> {
        Evaluation::of(share, self.question, self.scratch)
    }

    fn jacobian(&mut self, share: Share, x: &[f64], jacobian: &mut DMatrix<f64>) {
        self.counts.jacobians += 1;
        self.evaluate(share).jacobian(x, jacobian);
        if share == Share::Goals {
            release(self.question, jacobian);
        }
    }
}

/// Room for a refinement.
#[derive(Clone, Debug, Default)]
pub(super) struct Refinement {
    /// Where it stands.
    pub(super) x: Vec<f64>,
    trial: Vec<f64>,
    /// Where a correction of the trial starts.
    uncorrected: Vec<f64>,
    /// The best step by the linear model, this time and last time.
    best: Vec<f64>,
    last_best: Vec<f64>,
    /// Where the search goes.
    direction: Vec<f64>,
    /// What two steps do to the pulls.
    effects: [Vec<f64>; 2],
    fixed: Vec<bool>,
    /// The goals' residual where their search ended, and at a trial.
    goals_kept: Vec<f64>,
    goals: Vec<f64>,
    goal_jacobian: DMatrix<f64>,
    curvature: DMatrix<f64>,
    goal_slopes: [Vec<f64>; 2],
    pulls: Vec<f64>,
    pull_jacobian: DMatrix<f64>,
    step: HeldStep,
}

impl Refinement {
    /// Makes room for a problem.
    pub(super) fn fit(&mut self, problem: &Problem) {
        let n = problem.variables();
        let [goals, pulls] = [Share::Goals, Share::Pulls].map(|share| problem.rows_of(share));
        for (vector, room) in [
            (&mut self.x, n),
            (&mut self.trial, n),
            (&mut self.uncorrected, n),
            (&mut self.best, n),
            (&mut self.last_best, n),
            (&mut self.direction, n),
            (&mut self.goals_kept, goals),
            (&mut self.goals, goals),
            (&mut self.pulls, pulls),
        ] {
            vector.resize(room, 0.0);
        }
        for slope in &mut self.goal_slopes {
            slope.resize(n, 0.0);
        }
        for effect in &mut self.effects {
            effect.resize(pulls, 0.0);
        }
        self.fixed.resize(n, false);
        for (matrix, rows) in [
            (&mut self.goal_jacobian, goals),
            (&mut self.curvature, n),
            (&mut self.pull_jacobian, pulls),
        ] {
            if matrix.shape() != (rows, n) {
                *matrix = DMatrix::zeros(rows, n);
            }
        }
        self.step.reserve(goals.max(n), pulls, n);
    }

    /// Goes from a place to where the pulls gain nothing more.
    pub(super) fn run(
        &mut self,
        question: Question<'_>,
        scratch: &mut Scratch,
        memory: &mut SolverState,
        from: &Start<'_>,
        limits: &Limits,
        observer: &mut dyn Observer,
    ) -> Refined {
        let mut asked = Asked {
            question,
            scratch,
            memory,
            counts: Counts::default(),
        };
        let (iterations, cut) = self.descend(&mut asked, from, limits, observer);
        Refined {
            iterations,
            counts: asked.counts,
            cut,
        }
    }

    /// How many steps it took, and what ended it early.
    fn descend(
        &mut self,
        asked: &mut Asked<'_, '_>,
        from: &Start<'_>,
        limits: &Limits,
        observer: &mut dyn Observer,
    ) -> (usize, Option<Termination>) {
        let question = asked.question;
        self.x.copy_from_slice(from.x);
        self.goals_kept.copy_from_slice(from.residual);
        self.hold_back(asked, from, limits);
        let mut cost = self.pull_at_x(asked);
        asked.counts.residuals += 1;
        let (steps, halvings) = limits.extent.most(from.reached);
        let worthwhile = match from.reached {
            true => WORTHWHILE,
            false => WORTHWHILE_AT_A_MISS,
        };
        let steps = steps.min(limits.stopping.max_iterations());
        let (mut iterations, mut bend, mut moved, mut last_falls) = (0, 1.0, 0.0, None);
        loop {
            if !cost.is_finite() {
                return (iterations, Some(Termination::NonFinite));
            }
            let seen = observer.observe(&Iteration {
                index: iterations,
                cost,
                projected_gradient: None,
                step: moved,
                control: 0.0,
                x: &self.x,
            });
            if seen.is_break() {
                return (iterations, Some(Termination::Cancelled));
            }
            if limits.deadline.is_some_and(|at| Instant::now() >= at) {
                return (iterations, Some(Termination::TimeLimit));
            }
            if iterations >= steps {
                return (iterations, None);
            }
            let Some(falls) = self.aim(asked, from.reached) else {
                return (iterations, None);
            };
            // What the step promises: its fall along the goals alone, without what rounding lets slip.
            let promised = falls.min(inner(&self.effects[0], &self.effects[0]));
            if promised <= 2.0 * worthwhile * cost {
                return (iterations, None);
            }
            iterations += 1;
            let Way {
                slope,
                stiffness,
                conjugate,
            } = self.choose(question, falls, last_falls);
            last_falls = Some(falls);
            let longest = self.longest_share(question);
            let mut share = longest.min(slope / (bend * stiffness));
            let mut gained = None;
            for _ in 0..halvings {
                let space = question.space();
                space.integrate_share(&self.x, share, &self.direction, &mut self.trial);
                space.project(&mut self.trial);
                let back = match from.reached {
                    true => self.correct(asked),
                    false => self.settle(asked, limits),
                };
                let now = match back {
                    true => self.pull_at_trial(asked),
                    false => f64::INFINITY,
                };
                asked.counts.residuals += usize::from(back);
                if back && now.is_finite() {
                    let bent = 2.0 * (now - cost + share * slope) / (share * share * stiffness);
                    bend = bent.clamp(BENDS.0, BENDS.1);
                }
                if now < cost {
                    gained = Some(now);
                    break;
                }
                share *= 0.5;
                share = share.min(slope / (bend * stiffness));
            }
            let Some(now) = gained else {
                if conjugate {
                    last_falls = None;
                    continue;
                }
                return (iterations, None);
            };
            moved = question.space().distance(&self.trial, &self.x);
            std::mem::swap(&mut self.x, &mut self.trial);
            std::mem::swap(&mut self.best, &mut self.last_best);
            cost = now;
        }
    }

    /// Fixes the variables that stand on a bound for the goals' sake.
    fn hold_back(&mut self, asked: &mut Asked<'_, '_>, from: &Start<'_>, limits: &Limits) {
        self.fixed.fill(false);
        if from.reached {
            return;
        }
        let question = asked.question;
        let mut goals = Evaluation::of(Share::Goals, question, asked.scratch);
        let (slope, column_norm) = asked.memory.slope_at(&mut goals, from.x, from.residual);
        let cost = half_squared(from.residual);
        let negligible = negligible_slope(column_norm, cost, &limits.stopping);
        for (j, fixed) in self.fixed.iter_mut().enumerate() {
            *fixed = question.space().holds(from.x, j, slope[j], negligible);
        }
    }

    fn pull_at_x(&mut self, asked: &mut Asked<'_, '_>) -> f64 {
        let mut pulls = asked.evaluate(Share::Pulls);
        pulls.residual(&self.x, &mut self.pulls);
        half_squared(&self.pulls)
    }

    fn pull_at_trial(&mut self, asked: &mut Asked<'_, '_>) -> f64 {
        let mut pulls = asked.evaluate(Share::Pulls);
        pulls.residual(&self.trial, &mut self.pulls);
        half_squared(&self.pulls)
    }

    /// Puts the best step into `best`; how fast the pulls' cost falls along it, if it does.
    fn aim(&mut self, asked: &mut Asked<'_, '_>, reached: bool) -> Option<f64> {
        self.pull_at_x(asked);
        asked.jacobian(Share::Pulls, &self.x, &mut self.pull_jacobian);
        if !self.step.take_pulls(&self.pull_jacobian, &self.pulls) {
            return None;
        }
        let held = if reached {
            asked.jacobian(Share::Goals, &self.x, &mut self.goal_jacobian);
            &self.goal_jacobian
        } else {
            self.take_curvature(asked);
            &self.curvature
        };
        let within = StepBounds {
            x: &self.x,
            space: asked.question.space(),
            fixed: &self.fixed,
        };
        self.step.pull(
            held,
            &self.pull_jacobian,
            &self.pulls,
            &within,
            &mut self.best,
        );
        let [effect, _] = &mut self.effects;
        multiply(&self.pull_jacobian, &self.best, effect);
        let falls = -inner(effect, &self.pulls);
        falls.is_finite().then_some(falls)
    }

    /// Makes the best step conjugate to the last direction, unless that hardly falls.
    fn choose(&mut self, question: Question<'_>, falls: f64, last_falls: Option<f64>) -> Way {
        let [effect, other] = &mut self.effects;
        let straight = Way {
            slope: falls,
            stiffness: inner(effect, effect),
            conjugate: false,
        };
        if let Some(last_falls) = last_falls {
            multiply(&self.pull_jacobian, &self.last_best, other);
            let kept = ((falls - inner(effect, other)) / last_falls).max(0.0);
            let space = question.space();
            let steps = self.direction.iter_mut().zip(&self.best).zip(&self.fixed);
            for (j, ((direction, best), fixed)) in steps.enumerate() {
                let way = best + kept * *direction;
                let outward = space.holds(&self.x, j, -way, 0.0);
                *direction = if outward || *fixed { 0.0 } else { way };
            }
            multiply(&self.pull_jacobian, &self.direction, effect);
            let slope = -inner(effect, &self.pulls);
            if slope >= CONJUGATE * falls {
                return Way {
                    slope,
                    stiffness: inner(effect, effect),
                    conjugate: kept > 0.0,
                };
            }
        }
        self.direction.copy_from_slice(&self.best);
        straight
    }

    /// The second derivative of the goals' cost at x, by differences of its gradient.
    fn take_curvature(&mut self, asked: &mut Asked<'_, '_>) {
        let n = self.x.len();
        let space = asked.question.space();
        asked.counts.residuals += n + 1;
        asked.counts.gradients += n + 1;
        let mut goals = asked.evaluate(Share::Goals);
        let [here, there] = &mut self.goal_slopes;
        goals.residual(&self.x, &mut self.goals);
        goals.gradient(&self.x, &self.goals, here, &mut self.goal_jacobian);
        self.trial.copy_from_slice(&self.x);
        for j in 0..n {
            let shift = f64::EPSILON.sqrt() * self.x[j].abs().max(1.0);
            let taken = space.integrate_one(&self.x, j, shift, &mut self.trial);
            goals.residual(&self.trial, &mut self.goals);
            goals.gradient(&self.trial, &self.goals, there, &mut self.goal_jacobian);
            space.return_one(&self.x, j, &mut self.trial);
            let column = &mut self.curvature.as_mut_slice()[j * n..(j + 1) * n];
            for ((entry, there), here) in column.iter_mut().zip(&*there).zip(&*here) {
                *entry = (there - here) / taken;
            }
        }
    }

    /// How much of the step the longest move of one joint allows.
    fn longest_share(&self, question: Question<'_>) -> f64 {
        let moves = self.direction.iter().enumerate();
        let longest = moves.map(|(j, step)| step.abs() / (LONGEST * question.problem.spread(j)));
        1.0 / longest.fold(f64::MIN_POSITIVE, f64::max)
    }

    /// Brings the goals at the trial back to what they were; whether they came there.
    fn correct(&mut self, asked: &mut Asked<'_, '_>) -> bool {
        let question = asked.question;
        for round in 0..=CORRECTIONS {
            asked.counts.residuals += 1;
            let mut goals = asked.evaluate(Share::Goals);
            goals.residual(&self.trial, &mut self.goals);
            let reached = goals.is_reached(&self.goals);
            for (goal, kept) in self.goals.iter_mut().zip(&self.goals_kept) {
                *goal -= kept;
            }
            // One correction at least: what is left of a step's square would drown what it gains.
            if round > 0 && reached && question.problem.is_kept(&self.goals) {
                return true;
            }
            if round == CORRECTIONS || !self.goals.iter().all(|v| v.is_finite()) {
                break;
            }
            asked.jacobian(Share::Goals, &self.trial, &mut self.goal_jacobian);
            let within = StepBounds {
                x: &self.trial,
                space: question.space(),
                fixed: &self.fixed,
            };
            let (held, miss) = (&self.goal_jacobian, &self.goals);
            let back = &mut self.goal_slopes[0];
            self.step.restore(held, miss, &within, back);
            self.uncorrected.copy_from_slice(&self.trial);
            question
                .space()
                .integrate(&self.uncorrected, back, &mut self.trial);
            question.space().project(&mut self.trial);
        }
        false
    }

    /// Brings the goals at the trial back to their lowest cost; whether it is as low as it was.
    fn settle(&mut self, asked: &mut Asked<'_, '_>, limits: &Limits) -> bool {
        let stopping = limits.stopping.with_max_iterations(SETTLING);
        let memory = &mut *asked.memory;
        LevenbergMarquardt::default().minimise(
            &mut Evaluation::of(Share::Goals, asked.question, asked.scratch),
            &self.trial,
            &stopping,
            limits.deadline,
            &mut Silent,
            memory,
        );
        asked.counts += memory.counts();
        self.trial.copy_from_slice(memory.x());
        memory.cost() <= half_squared(&self.goals_kept) * (1.0 + SAME_MISS)
    }
}

/// How fast the pulls' cost falls along the direction, and how fast that slows down.
struct Way {
    slope: f64,
    stiffness: f64,
    conjugate: bool,
}

/// J Δ.
fn multiply(jacobian: &DMatrix<f64>, step: &[f64], product: &mut [f64]) {
    product.fill(0.0);
    let columns = jacobian.as_slice().chunks_exact(product.len().max(1));
    for (column, &step) in columns.zip(step).filter(|(_, step)| **step != 0.0) {
        for (sum, entry) in product.iter_mut().zip(column) {
            *sum += step * entry;
        }
    }
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Rows for which any error will do hold nothing.
fn release(question: Question<'_>, jacobian: &mut DMatrix<f64>) {
    let rows = jacobian.nrows();
    for free in question.problem.free_goal_rows() {
        for column in jacobian.as_mut_slice().chunks_exact_mut(rows.max(1)) {
            column[free.clone()].fill(0.0);
        }
    }
}
