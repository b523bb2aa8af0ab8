//! `kinopt solve`: from targets to a configuration.

mod arguments;
pub(crate) mod arm_arguments;
mod arm_backend;
pub(crate) mod axis_intervals;
mod backend;
mod balance;
pub(crate) mod base;
pub(crate) mod chain_arguments;
mod derivative;
mod general_backend;
mod goals;
mod held_frames;
pub(crate) mod interval;
mod levels;
mod many;
mod max_move;
pub(crate) mod obstacles;
mod out_file;
mod pose_finder;
mod query;
mod report;
mod settings;
mod task_file;
mod task_name;
mod weights;

pub(crate) use arguments::Arguments;
use arm_backend::ArmBackend;
pub(crate) use arm_backend::held;
use backend::QueryBackend;
use general_backend::GeneralBackend;
use goals::Goals;
use query::Query;
use report::Report;

use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::output;
use crate::progress::Progress;

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let moment = arguments.moment();
    let mut loaded = LoadedModel::read_at(&arguments.model, &arguments.model_options, moment)?;
    (arguments.chain).read_srdf(&mut loaded, &arguments.model_options)?;
    arguments.hold(&mut loaded)?;
    let goals = Goals::read(&loaded, arguments)?;
    goals.put_tool(&mut loaded)?;
    let loaded = &loaded;
    let Some(robot) = arguments.arm_of(loaded, &goals)? else {
        let general = GeneralBackend::new(loaded, arguments, &goals)?;
        return solve(loaded, arguments, &goals, &general, json);
    };
    let arm = ArmBackend::new(loaded, robot, arguments, &goals)?;
    match arguments.arm.servo {
        Some(rate) => {
            let queries = goals.queries(loaded, &arm)?;
            many::servo::run(loaded, &arm, arguments, &queries, rate, json)
        }
        None => solve(loaded, arguments, &goals, &arm, json),
    }
}

/// Solves one query or a file of queries, and prints the results.
fn solve(
    loaded: &LoadedModel,
    arguments: &Arguments,
    goals: &Goals<'_>,
    backend: &impl QueryBackend,
    json: bool,
) -> Outcome<()> {
    let queries = goals.queries(loaded, backend)?;
    match queries.as_slice() {
        [query] if arguments.file.is_none() => one(loaded, arguments, backend, query, json),
        queries => many::run(loaded, arguments, backend, queries, json),
    }
}

fn one<B: QueryBackend>(
    loaded: &LoadedModel,
    arguments: &Arguments,
    backend: &B,
    query: &Query,
    json: bool,
) -> Outcome<()> {
    // Checked before the search, but after all names, because computing skin weights is slow.
    let out = arguments.out.as_ref();
    let name = arguments.clip_name.as_deref();
    let written = match &arguments.into {
        Some(into) => Some(out_file::added(into, name, loaded)?),
        None => out
            .map(|out| out.of(loaded, arguments.skin_weights))
            .transpose()?,
    };
    let mut progress = Progress::new();
    let answer = backend.answer(&mut B::Workspace::default(), query, &mut progress)?;
    drop(progress);
    let mut notes = loaded.notes();
    notes.extend(written.as_ref().and_then(|written| written.note()));
    let written = written.as_ref();
    let written = written
        .map(|written| written.write(&answer.q, arguments.skinning))
        .transpose()?;
    let report = Report {
        loaded,
        answer: &answer,
        tasks: backend.tasks(),
        idle: backend.idle_coordinates(),
        keeps_clear: arguments.obstacles.given().is_some(),
    };
    let text = || report.text(arguments.degrees);
    output::result(json, || report.whole_document(notes), text)?;
    if let Some(path) = written {
        output::message(&format!("wrote {}", path.display()));
    }
    arguments.fail_on_misses(usize::from(!answer.solution.reached), 1)
}
