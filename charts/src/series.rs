//! Series of points.

use crate::Style;

/// Connection of the points of a series.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Join {
    Line,
    Steps,
}

/// A named series of points.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    pub(crate) name: String,
    pub(crate) points: Vec<(f64, f64)>,
    pub(crate) join: Join,
    pub(crate) style: Option<Style>,
}

impl Series {
    /// Points (x, y) joined by straight lines, in the order given.
    #[must_use]
    pub fn line(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self {
            name: name.into(),
            points: points.into_iter().collect(),
            join: Join::Line,
            style: None,
        }
    }

    /// Points (x, y), by ascending x, as a step function: y holds until the next point, and from the last one to the
    /// right edge.
    #[must_use]
    pub fn steps(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self {
            join: Join::Steps,
            ..Self::line(name, points)
        }
    }

    /// Sets the style. By default, series use the styles in order; a name has one style in all charts of a figure.
    #[must_use]
    pub fn style(mut self, style: Style) -> Self {
        self.style = Some(style);
        self
    }
}
