//! Many targets of one frame, from a file.

pub(crate) mod batch;
pub(super) mod servo;
pub(crate) mod servo_arguments;
mod summary;
pub(crate) mod track;

use self::summary::Outcomes;
use super::backend::QueryBackend;
use super::job::{Job, Mode};
use super::obstacles::given;
use super::query::Query;
use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::output;
use crate::progress::Countdown;

/// Solves all queries as the subcommand says, and prints the results.
pub(super) fn run(
    job: &Job<'_>,
    loaded: &LoadedModel,
    backend: &impl QueryBackend,
    queries: &[Query],
    json: bool,
) -> Outcome<()> {
    let outcomes = answer(job, backend, queries)?;
    output::result(json, || outcomes.document(loaded), || outcomes.text(loaded))?;
    let answers = &outcomes.answers;
    let missed = answers.iter().filter(|answer| !answer.solution.reached);
    job.fail_on_misses(missed.count(), answers.len())
}

fn answer<'b>(
    job: &Job<'_>,
    backend: &'b impl QueryBackend,
    queries: &[Query],
) -> Outcome<Outcomes<'b>> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    // At most one thread for each target and core.
    let max_threads = cores.min(queries.len()).max(1);
    let (together, threads) = match job.mode {
        Mode::Batch(_, options) => (options.together, options.threads),
        _ => (false, None),
    };
    let threads = threads.map(|threads| max_threads.min(threads.into()));
    let pool = threads.map(|threads| {
        let builder = rayon::ThreadPoolBuilder::new().num_threads(threads);
        builder.build()
    });
    let pool = pool.transpose()?;
    let countdown = Countdown::new(queries.len(), "targets");
    let answered = || countdown.one_more();
    let (mut jumps, mut batch_micros) = (None, None);
    let answers = if together {
        let (answers, micros) = match &pool {
            Some(pool) => pool.install(|| backend.batch(queries, true))?,
            None => backend.batch(queries, false)?,
        };
        batch_micros = Some(micros);
        answers
    } else if let Mode::Track(_) = job.mode {
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
        keeps_clear: given(&job.problem.collisions).is_some(),
        batch_micros,
    })
}
