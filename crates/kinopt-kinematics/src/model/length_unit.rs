//! Unit of a model's lengths.

/// The unit of a model's lengths in texts for people; no calculation depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum LengthUnit {
    /// Metres, for robots.
    #[default]
    Metres,
    /// An arbitrary unit: a rig has no known physical size.
    Own,
}

impl LengthUnit {
    /// "m" or "units".
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Metres => "m",
            Self::Own => "units",
        }
    }
}
