//! Pictures of results. Each solver is drawn with its best derivative mode, in a panel for each family.

use kinopt_charts::{Axis, Chart, Figure, Series, Style};

use super::choice::{self, Panel, panels};
use crate::profile::{performance_profile, share_within};
use crate::{Results, Run};

/// Number of solvers whose derivative modes are compared: those that solve the most.
const COMPARED_SOLVERS: usize = 4;
/// Costs below this fraction of the first are drawn at the edge.
const MIN_RELATIVE_COST: f64 = 1e-18;

fn percent(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    points
        .into_iter()
        .map(|(x, share)| (x, 100.0 * share))
        .collect()
}

fn solved_axis() -> Axis {
    Axis::linear("solved, %").range(0.0, 102.0)
}

/// Range of all points along x, widened for an axis.
fn span(curves: &[Vec<(f64, f64)>]) -> Option<(f64, f64)> {
    let xs = curves.iter().flatten().map(|(x, _)| *x);
    let (low, high) = xs.fold((f64::INFINITY, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
    (low > 0.0 && low <= high).then_some((low / 1.3, high * 1.3))
}

/// A chart for each panel, with common axes.
fn by_panel(
    title: String,
    panels: &[Panel<'_>],
    curves: &[Vec<(f64, f64)>],
    x: &str,
    y: Axis,
) -> Figure {
    let mut figure = Figure::new(title).columns(1);
    let x = match span(curves) {
        Some((low, high)) => Axis::log(x).range(low, high),
        None => Axis::log(x),
    };
    let mut curves = curves.iter();
    for (member, panel) in panels.iter().enumerate() {
        let mut chart = Chart::new(panel.title.clone()).x(x.clone()).y(y.clone());
        for (colour, (run, curve)) in panel.runs.iter().zip(&mut curves).enumerate() {
            // Without a line, the legend gives the reason.
            let name = match curve.is_empty() {
                true => format!("{}: none", run.title()),
                false => run.title(),
            };
            let series = Series::steps(name, curve.clone());
            chart = chart.with(series.style(Style::family(colour, member)));
        }
        figure = figure.chart(chart);
    }
    figure
}

fn times(run: &Run) -> impl Iterator<Item = f64> {
    run.records
        .iter()
        .filter_map(|record| record.solved_micros())
}

/// Fraction of problems that each solver has solved within a time.
#[must_use]
pub fn solved_over_time(results: &Results) -> Figure {
    let panels = panels(results);
    let runs = panels.iter().flat_map(|panel| &panel.runs);
    let curves: Vec<_> = runs
        .map(|run| percent(share_within(times(run), results.problems)))
        .collect();
    let title = format!("Solved over time: {}", results.model.name);
    by_panel(
        title,
        &panels,
        &curves,
        "time for one problem, µs",
        solved_axis(),
    )
}

/// Performance profile of Dolan and Moré.
#[must_use]
pub fn performance(results: &Results) -> Figure {
    let panels = panels(results);
    let runs = panels.iter().flat_map(|panel| &panel.runs);
    let times: Vec<Vec<Option<f64>>> = runs
        .map(|run| {
            run.records
                .iter()
                .map(|record| record.solved_micros())
                .collect()
        })
        .collect();
    let curves: Vec<_> = performance_profile(&times)
        .into_iter()
        .map(percent)
        .collect();
    let title = format!("Performance profile: {}", results.model.name);
    let x = "time, as a multiple of the fastest solver's on the same problem";
    by_panel(title, &panels, &curves, x, solved_axis())
}

/// The solvers that solve the most, each with all its derivative modes.
#[must_use]
pub fn routes(results: &Results) -> Figure {
    let mut best = choice::best_routes(results);
    best.retain(|run| run.route.is_some());
    // Stable sort: equal runs keep the order of the results.
    best.sort_by_key(|run| std::cmp::Reverse(run.solved()));
    let mut figure = Figure::new(format!("Derivative routes: {}", results.model.name));
    for solver in best.iter().take(COMPARED_SOLVERS).map(|run| &run.solver) {
        let mut chart = Chart::new(solver.clone())
            .x(Axis::log("time for one problem, µs"))
            .y(solved_axis());
        let runs = choice::active(results).filter(|run| run.solver == *solver);
        for (colour, run) in runs.enumerate() {
            let curve = percent(share_within(times(run), results.problems));
            let name = run.route.clone().unwrap_or_default();
            chart = chart.with(Series::steps(name, curve).style(Style::family(colour, 0)));
        }
        figure = figure.chart(chart);
    }
    figure
}

/// Lowest cost so far over the iterations of the chosen problem.
#[must_use]
pub fn course(results: &Results) -> Figure {
    let mut panels = panels(results);
    let points = |run: &&Run| -> Vec<(f64, f64)> {
        let mut courses = results.courses.iter();
        let history =
            courses.find(|course| course.solver == run.solver && course.route == run.route);
        let history = history.map(|course| course.points.as_slice());
        let points = history.unwrap_or_default().iter();
        points
            .map(|&(step, cost)| ((step + 1) as f64, cost))
            .collect()
    };
    for panel in &mut panels {
        panel.runs.retain(|run| !points(run).is_empty());
    }
    panels.retain(|panel| !panel.runs.is_empty());
    let runs = panels.iter().flat_map(|panel| &panel.runs);
    let curves: Vec<Vec<(f64, f64)>> = runs.map(points).collect();
    let costs = || curves.iter().flatten().map(|(_, cost)| *cost);
    let highest = costs().fold(0.0, f64::max);
    let lowest = costs().filter(|cost| *cost > 0.0).fold(highest, f64::min);
    let mut y = Axis::log("lowest cost so far, length²");
    if highest > 0.0 {
        y = y.range(lowest.max(MIN_RELATIVE_COST * highest) / 3.0, 3.0 * highest);
    }
    let (name, chosen) = (&results.model.name, results.setting.chosen);
    let title = format!("Cost over steps: {name}, problem {chosen}");
    by_panel(title, &panels, &curves, "steps of all attempts + 1", y)
}

/// Cost of one Jacobian by derivative mode, with guides for O(m) and O(m²).
#[must_use]
pub fn jacobian(results: &Results) -> Figure {
    let mut chart = Chart::new("Cost of one Jacobian: a chain of m bones with three angles each")
        .x(Axis::log("bones m"))
        .y(Axis::log("time, µs"));
    for (colour, cost) in results.jacobian_cost.iter().enumerate() {
        let points = cost
            .points
            .iter()
            .map(|&(bones, micros)| (bones as f64, micros));
        let series = Series::line(cost.route.clone(), points);
        chart = chart.with(series.style(Style::family(colour, 0)));
    }
    // The guides pass through the last points of the fastest and the slowest mode.
    let ends = results
        .jacobian_cost
        .iter()
        .filter_map(|cost| cost.points.last());
    let (fastest, slowest) = ends.fold((None, None), |(low, high): Ends, end| {
        let low = low.filter(|low| low.1 <= end.1).unwrap_or(end);
        let high = high.filter(|high| high.1 >= end.1).unwrap_or(end);
        (Some(low), Some(high))
    });
    for (name, end, power) in [("∝ m", fastest, 1), ("∝ m²", slowest, 2)] {
        if let Some(&(bones, micros)) = end {
            let from = bones as f64 / 16.0;
            let points = [
                (from, 0.6 * micros / 16_f64.powi(power)),
                (bones as f64, 0.6 * micros),
            ];
            chart = chart.with(Series::line(name, points).style(Style::guide(power as usize)));
        }
    }
    chart.into()
}

type Ends<'r> = (Option<&'r (usize, f64)>, Option<&'r (usize, f64)>);
