//! Search engine for collision-free solutions.

use super::Minimiser;
use crate::problem::{AnyClearanceCheck, Collision, CollisionConstraint, Evaluation, Scratch};
use crate::search::{Attempt, Engine};
use crate::solver::{LeastSquares, SolverState, Stopping, Termination};

/// Cost per metre of an attempt that reaches all required tasks in collision: below that of any unreached attempt.
const TOUCHING: f64 = 1e-20;
/// Upper bound on the distance of a pair that is too near, metres; keeps the cost positive.
const FAR: f64 = 10.0;

/// Search engine whose attempts first solve the required tasks without collision avoidance.
///
/// That is usually collision-free. Otherwise the attempt continues from there with collision avoidance as a required
/// task.
pub(super) struct ClearEngine<'a> {
    pub(super) plain: Minimiser<'a>,
    pub(super) fence: &'a CollisionConstraint,
    pub(super) room: &'a mut SearchWorkspace,
}

/// Workspace of the engine.
#[derive(Clone, Debug)]
pub(super) struct SearchWorkspace {
    pub(super) check: Box<dyn AnyClearanceCheck>,
    scratch: Option<Scratch>,
    memory: SolverState,
    /// Configuration at the end of the last attempt.
    q: Vec<f64>,
    /// Variables and residual at the end of the last attempt, valid if `led` is set.
    x: Vec<f64>,
    residual: Vec<f64>,
    led: bool,
}

impl SearchWorkspace {
    pub(super) fn new(fence: &CollisionConstraint) -> Self {
        Self {
            check: fence.check(),
            scratch: None,
            memory: SolverState::default(),
            q: Vec::new(),
            x: Vec::new(),
            residual: Vec::new(),
            led: false,
        }
    }

    /// Returns the distance of the nearest pair that is too near, metres; infinity if there is none.
    pub(super) fn least_distance(&mut self, q: &[f64]) -> f64 {
        distance_of_first(&self.check.collisions(q))
    }
}

/// Returns the distance of the first pair, metres; infinity if there is none. Pairs are sorted by distance.
pub(super) fn distance_of_first(pairs: &[Collision]) -> f64 {
    pairs.first().map_or(f64::INFINITY, |pair| pair.distance)
}

impl<'a> ClearEngine<'a> {
    pub(super) fn new(
        plain: Minimiser<'a>,
        fence: &'a CollisionConstraint,
        room: &'a mut SearchWorkspace,
    ) -> Self {
        Self { plain, fence, room }
    }

    /// Writes and returns the configuration of the constrained or the plain search.
    fn place(&mut self, fenced: bool) -> &[f64] {
        let (map, room) = (self.plain.question.parameters(), &mut *self.room);
        let x = if fenced {
            room.memory.x()
        } else {
            self.plain.memory.x()
        };
        room.q.resize(map.sources().len(), 0.0);
        map.scatter_within_limits(x, &mut room.q);
        &room.q
    }

    /// Continues from the end of the plain search with collision avoidance. Returns whether the end is collision-free.
    fn lead_out(&mut self, attempt: &mut Attempt, stopping: &Stopping) -> bool {
        let question = self.plain.question.fenced(self.fence.leading());
        let share = question.problem.search_share();
        let problem = question.problem;
        let SearchWorkspace {
            scratch, memory, ..
        } = &mut *self.room;
        let mut fenced = Minimiser {
            question,
            share,
            method: self.plain.method,
            deadline: self.plain.deadline,
            observer: &mut *self.plain.observer,
            scratch: scratch.get_or_insert_with(|| problem.scratch()),
            memory,
            guard: None,
        };
        let led = fenced.attempt(self.plain.memory.x(), stopping);
        attempt.iterations += led.iterations;
        attempt.counts += led.counts;
        if led.termination.is_cut() {
            attempt.termination = led.termination;
        }
        if !led.reached {
            return false;
        }
        self.place(true);
        let SearchWorkspace { check, q, .. } = &mut *self.room;
        if !check.is_free(q) {
            return false;
        }
        let room = &mut *self.room;
        room.memory.x().clone_into(&mut room.x);
        room.residual
            .resize(self.plain.memory.residual().len(), 0.0);
        let mut goals = Evaluation::of(self.plain.share, self.plain.question, self.plain.scratch);
        goals.residual(&room.x, &mut room.residual);
        goals.is_reached(&room.residual)
    }
}

impl Engine for ClearEngine<'_> {
    fn residual_at_start(&mut self, start: &[f64]) -> &[f64] {
        self.plain.residual_at_start(start)
    }

    fn attempt(&mut self, x: &[f64], stopping: &Stopping) -> Attempt {
        let mut attempt = self.plain.attempt(x, stopping);
        self.room.led = false;
        if !attempt.reached {
            return attempt;
        }
        self.place(false);
        let SearchWorkspace { check, q, .. } = &mut *self.room;
        if check.is_free(q) {
            return attempt;
        }
        attempt.termination = Termination::Stationary;
        self.room.led = self.lead_out(&mut attempt, stopping);
        attempt.reached = self.room.led;
        if attempt.reached {
            attempt.termination = Termination::Reached;
            return attempt;
        }
        self.place(false);
        let q = std::mem::take(&mut self.room.q);
        let nearest = self.room.least_distance(&q);
        self.room.q = q;
        attempt.cost = TOUCHING * (FAR - nearest);
        attempt
    }

    fn end(&self) -> (&[f64], &[f64]) {
        match self.room.led {
            true => (&self.room.x, &self.room.residual),
            false => self.plain.end(),
        }
    }
}
