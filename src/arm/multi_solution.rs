//! Searches that compare solutions: the nearest, and several distinct ones.

use super::QueryError;
use super::arm::Arm;
use super::batch::outcome_of;
use super::dispatch::Query;
use super::options::Search;
use super::workspace::{ArmWorkspace, Errors};
use crate::ik::Solution;
use crate::search::SearchResult;
use crate::simd_ik::{self, PoseOutcome};
use crate::solver::Termination;
use crate::spatial::Placement;

/// Number of attempts between two checks of the budget.
const GROUP: u32 = 16;
/// Number of attempts between two checks of the clock, with a time limit: one lock step.
const TIMED_GROUP: u32 = 8;
/// Number of the nearest solutions that are moved towards the start.
const REFINED: usize = 6;

impl Arm {
    /// Finds all solutions that the arm's search prefers, nearest to the start first.
    ///
    /// [`Search::Distinct`] gives up to `k` solutions, and none if the target is not reached. The other searches give
    /// one, reached or not. A reached solution that ends by [`Termination::TimeLimit`] means that the clock cut the
    /// comparison short: there may be more or nearer ones.
    ///
    /// # Errors
    /// Returns the errors of [`solve`](Self::solve).
    pub fn solve_all(
        &self,
        base_from_tool: impl Into<Placement<f64>>,
        start: &[f64],
    ) -> Result<Vec<Solution>, QueryError> {
        let target = base_from_tool.into();
        let Search::Distinct { k, distance } = self.options.search else {
            return Ok(vec![self.solve(target, start)?]);
        };
        self.check_length("the start", start.len(), self.joint_count())?;
        self.check_query(0, &target, start)?;
        let query = self.query(&target, start);
        self.with_workspace(|workspace| {
            workspace.aim(&target);
            self.bound_moves(workspace, start);
            let ended = self.gather(workspace, &query);
            #[cfg(feature = "collision")]
            let ended = match self.drop_touching(workspace, &query)? {
                true => ended,
                false => Termination::TimeLimit,
            };
            Ok(self.distinct(workspace, k, distance, ended))
        })?
    }

    /// Runs attempts and sorts those that reach by their distance from the start.
    ///
    /// The termination shows if all were run, or if the time limit ended them.
    pub(super) fn gather(&self, workspace: &mut ArmWorkspace, query: &Query<'_>) -> Termination {
        let n = self.joint_count();
        let wanted = self.attempts_at(query.target);
        let iterations = self.options.iterations;
        let budget = iterations.map_or(usize::MAX, |most| most as usize);
        workspace.found.clear();
        workspace.outcomes.clear();
        let mut first = 0;
        while first < wanted && spent(&workspace.outcomes) < budget {
            let group = match query.deadline {
                Some(_) => TIMED_GROUP,
                None => GROUP,
            };
            let count = group.min(wanted - first);
            self.run_attempts(workspace, query, first, count);
            if first == 0 && !query.is_late() {
                self.continue_first(workspace, query);
            }
            first += count;
            if query.is_late() {
                break;
            }
        }
        workspace.order.clear();
        for (place, outcome) in workspace.outcomes.iter().enumerate() {
            if outcome.reached {
                let q = &workspace.found[place * n..(place + 1) * n];
                let distance = self.distance(q, &workspace.start);
                workspace.order.push((distance, place));
            }
        }
        // By distance, then by number: no two are equal.
        let order = &mut workspace.order;
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        if query.is_late() && first < wanted {
            Termination::TimeLimit
        } else {
            Termination::Reached
        }
    }

    /// Continues the first attempt, if it failed, as a search of one attempt does.
    fn continue_first(&self, workspace: &mut ArmWorkspace, query: &Query<'_>) {
        let Some(outcome) = workspace.outcomes.first() else {
            return;
        };
        let mut found = self.found_by(outcome);
        if found.reached || self.asks_for_own_way(query.target) {
            return;
        }
        workspace.stand_at_found(0);
        self.finish_first(workspace, query, &mut found);
        if found.reached {
            let n = self.joint_count();
            workspace.found[..n].copy_from_slice(&workspace.x);
            workspace.outcomes[0] = outcome_of(&found, workspace.errors);
        }
    }

    /// Runs attempts `first`, `first + 1`, … and appends their configurations and outcomes.
    pub(super) fn run_attempts(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        first: u32,
        count: u32,
    ) {
        let n = self.joint_count();
        let Some(lanes) = self.lanes_within(&workspace.bounded_lanes) else {
            return self.attempts_by_core(workspace, query, first, count);
        };
        let begun = workspace.outcomes.len();
        let end = begun + count as usize;
        workspace.found.resize(end * n, 0.0);
        workspace.outcomes.resize(end, PoseOutcome::default());
        lanes.run(simd_ik::Work {
            targets: std::slice::from_ref(query.target),
            starts: query.start,
            search: simd_ik::Prefer::Start,
            attempts: simd_ik::Attempts::From(first),
            deadline: query.deadline,
            q: &mut workspace.found[begun * n..],
            outcomes: &mut workspace.outcomes[begun..],
        });
    }

    /// Writes the nearest solution to the workspace's x; for a redundant arm it is first moved towards the start.
    ///
    /// `ended` is the termination of the attempts.
    pub(super) fn nearest(
        &self,
        workspace: &mut ArmWorkspace,
        query: &Query<'_>,
        ended: Termination,
    ) -> SearchResult {
        let n = self.joint_count();
        let mut found = SearchResult {
            termination: ended,
            iterations: spent(&workspace.outcomes),
            attempts: workspace.outcomes.len(),
            ..SearchResult::default()
        };
        let Some(&(_, place)) = workspace.order.first() else {
            // No attempt reached: use the end of the first and the best of all.
            let cost = |outcome: &PoseOutcome| self.cost(Errors::of(outcome));
            let costs = workspace.outcomes.iter().map(cost).enumerate();
            let best = costs.min_by(|a, b| a.1.total_cmp(&b.1));
            let best = best.map_or(0, |best| best.0);
            workspace.x.copy_from_slice(&workspace.found[..n]);
            let q = &workspace.found[best * n..(best + 1) * n];
            workspace.best.copy_from_slice(q);
            found.number = best;
            self.judge(workspace, &mut found);
            return found;
        };
        workspace.stand_at_found(place);
        found.number = place;
        if self.has_freedom() {
            let mut best = f64::INFINITY;
            // Taken out and put back, so that nothing is allocated.
            let reference = std::mem::take(&mut workspace.start);
            let refined = workspace.order.len().min(REFINED);
            for turn in 0..refined {
                if turn > 0 && query.is_late() {
                    found.termination = Termination::TimeLimit;
                    break;
                }
                let place = workspace.order[turn].1;
                workspace.stand_at_found(place);
                self.descend(workspace, &reference, query.deadline);
                let distance = self.distance(&workspace.x, &reference);
                if distance < best {
                    best = distance;
                    found.number = place;
                    workspace.best.copy_from_slice(&workspace.x);
                }
            }
            workspace.start = reference;
            workspace.x.copy_from_slice(&workspace.best);
        }
        self.judge(workspace, &mut found);
        found
    }

    /// The first `k` solutions that are farther than `distance` from those before. `ended` is the termination of the
    /// attempts.
    pub(super) fn distinct(
        &self,
        workspace: &mut ArmWorkspace,
        k: usize,
        distance: f64,
        ended: Termination,
    ) -> Vec<Solution> {
        let mut chosen: Vec<Solution> = Vec::new();
        for turn in 0..workspace.order.len() {
            if chosen.len() >= k {
                break;
            }
            let place = workspace.order[turn].1;
            let q = workspace.found_at(place);
            let apart = |other: &Solution| self.distance(q, &other.q) > distance;
            if !chosen.iter().all(apart) {
                continue;
            }
            let outcome = &workspace.outcomes[place];
            let mut solution = Solution::default();
            solution.q.extend_from_slice(q);
            let found = SearchResult {
                termination: ended,
                ..self.found_by(outcome)
            };
            self.record(&found, Errors::of(outcome), &mut solution);
            chosen.push(solution);
        }
        chosen
    }

    /// Weighted distance of two configurations.
    pub(super) fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let weighted = a.iter().zip(b).zip(&self.options.weights);
        let squares = weighted.map(|((a, b), w)| (w * (a - b)) * (w * (a - b)));
        squares.sum::<f64>().sqrt()
    }
}

/// Iterations of all attempts together.
pub(super) fn spent(outcomes: &[PoseOutcome]) -> usize {
    outcomes.iter().map(|o| o.iterations as usize).sum()
}
