//! Asks every adapter every case by every route.

mod measured;

use std::ops::ControlFlow;

use kinopt::problem::Derivatives;

use self::measured::{Judged, Measured};
use crate::clock;
use crate::problem_set::SetProblem;
use crate::route::route_name;
use crate::{
    Adapter, Budget, ConvergenceHistory, HarnessError, Judge, ModelSummary, ProblemSet, Provenance,
    Question, Results, Run, Setting,
};

/// How far a bench has come; measured between two answers, so no time that is taken holds it.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Answers so far.
    pub answered: usize,
    /// Answers in all.
    pub total: usize,
    /// The solver that is next.
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
    /// A comparison without adapters.
    #[must_use]
    pub fn new(set: &'s ProblemSet, budget: Budget) -> Self {
        Self {
            set,
            budget,
            chosen: 0,
            adapters: Vec::new(),
        }
    }

    /// Keeps the course of the cost through this case, counted from 0. Default: the first.
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

    /// Asks everyone everything, problem by problem. `progress` is told before each answer and may
    /// break: what is done is kept, up to the last problem that every solver was measured.
    ///
    /// # Errors
    /// No cases; a problem that cannot be problem.
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
            let mut row = Vec::with_capacity(active.len());
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
                let question = Question {
                    set: self.set,
                    problem: problem.question()?,
                    targets: &case.targets,
                    start: &case.start,
                    budget: self.budget,
                    seed: self.set.seed_of_case(index),
                };
                let measured = Measured::new(&mut **adapter, &question);
                let accuracies = &results.setting.accuracies;
                row.push((
                    entry.run,
                    measured.judged(index, &question, &mut judge, accuracies),
                ));
                answered += 1;
            }
            for (run, judged) in row {
                results.keep(run, judged, index == self.chosen);
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

    /// A run for each adapter and route; those that cannot take part say why.
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
                    // Its routes do not matter.
                    break;
                }
            }
        }
        entries
    }
}

/// An adapter at work by one route.
struct Entry {
    adapter: usize,
    route: Option<Derivatives>,
    /// Its position in the results.
    run: usize,
    takes_part: bool,
}

/// From a tenth of the size down to the tolerance, decade by decade.
fn accuracies(tolerance: f64) -> Vec<f64> {
    let decades = (1..16).map(|k| 10_f64.powi(-k));
    let coarser = decades.take_while(|&accuracy| accuracy > 1.001 * tolerance);
    coarser.chain([tolerance]).collect()
}

impl Results {
    fn keep(&mut self, run: usize, judged: Judged, chosen: bool) {
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
