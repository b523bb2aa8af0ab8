//! Fingers that relate captures and robot hands.

use serde::{Deserialize, Serialize};

/// Finger of a hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Finger {
    /// Thumb.
    Thumb,
    /// Index finger.
    Index,
    /// Middle finger.
    Middle,
    /// Ring finger.
    Ring,
    /// Little finger.
    Little,
}

impl Finger {
    /// All fingers, from the thumb outward.
    pub const ALL: [Self; 5] = [
        Self::Thumb,
        Self::Index,
        Self::Middle,
        Self::Ring,
        Self::Little,
    ];

    /// Name in files, such as `thumb`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Thumb => "thumb",
            Self::Index => "index",
            Self::Middle => "middle",
            Self::Ring => "ring",
            Self::Little => "little",
        }
    }

    /// Words for the finger in names of joints and links. Shadow hands abbreviate them.
    pub(super) fn words(self) -> &'static [&'static str] {
        match self {
            Self::Thumb => &["thumb", "th"],
            Self::Index => &["index", "fore", "ff"],
            Self::Middle => &["middle", "mid", "mf"],
            Self::Ring => &["ring", "rf"],
            Self::Little => &["little", "pinky", "lf"],
        }
    }
}
