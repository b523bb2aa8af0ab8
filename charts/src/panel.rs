//! Drawing of one chart: axes, grid, lines, markers.

use plotters::coord::Shift;
use plotters::element::{DashedPathElement, PathElement, Polygon};
use plotters::prelude::{
    Cartesian2d, ChartBuilder, Circle, DrawingArea, DrawingAreaErrorKind, DrawingBackend, IntoFont,
    LabelAreaPosition, RGBColor, Rectangle, ShapeStyle, Text,
};

use crate::axis::FittedAxis;
use crate::entry::Entry;
use crate::series::Join;
use crate::style::Marker;
use crate::{Chart, ChartError, Series, Style};

pub(crate) const FONT: &str = "sans-serif";
pub(crate) const FONT_SIZE: u32 = 13;
const TITLE_SIZE: u32 = 15;
const MARKER_SIZE: i32 = 4;
/// Approximate distance of markers along a line, in pixels; a line has at least one.
const MARKER_SPACING: i32 = 90;

/// Colour of all text and axes.
pub(crate) fn ink() -> RGBColor {
    RGBColor(40, 40, 40)
}

pub(crate) fn draw_error<E: std::error::Error + Send + Sync>(
    error: DrawingAreaErrorKind<E>,
) -> ChartError {
    ChartError::Draw(error.to_string())
}

/// Draws the headline of a figure.
pub(crate) fn write_title<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    title: &str,
) -> Result<(), ChartError> {
    let font = (FONT, TITLE_SIZE + 2).into_font().color(&ink());
    let text = Text::new(title.to_owned(), (12, 10), font);
    area.draw(&text).map_err(draw_error)
}

type Plane = Cartesian2d<FittedAxis, FittedAxis>;

pub(crate) fn draw<B: DrawingBackend>(
    chart: &Chart,
    entries: &[Entry],
    area: &DrawingArea<B, Shift>,
) -> Result<(), ChartError> {
    check(chart)?;
    let points = || chart.series.iter().flat_map(|series| &series.points);
    let (width, height) = area.dim_in_pixel();
    let x = chart.x.fit(points().map(|p| p.0), width as usize / 70)?;
    let y = chart.y.fit(points().map(|p| p.1), height as usize / 40)?;

    let title = (FONT, TITLE_SIZE).into_font().color(&ink());
    let mut context = ChartBuilder::on(area)
        .caption(&chart.title, title)
        .margin(8)
        .margin_right(18)
        .set_label_area_size(LabelAreaPosition::Left, 62)
        .set_label_area_size(LabelAreaPosition::Bottom, 42)
        .build_cartesian_2d(x.clone(), y.clone())
        .map_err(draw_error)?;
    let font = (FONT, FONT_SIZE).into_font().color(&ink());
    context
        .configure_mesh()
        .x_desc(chart.x.label())
        .y_desc(chart.y.label())
        .label_style(font.clone())
        .axis_desc_style(font)
        .axis_style(ink())
        .bold_line_style(RGBColor(205, 205, 205))
        .light_line_style(RGBColor(236, 236, 236))
        .draw()
        .map_err(draw_error)?;

    // Lines first, so that they do not cover markers.
    let plane = context.plotting_area();
    let styles: Vec<Style> = chart.series.iter().map(|s| style_of(s, entries)).collect();
    let paths = chart.series.iter().map(|s| path(chart, s, &x, &y, plane));
    let paths: Vec<Vec<(i32, i32)>> = paths.collect();
    for (path, &style) in paths.iter().zip(&styles) {
        draw_line(&plane.strip_coord_spec(), &relative(plane, path), style)?;
    }
    let (width, _) = plane.dim_in_pixel();
    for (k, (path, &style)) in paths.iter().zip(&styles).enumerate() {
        for pixel in marked(&relative(plane, path), width, k) {
            draw_marker(&plane.strip_coord_spec(), pixel, style)?;
        }
    }
    Ok(())
}

fn check(chart: &Chart) -> Result<(), ChartError> {
    for series in &chart.series {
        for &(x, y) in &series.points {
            chart.x.check(&series.name, x)?;
            chart.y.check(&series.name, y)?;
        }
    }
    match chart.series.iter().all(|series| series.points.is_empty()) {
        true => Err(ChartError::Empty {
            chart: chart.title.clone(),
        }),
        false => Ok(()),
    }
}

fn style_of(series: &Series, entries: &[Entry]) -> Style {
    let entry = entries.iter().find(|entry| entry.name == series.name);
    entry.map_or(Style::nth(0), |entry| entry.style)
}

/// Points of a series' line, in pixels of the whole picture.
fn path<B: DrawingBackend>(
    chart: &Chart,
    series: &Series,
    x: &FittedAxis,
    y: &FittedAxis,
    plane: &DrawingArea<B, Plane>,
) -> Vec<(i32, i32)> {
    let mut corners = Vec::with_capacity(2 * series.points.len() + 1);
    let mut height = None;
    for &(px, py) in &series.points {
        let (px, py) = (x.clamp(chart.x.position(px)), y.clamp(chart.y.position(py)));
        if let (Join::Steps, Some(height)) = (series.join, height) {
            corners.push((px, height));
        }
        corners.push((px, py));
        height = Some(py);
    }
    if let (Join::Steps, Some(height)) = (series.join, height) {
        corners.push((x.to(), height));
    }
    let mut path: Vec<_> = corners.iter().map(|c| plane.map_coordinate(c)).collect();
    path.dedup();
    path
}

/// Converts pixels of the picture to pixels of the plotting area.
fn relative<B: DrawingBackend>(
    plane: &DrawingArea<B, Plane>,
    path: &[(i32, i32)],
) -> Vec<(i32, i32)> {
    let (columns, rows) = plane.get_pixel_range();
    let from_corner = |&(x, y): &(i32, i32)| (x - columns.start, y - rows.start);
    path.iter().map(from_corner).collect()
}

/// Draws a line through pixels, dashed by its style.
pub(crate) fn draw_line<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    path: &[(i32, i32)],
    style: Style,
) -> Result<(), ChartError> {
    if path.len() < 2 {
        return Ok(());
    }
    match style.dash() {
        None => area.draw(&PathElement::new(path.to_vec(), style.line())),
        Some((drawn, left_out)) => area.draw(&DashedPathElement::new(
            path.iter().copied(),
            drawn,
            left_out,
            style.line(),
        )),
    }
    .map_err(draw_error)
}

/// Marker positions of the `k`-th line: on points, about equally spaced along the line, offset from those of other
/// lines, and inside the plane's right edge.
fn marked(path: &[(i32, i32)], width: u32, k: usize) -> Vec<(i32, i32)> {
    let inside = |x: i32| i64::from(x) + i64::from(MARKER_SIZE) < i64::from(width);
    if path.len() <= 12 {
        let positions = path.iter().copied();
        return positions.filter(|&(x, _)| inside(x)).collect();
    }
    let offset = MARKER_SPACING * (k % 4) as i32 / 4;
    let mut travelled = MARKER_SPACING / 2 - offset;
    let mut positions = Vec::new();
    let mut last = None;
    for &(x, y) in path {
        if let Some((lx, ly)) = last {
            let step: i32 = i32::abs(x - lx) + i32::abs(y - ly);
            travelled += step;
        }
        last = Some((x, y));
        if travelled >= MARKER_SPACING && inside(x) {
            positions.push((x, y));
            travelled = 0;
        }
    }
    if positions.is_empty() {
        positions.extend(path.get(path.len() / 2));
    }
    positions
}

/// Draws a marker at a pixel.
pub(crate) fn draw_marker<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    (x, y): (i32, i32),
    style: Style,
) -> Result<(), ChartError> {
    let s = MARKER_SIZE;
    let line = style.line();
    let filled = ShapeStyle {
        filled: true,
        ..line
    };
    let hollow = ShapeStyle {
        color: plotters::style::WHITE.into(),
        ..filled
    };
    let Some(marker) = style.marker() else {
        return Ok(());
    };
    match marker {
        Marker::Circle => area.draw(&Circle::new((x, y), s, filled)),
        Marker::Square => area.draw(&Rectangle::new([(x - s, y - s), (x + s, y + s)], filled)),
        Marker::Triangle => {
            let corners = vec![(x, y - s - 1), (x - s - 1, y + s), (x + s + 1, y + s)];
            area.draw(&Polygon::new(corners, filled))
        }
        Marker::Cross => area
            .draw(&PathElement::new(
                vec![(x - s, y - s), (x + s, y + s)],
                line,
            ))
            .and_then(|()| {
                area.draw(&PathElement::new(
                    vec![(x - s, y + s), (x + s, y - s)],
                    line,
                ))
            }),
        Marker::Ring => area
            .draw(&Circle::new((x, y), s, hollow))
            .and_then(|()| area.draw(&Circle::new((x, y), s, line))),
    }
    .map_err(draw_error)
}
