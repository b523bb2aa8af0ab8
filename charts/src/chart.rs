//! Charts.

use std::path::Path;

use crate::{Axis, ChartError, Figure, Series};

/// A line or step chart. Build it, then [`write_svg`](Self::write_svg).
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    pub(crate) title: String,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
    pub(crate) series: Vec<Series>,
}

impl Chart {
    /// An empty chart with linear axes.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            x: Axis::linear(""),
            y: Axis::linear(""),
            series: Vec::new(),
        }
    }

    /// Sets the horizontal axis.
    #[must_use]
    pub fn x(mut self, axis: Axis) -> Self {
        self.x = axis;
        self
    }

    /// Sets the vertical axis.
    #[must_use]
    pub fn y(mut self, axis: Axis) -> Self {
        self.y = axis;
        self
    }

    /// Adds points (x, y) joined by straight lines.
    #[must_use]
    pub fn series(
        self,
        name: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        self.with(Series::line(name, points))
    }

    /// Adds points (x, y), by ascending x, as a step function.
    #[must_use]
    pub fn steps(
        self,
        name: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        self.with(Series::steps(name, points))
    }

    /// Adds a series. A series without points still appears in the legend.
    #[must_use]
    pub fn with(mut self, series: Series) -> Self {
        self.series.push(series);
        self
    }

    /// Returns the chart as an SVG document.
    ///
    /// # Errors
    /// Returns an error for a chart without points, for a value that is not finite, or not positive on a logarithmic
    /// axis without a range, and for an empty range of an axis.
    pub fn to_svg(&self) -> Result<String, ChartError> {
        Figure::from(self.clone()).to_svg()
    }

    /// Writes the chart to a file.
    ///
    /// # Errors
    /// As [`to_svg`](Self::to_svg). Returns an error if the file cannot be written.
    pub fn write_svg(&self, path: impl AsRef<Path>) -> Result<(), ChartError> {
        Figure::from(self.clone()).write_svg(path)
    }
}
