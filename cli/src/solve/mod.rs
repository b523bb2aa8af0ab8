//! From targets to configurations: `kinopt solve`, `body`, `batch`, `track` and `servo`.

pub(crate) mod arguments;
mod arm_backend;
pub(crate) mod axis_intervals;
mod backend;
mod balance;
pub(crate) mod base;
pub(crate) mod body;
mod derivative;
mod general_backend;
mod goals;
mod held_frames;
pub(crate) mod levels;
mod locked_joints;
pub(crate) mod many;
mod max_move;
pub(crate) mod obstacles;
pub(crate) mod one;
mod out_file;
mod pose_finder;
mod query;
mod report;
mod settings;
pub(crate) mod task_name;
mod weights;

use std::path::Path;

use arguments::QueryArguments;
use arm_backend::ArmBackend;
pub(crate) use arm_backend::held;
use backend::QueryBackend;
use general_backend::GeneralBackend;
use goals::Goals;
use many::batch::BatchOptions;
use many::servo_arguments::ServoOptions;
use one::OutputFiles;
use query::Query;
use report::Report;

use crate::failure::{Failure, Outcome};
use crate::loaded_model::LoadedModel;
use crate::output;
use crate::problem::Problem;
use crate::progress::Progress;

/// Kind of a query, with the options of its subcommand.
#[derive(Clone, Copy, Debug)]
enum Mode<'a> {
    /// One set of targets.
    One(&'a OutputFiles),
    /// Independent targets of a file.
    Batch(&'a Path, &'a BatchOptions),
    /// Targets of a file, each from the solution of the one before.
    Track(&'a Path),
    /// Targets of a file, one a control cycle.
    Servo(&'a Path, &'a ServoOptions),
}

/// Query of a subcommand.
#[derive(Clone, Copy, Debug)]
struct Job<'a> {
    model: &'a Path,
    problem: &'a Problem,
    mode: Mode<'a>,
    /// True if angles of the command line are in degrees.
    degrees: bool,
    fail_on_miss: bool,
}

impl<'a> Job<'a> {
    fn new(query: &'a QueryArguments, problem: &'a Problem, mode: Mode<'a>) -> Self {
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
            Mode::Batch(file, _) | Mode::Track(file) | Mode::Servo(file, _) => Some(file),
        }
    }

    /// Solves the query and prints the result.
    fn run(&self, json: bool) -> Outcome<()> {
        self.check_settings()?;
        let problem = self.problem;
        let mut loaded = LoadedModel::read_at(self.model, &problem.model, problem.moment())?;
        problem.read_srdf(&mut loaded)?;
        problem.lock_joints(&mut loaded)?;
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
        let answer = backend.answer(&mut B::Workspace::default(), query, &mut progress)?;
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
            keeps_clear: self.problem.collisions.given().is_some(),
        };
        let text = || report.text(self.degrees);
        output::result(json, || report.whole_document(notes), text)?;
        if let Some(path) = written {
            output::message(&format!("wrote {}", path.display()));
        }
        self.fail_on_misses(usize::from(!answer.solution.reached), 1)
    }

    /// Returns an error with its own exit code if --fail-on-miss is given and targets are not reached.
    fn fail_on_misses(&self, missed: usize, targets: usize) -> Outcome<()> {
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
