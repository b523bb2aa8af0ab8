//! `--targets`: several independent targets of one frame, a path, or the targets of a servo.

pub(super) mod servo;
mod summary;

use self::summary::Outcomes;
use super::arguments::Arguments;
use super::backend::QueryBackend;
use super::query::Query;
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::output;
use crate::progress::Countdown;

/// Solves all queries as the arguments say, and prints the results.
pub(super) fn run(
    loaded: &LoadedModel,
    arguments: &Arguments,
    backend: &impl QueryBackend,
    queries: &[Query],
    json: bool,
) -> Outcome<()> {
    let outcomes = answer(arguments, backend, queries)?;
    output::result(json, || outcomes.document(loaded), || outcomes.text(loaded))?;
    let answers = &outcomes.answers;
    let missed = answers.iter().filter(|answer| !answer.solution.reached);
    arguments.fail_on_misses(missed.count(), answers.len())
}

fn answer<'b>(
    arguments: &Arguments,
    backend: &'b impl QueryBackend,
    queries: &[Query],
) -> Outcome<Outcomes<'b>> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    // At most one thread for each target and core.
    let max_threads = cores.min(queries.len()).max(1);
    let threads = arguments
        .threads
        .map(|threads| max_threads.min(threads.into()));
    let pool = threads.map(|threads| {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
        builder.build()
    });
    let pool = pool.transpose()?;
    let countdown = Countdown::new(queries.len(), "targets");
    let answered = || countdown.one_more();
    let (mut jumps, mut batch_micros) = (None, None);
    let answers = if arguments.batch {
        let (answers, micros) = match &pool {
            Some(pool) => pool.install(|| backend.batch(queries, true))?,
            None => backend.batch(queries, false)?,
        };
        batch_micros = Some(micros);
        answers
    } else if arguments.track {
        let path = backend.path(queries, &answered)?;
        jumps = Some(path.jumps);
        path.answers
    } else {
        match &pool {
            Some(pool) => pool.install(|| backend.each(queries, true, &answered))?,
            None => backend.each(queries, false, &answered)?,
        }
    };
    Ok(Outcomes {
        answers,
        jumps,
        tasks: backend.tasks(),
        keeps_clear: arguments.obstacles.given().is_some(),
        batch_micros,
    })
}
