//! Line and step charts as SVG: axes with units, a legend next to the data, colours that colour-blind readers can
//! distinguish, and dashes and markers for print.
//!
//! ```
//! use kinopt_charts::{Axis, Chart};
//!
//! let svg = Chart::new("Solved over time")
//!     .x(Axis::log("time, µs"))
//!     .y(Axis::linear("solved, %").range(0.0, 100.0))
//!     .steps("Gauss-Newton", [(10.0, 25.0), (40.0, 75.0), (200.0, 100.0)])
//!     .series("fit", [(10.0, 30.0), (200.0, 95.0)])
//!     .to_svg()?;
//! assert!(svg.starts_with("<svg") && svg.contains("time, µs"));
//! # Ok::<(), kinopt_charts::ChartError>(())
//! ```
//!
//! [`Figure`] arranges several charts with a common legend.

mod axis;
mod chart;
mod entry;
mod error;
mod figure;
mod legend;
mod panel;
mod series;
mod style;
mod ticks;

pub use axis::Axis;
pub use chart::Chart;
pub use error::ChartError;
pub use figure::Figure;
pub use series::Series;
pub use style::Style;
