//! Search with the general solver, for chains that the SIMD solver does not support.

use super::arm::Arm;
use super::batch::outcome_of;
use super::dispatch::Query;
use super::seed_table::SeedTable;
use super::workspace::{ArmWorkspace, stopping};
use crate::ik::Restarts;
use crate::problem::TaskSubset;
use crate::random::RandomStream;
use crate::search::{Schedule, SearchResult, run};
use crate::simd_ik::nearest_revolution;
use crate::solver::{LevenbergMarquardt, Silent, Stopping};

/// Number of attempts from the start and from perturbations of it before the table is used.
const OWN: usize = 2;
/// Largest number of sampled configurations that a query tries: of 240 000 reachable poses 64 fail on two, 128 on none.
const SEEDS: usize = 128;
/// Number of steps without halving the cost after which an attempt from the table ends.
const PATIENCE: usize = 10;
/// Number of attempts at the same minimum after which a target counts as out of reach, if no number of attempts is set.
const AGREEING: usize = 10;
/// Largest number of steps of all random attempts, if no number of iterations is set.
const STEPS: usize = 2500;

impl Arm {
    /// Searches from the workspace's start, then from sampled configurations near the target, then from random ones.
    ///
    /// A solution is left in the workspace's x. If there is none, x is the start and `best` the best of all attempts.
    pub(super) fn search_by_core(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
    ) -> SearchResult {
        let attempts = self.attempts_at(query.target) as usize;
        let mut spent = 0;
        if attempts > 1 && self.is_nearby(workspace) {
            // All that a search of one attempt does comes before other attempts.
            let mut first = self.make_attempts(workspace, query, 1);
            self.finish(workspace, query, &mut first);
            if first.reached || query.is_late() {
                return first;
            }
            spent = first.iterations;
        }
        let mut found = self.make_attempts(workspace, query, attempts);
        found.iterations += spent;
        found
    }

    /// Makes at most `attempts` attempts.
    fn make_attempts(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        attempts: usize,
    ) -> SearchResult {
        let mut found = self.restart(workspace, query, attempts.min(OWN));
        // If motions are bounded, sampled configurations are far outside the bounds.
        let everywhere = self.options.max_move.is_none();
        for seeded in [true, false] {
            let left = attempts.saturating_sub(found.attempts);
            if found.reached || query.is_late() || left == 0 || seeded && !everywhere {
                continue;
            }
            workspace.best.copy_from_slice(&workspace.x);
            let more = match seeded {
                true => self.try_seeds(workspace, query, left.min(SEEDS)),
                false => self.restart(workspace, query, left),
            };
            if !found.merge_later(&more) {
                workspace.x.copy_from_slice(&workspace.best);
            }
        }
        if !found.reached {
            workspace.best.copy_from_slice(&workspace.x);
            workspace.x.copy_from_slice(&workspace.start);
        }
        found
    }

    /// Makes an attempt from each of the nearest sampled configurations, until one reaches; the best is in x.
    fn try_seeds(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        most: usize,
    ) -> SearchResult {
        self.look_up_seeds(workspace, most);
        let mut found = SearchResult::default();
        for turn in 0..workspace.rows.len() {
            if let Some(table) = self.seeds.get() {
                let (_, row) = workspace.rows[turn];
                workspace.x.copy_from_slice(table.seed(row));
            }
            let patient = stopping().with_patience(Some(PATIENCE));
            if found.merge_later(&self.attempt_by_core(workspace, query, &patient)) {
                workspace.trial.copy_from_slice(&workspace.x);
            }
            if found.reached || query.is_late() {
                break;
            }
        }
        workspace.x.copy_from_slice(&workspace.trial);
        found
    }

    /// Makes one attempt from the workspace's x and leaves its end there.
    fn attempt_by_core(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        stopping: &Stopping,
    ) -> SearchResult {
        let (termination, iterations) = workspace.settle_within(stopping, query.deadline);
        self.unwrap_towards(query.start, workspace);
        let mut found = SearchResult::single_attempt(termination, iterations);
        self.judge(workspace, &mut found);
        found
    }

    /// Writes the table's rows nearest to the target to the workspace.
    fn look_up_seeds(&self, workspace: &mut ArmWorkspace, most: usize) {
        let table = self
            .seeds
            .get_or_init(|| SeedTable::new(&self.serial, workspace));
        let goal = &self.options.goal;
        let weights = (
            f64::from(u8::from(goal.has_position())),
            match goal.has_orientation() {
                true => self.options.metres_per_radian,
                false => 0.0,
            },
        );
        let target = workspace.target();
        table.nearest(&target, weights, most, &mut workspace.rows);
    }

    /// Makes attempts from the workspace's start, from perturbations of it and from random configurations.
    ///
    /// The best is in the workspace's x.
    fn restart(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        attempts: usize,
    ) -> SearchResult {
        let options = &self.options;
        let (steps, agreeing) = match (options.iterations, options.attempts_asked) {
            (Some(steps), true) => (steps as usize, usize::MAX),
            (Some(steps), false) => (steps as usize, AGREEING),
            (None, true) => (usize::MAX, usize::MAX),
            (None, false) => (STEPS, AGREEING),
        };
        let restarts = Restarts::default()
            .with_attempts(attempts)
            .with_steps(steps)
            .with_agreeing(agreeing)
            .with_seed(options.seed);
        // Taken out and put back, so that nothing is allocated.
        let mut search = std::mem::take(&mut workspace.search);
        let question = workspace.question.ask();
        search.fit(question, TaskSubset::All);
        search.start.copy_from_slice(&workspace.start);
        let (method, mut silent) = (LevenbergMarquardt::default(), Silent);
        let mut engine = workspace.engine(&method, query.deadline, &mut silent);
        let question = engine.question;
        let asked = (question, TaskSubset::All);
        let schedule = Schedule::of_searches(asked, restarts, Stopping::default(), false);
        let deadline = query.deadline;
        let mut found = run(
            question,
            TaskSubset::All,
            &schedule,
            deadline,
            &mut engine,
            &mut search,
        );
        workspace.x.copy_from_slice(&search.keeper.x);
        workspace.search = search;
        self.unwrap_towards(query.start, workspace);
        self.judge(workspace, &mut found);
        found
    }

    /// Makes attempts `first`, `first + 1`, … with the general solver, and appends their configurations and outcomes.
    pub(super) fn attempts_by_core(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        first: u32,
        count: u32,
    ) {
        self.look_up_seeds(workspace, SEEDS.min((first + count) as usize));
        for attempt in first..first + count {
            workspace.x.copy_from_slice(&workspace.start);
            // Every other attempt begins at a row of the table, as long as there are rows.
            let row = match attempt > 0 && attempt % 2 == 0 {
                true => workspace.rows.get(attempt as usize / 2 - 1),
                false => None,
            };
            if let (Some((_, row)), Some(table)) = (row, self.seeds.get()) {
                workspace.x.copy_from_slice(table.seed(*row));
            } else if attempt > 0 {
                let mut random = RandomStream::new(self.options.seed, u64::from(attempt));
                let question = workspace.question.ask();
                for (i, value) in workspace.x.iter_mut().enumerate() {
                    let (low, high) = question.sampling_range(i, workspace.start[i]);
                    *value = low + (high - low) * random.unit();
                }
            }
            let mut found = self.attempt_by_core(workspace, query, &stopping());
            found.number = attempt as usize;
            workspace.found.extend_from_slice(&workspace.x);
            let outcome = outcome_of(&found, workspace.errors);
            workspace.outcomes.push(outcome);
        }
    }

    /// Adds whole revolutions to joints of the workspace's x that can make them and drive no mimic joint.
    pub(super) fn unwrap_towards(&self, start: &[f64], workspace: &mut ArmWorkspace) {
        let (model, map) = (&self.serial.model, &self.serial.map);
        for (i, value) in workspace.x.iter_mut().enumerate() {
            let joint = &model.joints()[model.moving_joints()[map.leaders()[i]].index()];
            let bounds = (workspace.question.lower[i], workspace.question.upper[i]);
            if !joint.kind.slides() && !self.serial.followed[i] {
                *value = nearest_revolution(start[i], *value, bounds);
            }
        }
    }
}
