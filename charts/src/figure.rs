//! Figures: several charts with a common legend.

use std::path::Path;

use plotters::prelude::{IntoDrawingArea, SVGBackend, WHITE};

use crate::entry::Entry;
use crate::legend::Legend;
use crate::panel::{self, draw_error};
use crate::{Chart, ChartError, Style};

/// Width that a page of a code-hosting site shows without scaling, in pixels.
const PAGE_WIDTH: u32 = 900;
/// Height of one chart, in pixels: alone, and as one of several.
const CHART_HEIGHTS: [u32; 2] = [400, 290];
const TITLE_HEIGHT: u32 = 34;

/// Several charts in a grid. A series of one name has one style in all charts. In one column each chart has its own
/// legend next to it; in several columns they share one.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    title: Option<String>,
    columns: usize,
    charts: Vec<Chart>,
}

impl Figure {
    /// An empty figure of two columns.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: Some(title.into()),
            columns: 2,
            charts: Vec::new(),
        }
    }

    /// Sets the number of columns, at least one.
    #[must_use]
    pub fn columns(mut self, columns: usize) -> Self {
        self.columns = columns.max(1);
        self
    }

    /// Adds a chart, row by row.
    #[must_use]
    pub fn chart(mut self, chart: Chart) -> Self {
        self.charts.push(chart);
        self
    }

    /// Returns the figure as an SVG document.
    ///
    /// # Errors
    /// As [`Chart::to_svg`], for any chart. Returns an error without charts.
    pub fn to_svg(&self) -> Result<String, ChartError> {
        let entries = entries(&self.charts);
        let legend = Legend::new(&entries);
        let columns = self.columns.min(self.charts.len()).max(1);
        let rows = self.charts.len().div_ceil(columns);
        let [alone, one_of_several] = CHART_HEIGHTS;
        let chart_height = if rows == 1 && columns == 1 {
            alone
        } else {
            one_of_several
        };
        // In one column every row is at least as high as its legend.
        let legend_heights = self
            .charts
            .iter()
            .map(|chart| Legend::new(&entries_of(chart, &entries)).height());
        let chart_height = match columns {
            1 => chart_height.max(legend_heights.max().unwrap_or(0)),
            _ => chart_height,
        };
        let top = if self.title.is_some() {
            TITLE_HEIGHT
        } else {
            0
        };
        let charts_height = chart_height * u32::try_from(rows).unwrap_or(1);
        let shared_height = if columns == 1 { 0 } else { legend.height() };
        let height = top + charts_height.max(shared_height);
        if self.charts.is_empty() {
            return Err(ChartError::Empty {
                chart: self.title.clone().unwrap_or_default(),
            });
        }

        let mut svg = String::new();
        {
            let root = SVGBackend::with_string(&mut svg, (PAGE_WIDTH, height)).into_drawing_area();
            root.fill(&WHITE).map_err(draw_error)?;
            let below = match &self.title {
                Some(title) => {
                    let (head, below) = root.split_vertically(TITLE_HEIGHT);
                    panel::write_title(&head, title)?;
                    below
                }
                None => root.clone(),
            };
            let (grid, legend_area) = below.split_horizontally(PAGE_WIDTH - legend.width());
            for (chart, area) in self.charts.iter().zip(grid.split_evenly((rows, columns))) {
                panel::draw(chart, &entries, &area)?;
            }
            if columns == 1 {
                for (chart, area) in self.charts.iter().zip(legend_area.split_evenly((rows, 1))) {
                    Legend::new(&entries_of(chart, &entries)).draw(&area)?;
                }
            } else {
                legend.draw(&legend_area)?;
            }
            root.present().map_err(draw_error)?;
        }
        Ok(svg)
    }

    /// Writes the figure to a file.
    ///
    /// # Errors
    /// As [`to_svg`](Self::to_svg). Returns an error if the file cannot be written.
    pub fn write_svg(&self, path: impl AsRef<Path>) -> Result<(), ChartError> {
        let path = path.as_ref();
        std::fs::write(path, self.to_svg()?).map_err(|source| ChartError::Write {
            path: path.to_owned(),
            source,
        })
    }
}

impl From<Chart> for Figure {
    fn from(chart: Chart) -> Self {
        Self {
            title: None,
            columns: 1,
            charts: vec![chart],
        }
    }
}

/// Unique names of some charts, in the order of their first appearance, with their styles.
fn entries(charts: &[Chart]) -> Vec<Entry> {
    let mut entries: Vec<Entry> = Vec::new();
    for series in charts.iter().flat_map(|chart| &chart.series) {
        if entries.iter().all(|entry| entry.name != series.name) {
            let style = series.style.unwrap_or_else(|| Style::nth(entries.len()));
            let name = series.name.clone();
            entries.push(Entry { name, style });
        }
    }
    entries
}

/// Names of one chart, with their styles in all charts.
fn entries_of(chart: &Chart, all_entries: &[Entry]) -> Vec<Entry> {
    let mut chart_entries = entries(std::slice::from_ref(chart));
    for entry in &mut chart_entries {
        let known = all_entries.iter().find(|known| known.name == entry.name);
        entry.style = known.map_or(entry.style, |known| known.style);
    }
    chart_entries
}
