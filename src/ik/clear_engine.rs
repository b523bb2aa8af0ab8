//! A method as an engine of a search for what is free.

use super::Minimiser;
use crate::problem::{AnyClearanceCheck, Collision, Evaluation, Fence, Scratch};
use crate::search::{Attempt, Engine};
use crate::solver::{LeastSquares, SolverState, Stopping, Termination};

/// What an attempt counts that meets all goals but touches something, by how deep that is: less than any that misses a goal.
const TOUCHING: f64 = 1e-20;
/// No pair that is too near is so far apart, metres.
const FAR: f64 = 10.0;

/// Each attempt meets the goals as if nothing were in the way, which most often is free; where it is not, it goes on from there
/// with the clearance among the goals.
pub(super) struct ClearEngine<'a> {
    pub(super) plain: Minimiser<'a>,
    pub(super) fence: &'a Fence,
    pub(super) room: &'a mut EngineRoom,
}

/// Room for that.
#[derive(Clone, Debug)]
pub(super) struct EngineRoom {
    pub(super) check: Box<dyn AnyClearanceCheck>,
    scratch: Option<Scratch>,
    memory: SolverState,
    /// Where the last attempt ended, as a configuration, …
    q: Vec<f64>,
    /// … and by the variables with the residual there, if the clearance led there.
    x: Vec<f64>,
    residual: Vec<f64>,
    led: bool,
}

impl EngineRoom {
    pub(super) fn new(fence: &Fence) -> Self {
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

    /// How near the nearest pair is at a configuration, if any is too near.
    pub(super) fn least_distance(&mut self, q: &[f64]) -> f64 {
        distance_of_first(&self.check.collisions(q))
    }
}

/// How near the nearest of some pairs is, the nearest first.
pub(super) fn distance_of_first(pairs: &[Collision]) -> f64 {
    pairs.first().map_or(f64::INFINITY, |pair| pair.distance)
}

impl<'a> ClearEngine<'a> {
    pub(super) fn new(plain: Minimiser<'a>, fence: &'a Fence, room: &'a mut EngineRoom) -> Self {
        Self { plain, fence, room }
    }

    /// The configuration of some variables.
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

    /// Goes on from where the goals are met with the clearance among them; whether that ended at a free place.
    fn lead_out(&mut self, attempt: &mut Attempt, stopping: &Stopping) -> bool {
        let question = self.plain.question.fenced(self.fence.leading());
        let share = question.problem.search_share();
        let problem = question.problem;
        let EngineRoom {
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
            moved: None,
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
        let EngineRoom { check, q, .. } = &mut *self.room;
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
        let EngineRoom { check, q, .. } = &mut *self.room;
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
