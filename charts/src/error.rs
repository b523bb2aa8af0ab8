//! Errors of charts.

use std::path::PathBuf;

/// Reason why a chart was not drawn.
#[derive(Debug, thiserror::Error)]
pub enum ChartError {
    /// A chart without points.
    #[error("chart `{chart}` has no points")]
    Empty {
        /// Title of the chart.
        chart: String,
    },
    /// An invalid coordinate.
    #[error("series `{series}` has the value {value} on axis `{axis}`, which takes {takes}")]
    BadValue {
        /// Name of the series.
        series: String,
        /// Label of the axis.
        axis: String,
        /// Given value.
        value: f64,
        /// Description of the allowed values.
        takes: &'static str,
    },
    /// A range of an axis that is empty, not finite, or not positive on a logarithmic axis.
    #[error("axis `{axis}` cannot show {from} to {to}")]
    BadRange {
        /// Label of the axis.
        axis: String,
        /// Lower end.
        from: f64,
        /// Upper end.
        to: f64,
    },
    /// A file that cannot be written.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// Path of the file.
        path: PathBuf,
        /// Cause.
        source: std::io::Error,
    },
    /// A failure of the drawing backend.
    #[error("the drawing failed: {0}")]
    Draw(String),
}
