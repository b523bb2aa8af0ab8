//! What can be wrong with a chart.

use std::path::PathBuf;

/// Why a chart was not drawn.
#[derive(Debug, thiserror::Error)]
pub enum ChartError {
    /// There is nothing to draw.
    #[error("chart `{chart}` has no points")]
    Empty {
        /// The chart's title.
        chart: String,
    },
    /// A coordinate that cannot be drawn.
    #[error("series `{series}` has the value {value} on axis `{axis}`, which takes {takes}")]
    BadValue {
        /// The series' name.
        series: String,
        /// The axis' label.
        axis: String,
        /// What was given.
        value: f64,
        /// What the axis takes.
        takes: &'static str,
    },
    /// An axis whose range is empty, not finite, or not positive where it is logarithmic.
    #[error("axis `{axis}` cannot show {from} to {to}")]
    BadRange {
        /// The axis' label.
        axis: String,
        /// The lower end.
        from: f64,
        /// The upper end.
        to: f64,
    },
    /// A file that cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The drawing itself failed.
    #[error("the drawing failed: {0}")]
    Draw(String),
}
