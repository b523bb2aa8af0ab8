//! Results as Markdown.

use std::fmt::Write as _;

use super::choice::{self, is_better};
use crate::profile::median;
use crate::{Record, Results, Run};

/// Report in Markdown: provenance, problem set, table of all runs, times to accuracies, cost of Jacobians, and settings
/// of the solvers.
#[must_use]
pub fn markdown(results: &Results) -> String {
    // Writing into a string cannot fail.
    let mut text = String::new();
    let _ = write!(text, "{}", heading(results));
    let _ = write!(text, "{}", all_runs(results));
    let _ = write!(text, "{}", accuracies(results));
    let _ = write!(text, "{}", jacobians(results));
    let _ = write!(text, "{}", settings(results));
    text
}

fn heading(results: &Results) -> String {
    let (model, setting, provenance) = (&results.model, &results.setting, &results.provenance);
    let what = if model.turns {
        "position and orientation"
    } else {
        "position"
    };
    let mut text = format!(
        "# Solvers compared on {}\n\n{} variables, size {:.4}; targets for the {what} of {}. \
         {} problems of {}, seed {}. A problem is solved if every target is within {:e} of the size{}, \
         and every joint is exactly within its limits. Both are checked by forward kinematics at the \
         returned configuration. Each solver has {} ms for a problem, and {} attempts if it has no \
         restarts.\n\n",
        model.name,
        model.variables,
        model.size,
        model.frames.join(", "),
        results.problems,
        setting.problems,
        setting.seed,
        setting.tolerance,
        if model.turns {
            " and the same number of radians"
        } else {
            ""
        },
        setting.time_limit * 1e3,
        setting.attempts,
    );
    let machine = &provenance.machine;
    if !provenance.tool.is_empty() {
        let _ = write!(
            text,
            "{} on {} ({} threads), {}. Times are {}.\n\n",
            provenance.tool, machine.cpu, machine.cores, provenance.date, setting.clock
        );
    }
    if !provenance.command.is_empty() {
        let _ = write!(text, "`{}`\n\n", provenance.command);
    }
    text
}

fn all_runs(results: &Results) -> String {
    let mut text = String::from(
        "## All solvers by all derivative routes\n\nTimes, steps and evaluations are medians over \
         the solved problems, with times in microseconds; `p90` is the 90th percentile. Misses: the median error of all \
         other problems, relative to the size or in radians. On a limit: solved with a joint on its limit. \
         Late: results after the time limit, which are discarded.\n\n\
         | solver | derivatives | solved | µs | p90 µs | steps | residuals | Jacobians | gradients | misses | on a limit | late |\n\
         |---|---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
    );
    let mut runs: Vec<&Run> = choice::active(results).collect();
    runs.sort_by(|a, b| is_better(b, a).cmp(&is_better(a, b)));
    for run in runs {
        let middle = |number: fn(&Record) -> usize| {
            let solved = run.records.iter().filter(|record| record.counts());
            short(median(solved.map(|record| number(record) as f64)))
        };
        let times = || run.records.iter().filter_map(Record::solved_micros);
        let missed = run.records.iter().filter(|record| !record.counts());
        let limited = |record: &&Record| record.counts() && !record.active_limits.is_empty();
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} | {} |",
            run.solver,
            run.route.as_deref().unwrap_or("–"),
            percent(run.solved(), results.problems),
            short(median(times())),
            short(percentile(times(), 0.9)),
            middle(|record| record.iterations),
            middle(|record| record.residuals),
            middle(|record| record.jacobians),
            middle(|record| record.gradients),
            missed_by(missed.filter_map(|record| record.error)),
            percent(run.records.iter().filter(limited).count(), results.problems),
            run.records.iter().filter(|record| record.late).count(),
        );
    }
    text.push('\n');
    text
}

fn accuracies(results: &Results) -> String {
    let thresholds = &results.setting.accuracies;
    let mut text = String::from(
        "## Time to each accuracy\n\nEach solver by its best route: the share of problems with an error \
         below this fraction of the size (or this number of radians), and the median time until then \
         in microseconds.\n\n| solver |",
    );
    for accuracy in thresholds {
        let _ = write!(text, " {accuracy:e} |");
    }
    text.push_str("\n|---|");
    text.push_str(&"---:|".repeat(thresholds.len()));
    text.push('\n');
    for run in choice::best_routes(results) {
        let untraced = if run.traced { "" } else { " *" };
        let _ = write!(text, "| {}{untraced} |", run.title());
        for level in 0..thresholds.len() {
            let at = |record: &Record| record.micros_to.get(level).copied().flatten();
            let times: Vec<f64> = run.records.iter().filter_map(at).collect();
            let share = percent(times.len(), results.problems);
            let _ = write!(text, " {share}, {} |", short(median(times.into_iter())));
        }
        text.push('\n');
    }
    if choice::best_routes(results).iter().any(|run| !run.traced) {
        text.push_str("\n\\* measured at the end only.\n");
    }
    text.push('\n');
    text
}

fn jacobians(results: &Results) -> String {
    let costs = &results.jacobian_cost;
    let Some(first) = costs.first().filter(|cost| !cost.points.is_empty()) else {
        return String::new();
    };
    let mut text = String::from(
        "## One Jacobian\n\nA chain of m bones with three free angles each and a target for its tip, in \
         microseconds. The last row is p in cost ∝ mᵖ, from the longest chain and the one a quarter as \
         long.\n\n| bones |",
    );
    for cost in costs {
        let _ = write!(text, " {} |", cost.route);
    }
    text.push_str("\n|---:|");
    text.push_str(&"---:|".repeat(costs.len()));
    text.push('\n');
    for (row, (bones, _)) in first.points.iter().enumerate() {
        let _ = write!(text, "| {bones} |");
        for cost in costs {
            let micros = cost.points.get(row).map(|(_, micros)| *micros);
            let _ = write!(text, " {} |", short(micros));
        }
        text.push('\n');
    }
    text.push_str("| p |");
    for cost in costs {
        let p = cost
            .exponent()
            .map_or("–".to_owned(), |p| format!("{p:.2}"));
        let _ = write!(text, " {p} |");
    }
    text.push_str("\n\n");
    text
}

fn settings(results: &Results) -> String {
    let mut text = String::from("## The solvers\n\n");
    let mut listed: Vec<&str> = Vec::new();
    for run in &results.runs {
        if listed.contains(&run.solver.as_str()) {
            continue;
        }
        listed.push(&run.solver);
        let _ = match &run.sat_out {
            Some(why) => writeln!(text, "- **{}** does not apply: {why}", run.solver),
            None if run.about.is_empty() => writeln!(text, "- **{}**", run.solver),
            None => writeln!(text, "- **{}**: {}", run.solver, run.about),
        };
    }
    text
}

fn percent(part: usize, whole: usize) -> String {
    format!("{:.0} %", 100.0 * part as f64 / whole.max(1) as f64)
}

fn percentile(numbers: impl Iterator<Item = f64>, share: f64) -> Option<f64> {
    let mut sorted: Vec<f64> = numbers.collect();
    sorted.sort_by(f64::total_cmp);
    let rank = (share * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).copied()
}

fn missed_by(errors: impl Iterator<Item = f64>) -> String {
    median(errors).map_or("–".to_owned(), |error| format!("{error:.1e}"))
}

/// Number with three digits, or a whole number.
fn short(number: Option<f64>) -> String {
    match number {
        None => "–".to_owned(),
        Some(number) if number == number.round() => format!("{number}"),
        Some(number) if number >= 100.0 => format!("{number:.0}"),
        Some(number) if number >= 10.0 => format!("{number:.1}"),
        Some(number) => format!("{number:.2}"),
    }
}
