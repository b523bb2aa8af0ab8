//! `kinopt bench`: comparison of solvers.

mod arguments;
mod interrupt;
mod problems;
mod provenance;

pub(crate) use arguments::Arguments;
use interrupt::Interrupt;
use kinopt_harness::{Bench, Results, Run, contenders, jacobian_cost, profile, report};
use serde_json::json;

use crate::failure::Outcome;
use crate::loaded_model::LoadedModel;
use crate::output;
use crate::progress::Countdown;
use crate::table::Table;

pub(crate) fn run(arguments: &Arguments, json: bool) -> Outcome<()> {
    let interrupt = Interrupt::listen()?;
    let settings = arguments.model_options.problem()?.model;
    let loaded = LoadedModel::read(&arguments.model, &settings)?;
    let set = problems::problems(&loaded, arguments)?;
    if arguments.charted >= set.cases().len() {
        return Err(usage!(
            "--charted {}: there are {} problems, counted from 0",
            arguments.charted,
            set.cases().len()
        ));
    }
    // Fails before the work if the folder cannot be created.
    output::make_folder(&arguments.out)?;
    let mut bench = Bench::new(&set, arguments.budget()).with_chosen(arguments.charted);
    let solvers = contenders::all().into_iter();
    bench.extend(solvers.filter(|solver| arguments.wants(solver.name())));
    let mut results = compare(&mut bench, &interrupt)?;
    if results.problems == 0 {
        return Err(failure!("interrupted before the first problem was done"));
    }
    if !interrupt.is_interrupted() {
        let mut flow = || interrupt.flow();
        results.jacobian_cost = jacobian_cost::measure(arguments.bones, &mut flow)?;
    }
    results.provenance = provenance::provenance();
    if let (Some(_), Some(stem)) = (&loaded.rig, arguments.model.file_stem()) {
        // The name of a rig is the path of its file.
        results.model.name = stem.to_string_lossy().into_owned();
    }
    report::write(&results, &arguments.out)?;
    if interrupt.is_interrupted() {
        let (done, total) = (results.problems, results.setting.problems);
        output::message(&format!(
            "interrupted: {done} of {total} problems are done and written"
        ));
    }
    let text = || text(&results, arguments);
    output::result(json, || document(&results, arguments), text)
}

fn compare(bench: &mut Bench<'_>, interrupt: &Interrupt) -> Outcome<Results> {
    let mut countdown: Option<Countdown> = None;
    let results = bench.run(&mut |progress| {
        match &countdown {
            Some(countdown) => countdown.one_more(),
            None => countdown = Some(Countdown::new(progress.total, "solves")),
        }
        interrupt.flow()
    });
    Ok(results?)
}

fn document(results: &Results, arguments: &Arguments) -> serde_json::Value {
    let runs = results.runs.iter().map(|run| {
        json!({
            "solver": run.solver,
            "jacobian": run.route,
            "sat_out": run.sat_out,
            "solved": run.solved(),
            "micros_median": median(run),
        })
    });
    json!({
        "out": arguments.out.display().to_string(),
        "problems": results.problems,
        "interrupted": results.problems < results.setting.problems,
        "runs": runs.collect::<Vec<_>>(),
    })
}

/// Median time of the solved problems, in microseconds.
fn median(run: &Run) -> Option<f64> {
    let records = run.records.iter();
    profile::median(records.filter_map(|record| record.solved_micros()))
}

fn text(results: &Results, arguments: &Arguments) -> String {
    let mut table = Table::new("solver | derivatives | >solved | >median µs");
    let mut notes = String::new();
    for run in &results.runs {
        if let Some(why) = &run.sat_out {
            notes.push_str(&format!("  {} skipped: {why}\n", run.solver));
            continue;
        }
        table.row([
            run.solver.clone(),
            run.route.clone().unwrap_or_default(),
            format!("{} of {}", run.solved(), results.problems),
            median(run).map_or("–".to_owned(), |micros| format!("{micros:.1}")),
        ]);
    }
    format!(
        "{}{notes}written: {}\n",
        table.text(),
        arguments.out.join("results.md").display()
    )
}
