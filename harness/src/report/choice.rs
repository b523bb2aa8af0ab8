//! Selection of runs for tables and pictures.

use crate::profile::median;
use crate::{Results, Run};

/// Largest number of lines in one chart.
const MAX_CHART_LINES: usize = 7;

/// One panel of a picture: its title and its runs.
pub(super) struct Panel<'r> {
    pub(super) title: String,
    pub(super) runs: Vec<&'r Run>,
}

/// True if `a` solved more, or as many in a lower median time.
pub(super) fn is_better(a: &Run, b: &Run) -> bool {
    let time = |run: &Run| {
        let times = run
            .records
            .iter()
            .filter_map(|record| record.solved_micros());
        median(times).unwrap_or(f64::INFINITY)
    };
    (a.solved(), time(b)) > (b.solved(), time(a))
}

/// Runs with records.
pub(super) fn active(results: &Results) -> impl Iterator<Item = &Run> {
    results.runs.iter().filter(|run| !run.records.is_empty())
}

/// Each solver with its best derivative mode, in the order of the results.
pub(super) fn best_routes(results: &Results) -> Vec<&Run> {
    let mut best: Vec<&Run> = Vec::new();
    for run in active(results) {
        match best.iter_mut().find(|known| known.solver == run.solver) {
            Some(known) if is_better(run, known) => *known = run,
            Some(_) => {}
            None => best.push(run),
        }
    }
    best
}

/// Best modes by family, with small families merged, and few lines in each panel.
pub(super) fn panels(results: &Results) -> Vec<Panel<'_>> {
    let mut panels: Vec<Panel<'_>> = Vec::new();
    let best = best_routes(results);
    for family in best.chunk_by(|a, b| a.family == b.family) {
        for lines in family.chunks(MAX_CHART_LINES) {
            let title = lines.first().map_or("", |run| &run.family);
            match panels.last_mut() {
                Some(last) if last.runs.len() + lines.len() <= MAX_CHART_LINES => {
                    if !last.title.ends_with(title) {
                        last.title = format!("{}, {title}", last.title);
                    }
                    last.runs.extend(lines);
                }
                _ => panels.push(Panel {
                    title: title.to_owned(),
                    runs: lines.to_vec(),
                }),
            }
        }
    }
    panels
}
