//! What a legend lists.

use crate::Style;

/// A name and its look.
pub(crate) struct Entry {
    pub(crate) name: String,
    pub(crate) style: Style,
}
