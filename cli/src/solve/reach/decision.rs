//! Decisions for all pairs of tool and target: a goal set, then a proof for each target that it does not reach.

use std::time::Instant;

use kinopt::Arm;
use kinopt::arm::{GoalSet, GoalSetSolution, GoalStatus, Reachability};
use kinopt::spatial::Placement;
use rayon::prelude::*;

use super::options::ReachOptions;
use super::report::{Decision, Report, Status};
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::output;
use crate::solve::arm_backend::ArmBackend;
use crate::solve::backend::microseconds;
use crate::solve::query::Query;

/// Largest number of boxes of a proof, by default.
const MAX_BOXES: usize = 20_000;

/// Decides the queries for all tools, and prints the report. Returns the number of targets that no tool reaches.
pub(in super::super) fn run(
    loaded: &LoadedModel,
    backend: &ArmBackend<'_>,
    (queries, tools, options): (&[Query], &[Placement<f64>], &ReachOptions),
    (degrees, json): (bool, bool),
) -> Outcome<usize> {
    let Some(first) = queries.first() else {
        return Ok(0);
    };
    if queries.iter().any(|query| query.start != first.start) {
        return Err(usage!(
            "--targets: the file has `starts`; kinopt reach has one start for all targets: --start"
        ));
    }
    let arm = backend.arm();
    let arms: Vec<Arm> = match tools {
        [] | [_] => vec![arm.clone()],
        tools => {
            let arms = tools.iter().map(|tool| arm.with_tool(*tool));
            arms.collect::<Result<_, _>>()?
        }
    };
    let mut start = Vec::new();
    arm.joint_values(&first.start, &mut start)?;
    let targets: Vec<_> = queries.iter().map(|query| backend.target(query)).collect();
    let ranked_by = options.criterion.unwrap_or_default();
    let search = Search {
        set: GoalSet::new(arms),
        start,
        targets,
        max_boxes: options.max_boxes.map_or(MAX_BOXES, |boxes| boxes as usize),
    };
    let started = Instant::now();
    let (solution, decisions) = search.on_threads(options)?;
    let micros = microseconds(started);
    let report = Report {
        loaded,
        joints: backend.joint_names(),
        ranked_by,
        ranking: solution.ranking(),
        configuration: &|q| backend.configuration(first, q),
        decisions,
        targets: queries.len(),
        degrees,
        micros,
    };
    if let Some(out) = &options.out {
        out.write(&report)?;
    }
    let document = report.document()?;
    output::result(json, || document, || report.text())?;
    if let Some(out) = &options.out {
        output::message(&format!("wrote {}", out.path().display()));
    }
    Ok(report.missed_targets())
}

/// Goal set with its start and its targets.
struct Search {
    set: GoalSet,
    start: Vec<f64>,
    targets: Vec<Placement<f64>>,
    max_boxes: usize,
}

impl Search {
    /// Solves the goal set and proves its misses, on the threads of the options.
    fn on_threads(&self, options: &ReachOptions) -> Outcome<(GoalSetSolution, Vec<Decision>)> {
        let criterion = options.criterion.unwrap_or_default().criterion();
        let starts = vec![self.start.clone(); self.set.arms().len()];
        let Some(threads) = options.threads else {
            let solution = self.set.solve(&self.targets, &starts, criterion)?;
            let pairs = self.pairs().into_iter();
            let decisions = pairs.map(|pair| self.decision(&solution, pair));
            let decisions = decisions.collect::<Outcome<_>>()?;
            return Ok((solution, decisions));
        };
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let threads = cores.min(threads.into());
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        pool.build()?.install(|| {
            let set = &self.set;
            let solution = set.solve_parallel(&self.targets, &starts, criterion)?;
            let pairs = self.pairs().into_par_iter();
            let decisions = pairs.map(|pair| self.decision(&solution, pair));
            let decisions = decisions.collect::<Outcome<_>>()?;
            Ok((solution, decisions))
        })
    }

    /// Indices of tool and target of all decisions, in order.
    fn pairs(&self) -> Vec<(usize, usize)> {
        let tools = 0..self.set.arms().len();
        let pairs = tools.flat_map(|tool| (0..self.targets.len()).map(move |goal| (tool, goal)));
        pairs.collect()
    }

    /// Decision of a pair: the goal set's configuration, or a proof, or the closest pose.
    fn decision(
        &self,
        solution: &GoalSetSolution,
        (tool, target): (usize, usize),
    ) -> Outcome<Decision> {
        let outcome = solution.outcome(tool, target);
        let q = solution.configuration(tool, target).unwrap_or_default();
        if outcome.status == GoalStatus::Reached {
            return Ok(Decision {
                tool,
                target,
                status: Status::Reached,
                q: q.to_vec(),
                cost: Some(outcome.cost),
                boxes: 0,
                position_error: outcome.position_error,
                orientation_error: outcome.orientation_error,
                explanation: None,
            });
        }
        let Some((arm, goal)) = self.set.arms().get(tool).zip(self.targets.get(target)) else {
            return Err(failure!("no tool {tool} and target {target}"));
        };
        let answer = arm.reachability(*goal, &self.start, self.max_boxes)?;
        let boxes = answer.boxes();
        let status = match (&answer, outcome.status) {
            (Reachability::Reachable(_), _) => Status::Reached,
            (Reachability::Unreachable { .. }, _) => Status::Unreachable,
            (_, GoalStatus::InCollision) => Status::InCollision,
            _ => Status::Undecided,
        };
        let closest = answer.solution();
        let task = closest.tasks().next();
        Ok(Decision {
            tool,
            target,
            status,
            q: closest.q.clone(),
            cost: None,
            boxes,
            position_error: task
                .and_then(|task| task.position_error())
                .unwrap_or_default(),
            orientation_error: task
                .and_then(|task| task.orientation_error())
                .unwrap_or_default(),
            explanation: Some(closest.explain()),
        })
    }
}
