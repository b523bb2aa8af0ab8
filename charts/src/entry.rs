//! Entries of a legend.

use crate::Style;

/// Name and style of a series.
pub(crate) struct Entry {
    pub(crate) name: String,
    pub(crate) style: Style,
}
