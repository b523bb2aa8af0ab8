//! Query of a solving subcommand.

use std::path::Path;

use kinopt::spatial::Placement;
use kinopt_bindings::problem_file::ProblemSettings;

use super::arguments::{BatchOptions, QueryArguments, ServoOptions};
use super::arm_backend::ArmBackend;
use super::backend::QueryBackend;
use super::general_backend::GeneralBackend;
use super::goals::Goals;
use super::many;
use super::obstacles;
use super::out_file::{self, OutputFiles};
use super::query::Query;
use super::reach::decision;
use super::reach::options::ReachOptions;
use super::report::Report;
use super::settings::moment;
use crate::failure::{Failure, Outcome};
use crate::loaded_model::LoadedModel;
use crate::output;
use crate::progress::Progress;

/// Kind of a query, with the options of its subcommand.
#[derive(Clone, Copy, Debug)]
pub(super) enum Mode<'a> {
    /// One set of targets.
    One(&'a OutputFiles),
    /// Independent targets of a file.
    Batch(&'a Path, &'a BatchOptions),
    /// Targets of a file, each from the solution of the one before.
    Track(&'a Path),
    /// Targets of a file, one a control cycle.
    Servo(&'a Path, &'a ServoOptions),
    /// Reachability of one target or those of a file, for several tools.
    Reach(Option<&'a Path>, &'a ReachOptions, &'a [Placement<f64>]),
}

/// Query of a subcommand.
#[derive(Clone, Copy, Debug)]
pub(super) struct Job<'a> {
    model: &'a Path,
    pub(super) problem: &'a ProblemSettings,
    pub(super) mode: Mode<'a>,
    /// True if angles of the command line are in degrees.
    degrees: bool,
    fail_on_miss: bool,
}

impl<'a> Job<'a> {
    pub(super) fn new(
        query: &'a QueryArguments,
        problem: &'a ProblemSettings,
        mode: Mode<'a>,
    ) -> Self {
        Self {
            model: &query.model,
            problem,
            mode,
            degrees: query.degrees,
            fail_on_miss: query.fail_on_miss,
        }
    }

    /// File of targets.
    fn targets_file(&self) -> Option<&'a Path> {
        match self.mode {
            Mode::One(_) => None,
            Mode::Reach(file, ..) => file,
            Mode::Batch(file, _) | Mode::Track(file) | Mode::Servo(file, _) => Some(file),
        }
    }

    /// Solves the query and prints the result.
    pub(super) fn run(&self, json: bool) -> Outcome<()> {
        self.check_settings()?;
        let problem = self.problem;
        let mut loaded = LoadedModel::read_at(self.model, &problem.model, moment(&problem.model))?;
        loaded.read_srdf(&problem.model)?;
        loaded.lock_joints(problem)?;
        let goals = Goals::read(&loaded, problem, self.targets_file())?;
        goals.put_tool(&mut loaded)?;
        let loaded = &loaded;
        let Some(robot) = self.robot_with_arm(loaded, &goals)? else {
            let general = GeneralBackend::new(loaded, problem, &goals)?;
            return self.solve(loaded, &goals, &general, json);
        };
        let arm = ArmBackend::new(loaded, robot, problem, &goals)?;
        match self.mode {
            Mode::Servo(_, options) => {
                let queries = goals.queries(loaded, &arm)?;
                many::servo::run(self, loaded, &arm, (&queries, options), json)
            }
            Mode::Reach(_, options, tools) => {
                let queries = goals.queries(loaded, &arm)?;
                let decided = (queries.as_slice(), tools, options);
                let missed = decision::run(loaded, &arm, decided, (self.degrees, json))?;
                self.fail_on_misses(missed, queries.len())
            }
            _ => self.solve(loaded, &goals, &arm, json),
        }
    }

    /// Solves one query or a file of queries, and prints the results.
    fn solve(
        &self,
        loaded: &LoadedModel,
        goals: &Goals<'_>,
        backend: &impl QueryBackend,
        json: bool,
    ) -> Outcome<()> {
        let queries = goals.queries(loaded, backend)?;
        match (self.mode, queries.as_slice()) {
            (Mode::One(files), [query]) => self.one(loaded, backend, (query, files), json),
            (_, queries) => many::run(self, loaded, backend, queries, json),
        }
    }

    fn one<B: QueryBackend>(
        &self,
        loaded: &LoadedModel,
        backend: &B,
        (query, files): (&Query, &OutputFiles),
        json: bool,
    ) -> Outcome<()> {
        // Checked before the search, but after all names, because computing skin weights is slow.
        let settings = &self.problem.output;
        let name = settings.clip_name.as_deref();
        let written = match (&files.into, &files.out) {
            (Some(into), _) => Some(out_file::added(into, name, loaded)?),
            (None, Some(out)) => Some(out.of(loaded, settings.skin_weights)?),
            (None, None) => None,
        };
        let mut progress = Progress::new();
        let mut answer = backend.answer(&mut B::Workspace::default(), query, &mut progress)?;
        answer.self_motions = backend.self_motions(query)?;
        drop(progress);
        let mut notes = loaded.notes();
        notes.extend(written.as_ref().and_then(|written| written.note()));
        let written = written.as_ref();
        let written = written
            .map(|written| written.write(&answer.q, settings.skinning.unwrap_or_default()))
            .transpose()?;
        let report = Report {
            loaded,
            answer: &answer,
            tasks: backend.tasks(),
            idle: backend.idle_coordinates(),
            keeps_clear: obstacles::given(&self.problem.collisions).is_some(),
        };
        let text = || report.text(self.degrees);
        output::result(json, || report.whole_document(notes), text)?;
        if let Some(path) = written {
            output::message(&format!("wrote {}", path.display()));
        }
        self.fail_on_misses(usize::from(!answer.solution.reached), 1)
    }

    /// Returns an error with its own exit code if --fail-on-miss is given and targets are not reached.
    pub(super) fn fail_on_misses(&self, missed: usize, targets: usize) -> Outcome<()> {
        if missed == 0 || !self.fail_on_miss {
            return Ok(());
        }
        let what = match targets {
            1 => "the target was not reached".to_owned(),
            _ => format!("{missed} of {targets} targets were not reached"),
        };
        Err(Failure::Missed(what))
    }
}
