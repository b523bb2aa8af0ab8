//! Points under one name.

use crate::Style;

/// How the points of a series are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Join {
    Line,
    Steps,
}

/// Points under one name in the legend.
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

    /// Points (x, y), by ascending x, whose y holds until the next: from the last one to the right
    /// edge.
    #[must_use]
    pub fn steps(name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        Self {
            join: Join::Steps,
            ..Self::line(name, points)
        }
    }

    /// Its look. Unset, series take the styles in turn; the same name looks the same in all charts of
    /// a figure.
    #[must_use]
    pub fn style(mut self, style: Style) -> Self {
        self.style = Some(style);
        self
    }
}
