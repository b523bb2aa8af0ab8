//! Benches: every adapter on every case with every derivative mode.

mod measured;

use std::ops::ControlFlow;

use kinopt::problem::Derivatives;

use self::measured::{Judged, Measured};
use crate::clock;
use crate::problem_set::SetProblem;
use crate::route::route_name;
use crate::{
    Adapter, Budget, ConvergenceHistory, HarnessError, Judge, ModelSummary, ProblemInstance,
    ProblemSet, Provenance, Results, Run, Setting,
};

/// Progress of a bench; reported between two solves, outside all timing.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Number of finished solves.
    pub answered: usize,
    /// Total number of solves.
    pub total: usize,
    /// Name of the next solver.
    pub solver: &'a str,
}

/// A comparison: a problem set, a budget, and the adapters.
pub struct Bench<'s> {
    set: &'s ProblemSet,
    budget: Budget,
    chosen: usize,
    adapters: Vec<Box<dyn Adapter + 's>>,
}

impl<'s> Bench<'s> {
    /// Creates a comparison without adapters.
    #[must_use]
    pub fn new(set: &'s ProblemSet, budget: Budget) -> Self {
        Self {
            set,
            budget,
            chosen: 0,
            adapters: Vec::new(),
        }
    }

    /// Selects the case, counted from 0, whose convergence history is recorded. Default: the first.
    #[must_use]
    pub fn with_chosen(mut self, case: usize) -> Self {
        self.chosen = case;
        self
    }

    /// Adds a solver.
    pub fn add(&mut self, adapter: impl Adapter + 's) {
        self.adapters.push(Box::new(adapter));
    }

    /// Adds solvers.
    pub fn extend(&mut self, adapters: impl IntoIterator<Item = Box<dyn Adapter>>) {
        for adapter in adapters {
            self.adapters.push(adapter);
        }
    }

    /// Runs all solvers, problem by problem. `progress` is called before each solve and may break. The results then
    /// contain the problems that every solver has finished.
    ///
    /// # Errors
    /// Returns an error for a set without cases, and for an invalid problem.
    pub fn run(
        &mut self,
        progress: &mut dyn FnMut(Progress<'_>) -> ControlFlow<()>,
    ) -> Result<Results, HarnessError> {
        if self.set.cases().is_empty() {
            let model = self.set.model().name().to_owned();
            return Err(HarnessError::NoCases { model });
        }
        let mut problem = SetProblem::new(self.set)?;
        let mut judge = Judge::new(self.set)?;
        let mut results = self.empty_results();
        let routes = self.entries(&mut results);
        let active: Vec<_> = routes.iter().filter(|entry| entry.takes_part).collect();
        let total = active.len() * self.set.cases().len();
        let mut answered = 0;
        'problems: for (index, case) in self.set.cases().iter().enumerate() {
            problem.aim(case)?;
            let mut measurements = Vec::with_capacity(active.len());
            for entry in &active {
                let Some(adapter) = self.adapters.get_mut(entry.adapter) else {
                    continue;
                };
                let solver = adapter.name();
                let now = Progress {
                    answered,
                    total,
                    solver,
                };
                if progress(now).is_break() {
                    break 'problems;
                }
                problem.derive_by(entry.route.unwrap_or_default());
                let instance = ProblemInstance {
                    set: self.set,
                    problem: problem.instance()?,
                    targets: &case.targets,
                    start: &case.start,
                    budget: self.budget,
                    seed: self.set.seed_of_case(index),
                };
                let measured = Measured::new(&mut **adapter, &instance);
                let accuracies = &results.setting.accuracies;
                measurements.push((
                    entry.run,
                    measured.judged(index, &instance, &mut judge, accuracies),
                ));
                answered += 1;
            }
            for (run, judged) in measurements {
                results.add_record(run, judged, index == self.chosen);
            }
            results.problems = index + 1;
        }
        Ok(results)
    }

    fn empty_results(&self) -> Results {
        let set = self.set;
        Results {
            provenance: Provenance::default(),
            model: ModelSummary {
                name: set.model().name().to_owned(),
                variables: set.map().variables(),
                size: set.size(),
                frames: set.frame_names().map(str::to_owned).collect(),
                turns: set.turns(),
            },
            setting: Setting {
                problems: set.cases().len(),
                seed: set.seed(),
                tolerance: set.tolerance(),
                time_limit: self.budget.time_limit.as_secs_f64(),
                clock: clock::NAME.to_owned(),
                attempts: self.budget.attempts,
                accuracies: accuracies(set.tolerance()),
                chosen: self.chosen,
            },
            problems: 0,
            runs: Vec::new(),
            courses: Vec::new(),
            jacobian_cost: Vec::new(),
        }
    }

    /// Creates a run for each adapter and derivative mode; adapters that do not support the set have a reason.
    fn entries(&mut self, results: &mut Results) -> Vec<Entry> {
        let mut entries = Vec::new();
        for (position, adapter) in self.adapters.iter_mut().enumerate() {
            let sat_out = adapter.prepare(self.set, self.budget).err();
            let none: [Option<Derivatives>; 1] = [None];
            let some: Vec<_> = adapter.routes().iter().copied().map(Some).collect();
            let routes: &[Option<Derivatives>] = if some.is_empty() { &none } else { &some };
            for &route in routes {
                entries.push(Entry {
                    adapter: position,
                    route,
                    run: results.runs.len(),
                    takes_part: sat_out.is_none(),
                });
                results.runs.push(Run {
                    solver: adapter.name().to_owned(),
                    family: adapter.family().to_owned(),
                    route: route.map(|route| route_name(route).to_owned()),
                    about: adapter.setting(),
                    sat_out: sat_out.clone(),
                    traced: false,
                    records: Vec::new(),
                });
                if sat_out.is_some() {
                    // Its derivative modes do not matter.
                    break;
                }
            }
        }
        entries
    }
}

/// An adapter with a derivative mode.
struct Entry {
    adapter: usize,
    route: Option<Derivatives>,
    /// Index in the results.
    run: usize,
    takes_part: bool,
}

/// Accuracies from a tenth of the size down to the tolerance, decade by decade.
fn accuracies(tolerance: f64) -> Vec<f64> {
    let decades = (1..16).map(|k| 10_f64.powi(-k));
    let coarser = decades.take_while(|&accuracy| accuracy > 1.001 * tolerance);
    coarser.chain([tolerance]).collect()
}

impl Results {
    fn add_record(&mut self, run: usize, judged: Judged, chosen: bool) {
        let Some(run) = self.runs.get_mut(run) else {
            return;
        };
        run.traced |= !judged.course.is_empty();
        run.records.push(judged.record);
        if chosen {
            self.courses.push(ConvergenceHistory {
                solver: run.solver.clone(),
                route: run.route.clone(),
                points: judged.course,
            });
        }
    }
}
