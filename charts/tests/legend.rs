//! Promise: the legend is to the right of every line and marker, for any names and data.
#![allow(clippy::unwrap_used)]

use kinopt_charts::{Axis, Chart, Figure, Series, Style};

/// Right end of the plotting area: the rightmost grid line.
fn rightmost_grid(svg: &str) -> f64 {
    let grid = svg.lines().filter(|line| line.contains("#CDCDCD"));
    let ends = grid.filter_map(|line| attribute(line, "x2").or_else(|| last_x(line)));
    ends.fold(0.0, f64::max)
}

fn attribute(line: &str, name: &str) -> Option<f64> {
    let (_, rest) = line.split_once(&format!(" {name}=\""))?;
    rest.split_once('"')?.0.parse().ok()
}

fn last_x(line: &str) -> Option<f64> {
    let (_, rest) = line.split_once("points=\"")?;
    let points = rest.split_once('"')?.0.split_whitespace();
    points
        .filter_map(|p| p.split_once(',')?.0.parse().ok())
        .fold(None, |max, x: f64| {
            Some(max.map_or(x, |max: f64| max.max(x)))
        })
}

/// The x of the text elements with one of the names.
fn legend_texts(svg: &str, names: &[&str]) -> Vec<f64> {
    let mut positions = Vec::new();
    let mut lines = svg.lines().peekable();
    while let Some(line) = lines.next() {
        if line.starts_with("<text") && names.contains(lines.peek().unwrap_or(&"")) {
            positions.push(attribute(line, "x").unwrap());
        }
    }
    positions
}

#[test]
fn legend_is_beyond_the_axes() {
    let names = ["a", "a much longer name than most series have"];
    let chart = Chart::new("t")
        .x(Axis::log("time, µs"))
        .y(Axis::linear("solved, %"))
        .steps(names[0], [(1.0, 0.0), (1e6, 100.0)])
        .series(names[1], [(1.0, 100.0), (1e6, 0.0)]);
    for svg in [
        chart.to_svg().unwrap(),
        Figure::new("two")
            .chart(chart.clone())
            .chart(chart)
            .to_svg()
            .unwrap(),
    ] {
        let texts = legend_texts(&svg, &names);
        assert_eq!(texts.len(), 2, "one entry a name");
        let edge = rightmost_grid(&svg);
        assert!(edge > 300.0);
        assert!(texts.iter().all(|&x| x > edge + 20.0), "{texts:?} {edge}");
    }
}

#[test]
fn legend_lists_a_hundred_series() {
    let names: Vec<String> = (0..100).map(|k| format!("series-{k}")).collect();
    let add = |chart: Chart, (k, name): (usize, &String)| {
        chart.with(Series::line(name, [(0.0, k as f64)]).style(Style::nth(k)))
    };
    let svg = names
        .iter()
        .enumerate()
        .fold(Chart::new("t"), add)
        .to_svg()
        .unwrap();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    assert_eq!(legend_texts(&svg, &names).len(), 100);
    let height = attribute(svg.lines().next().unwrap(), "height").unwrap();
    let lowest = svg.lines().filter(|line| line.starts_with("<text"));
    let lowest = lowest
        .filter_map(|line| attribute(line, "y"))
        .fold(0.0, f64::max);
    assert!(lowest < height, "{lowest} {height}");
}
