//! Search engine for collision-free solutions.

use super::Minimiser;
use crate::problem::{AnyClearanceCheck, Collision, CollisionConstraint, Evaluation, Scratch};
use crate::search::{Engine, SearchResult};
use crate::solver::{LeastSquares, SolverState, Stopping, Termination};

/// Cost per metre of an attempt that reaches all required tasks in collision: below that of any unreached attempt.
const COST_PER_METRE: f64 = 1e-20;
/// Upper bound on the distance of a pair that is too near, metres; keeps the cost positive.
const MAX_DISTANCE: f64 = 10.0;

/// Search engine whose attempts first solve the required tasks without collision avoidance.
///
/// That is usually collision-free. Otherwise the attempt continues from there with collision avoidance as a required
/// task.
pub(super) struct CollisionFreeEngine<'a> {
    pub(super) unconstrained: Minimiser<'a>,
    pub(super) constraint: &'a CollisionConstraint,
    pub(super) workspace: &'a mut SearchWorkspace,
}

/// Workspace of the engine.
#[derive(Clone, Debug)]
pub(super) struct SearchWorkspace {
    pub(super) check: Box<dyn AnyClearanceCheck>,
    scratch: Option<Scratch>,
    state: SolverState,
    /// Configuration at the end of the last attempt.
    q: Vec<f64>,
    /// Variables and residual at the end of the last attempt, valid if `is_constrained_end` is set.
    x: Vec<f64>,
    residual: Vec<f64>,
    is_constrained_end: bool,
}

impl SearchWorkspace {
    pub(super) fn new(constraint: &CollisionConstraint) -> Self {
        Self {
            check: constraint.check(),
            scratch: None,
            state: SolverState::default(),
            q: Vec::new(),
            x: Vec::new(),
            residual: Vec::new(),
            is_constrained_end: false,
        }
    }

    /// Returns the distance of the nearest pair that is too near, metres; infinity if there is none.
    pub(super) fn min_distance(&mut self, q: &[f64]) -> f64 {
        distance_of_first(&self.check.collisions(q))
    }
}

/// Returns the distance of the first pair, metres; infinity if there is none. Pairs are sorted by distance.
pub(super) fn distance_of_first(pairs: &[Collision]) -> f64 {
    pairs.first().map_or(f64::INFINITY, |pair| pair.distance)
}

impl<'a> CollisionFreeEngine<'a> {
    pub(super) fn new(
        unconstrained: Minimiser<'a>,
        constraint: &'a CollisionConstraint,
        workspace: &'a mut SearchWorkspace,
    ) -> Self {
        Self {
            unconstrained,
            constraint,
            workspace,
        }
    }

    /// Writes and returns the configuration of the constrained or the unconstrained search.
    fn write_configuration(&mut self, is_constrained: bool) -> &[f64] {
        let (map, workspace) = (
            self.unconstrained.instance.parameters(),
            &mut *self.workspace,
        );
        let x = if is_constrained {
            workspace.state.x()
        } else {
            self.unconstrained.memory.x()
        };
        workspace.q.resize(map.sources().len(), 0.0);
        map.scatter_within_limits(x, &mut workspace.q);
        &workspace.q
    }

    /// Continues from the end of the unconstrained search with collision avoidance. Returns whether the end is
    /// collision-free.
    fn continue_collision_free(&mut self, attempt: &mut SearchResult, stopping: &Stopping) -> bool {
        let instance = self
            .unconstrained
            .instance
            .with_constraint(self.constraint.with_clearance());
        let subset = instance.problem.searched_subset();
        let problem = instance.problem;
        let SearchWorkspace {
            scratch,
            state: memory,
            ..
        } = &mut *self.workspace;
        let mut constrained = Minimiser {
            instance,
            subset,
            method: self.unconstrained.method,
            deadline: self.unconstrained.deadline,
            observer: &mut *self.unconstrained.observer,
            scratch: scratch.get_or_insert_with(|| problem.scratch()),
            memory,
            guard: None,
            moved: None,
        };
        let constrained_attempt = constrained.attempt(self.unconstrained.memory.x(), stopping);
        attempt.iterations += constrained_attempt.iterations;
        attempt.counts += constrained_attempt.counts;
        if constrained_attempt.termination.is_cut() {
            attempt.termination = constrained_attempt.termination;
        }
        if !constrained_attempt.reached {
            return false;
        }
        self.write_configuration(true);
        let SearchWorkspace { check, q, .. } = &mut *self.workspace;
        if !check.is_free(q) {
            return false;
        }
        let workspace = &mut *self.workspace;
        workspace.state.x().clone_into(&mut workspace.x);
        workspace
            .residual
            .resize(self.unconstrained.memory.residual().len(), 0.0);
        let mut evaluation = Evaluation::of(
            self.unconstrained.subset,
            self.unconstrained.instance,
            self.unconstrained.scratch,
        );
        evaluation.residual(&workspace.x, &mut workspace.residual);
        evaluation.is_reached(&workspace.residual)
    }
}

impl Engine for CollisionFreeEngine<'_> {
    fn residual_at_start(&mut self, start: &[f64]) -> &[f64] {
        self.unconstrained.residual_at_start(start)
    }

    fn attempt(&mut self, x: &[f64], stopping: &Stopping) -> SearchResult {
        let mut attempt = self.unconstrained.attempt(x, stopping);
        self.workspace.is_constrained_end = false;
        if !attempt.reached {
            return attempt;
        }
        self.write_configuration(false);
        let SearchWorkspace { check, q, .. } = &mut *self.workspace;
        if check.is_free(q) {
            return attempt;
        }
        attempt.termination = Termination::Stationary;
        self.workspace.is_constrained_end = self.continue_collision_free(&mut attempt, stopping);
        attempt.reached = self.workspace.is_constrained_end;
        if attempt.reached {
            attempt.termination = Termination::Reached;
            return attempt;
        }
        self.write_configuration(false);
        let q = std::mem::take(&mut self.workspace.q);
        let min_distance = self.workspace.min_distance(&q);
        self.workspace.q = q;
        attempt.cost = COST_PER_METRE * (MAX_DISTANCE - min_distance);
        attempt
    }

    fn end(&self) -> (&[f64], &[f64]) {
        match self.workspace.is_constrained_end {
            true => (&self.workspace.x, &self.workspace.residual),
            false => self.unconstrained.end(),
        }
    }
}
