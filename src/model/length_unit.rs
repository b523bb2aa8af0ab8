//! What a model counts lengths in.

/// The unit of a model's lengths, for what people read: no calculation depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum LengthUnit {
    /// Metres, as robots have it.
    #[default]
    Metres,
    /// A unit of the model's own: a rig says nothing about its size in the world.
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
