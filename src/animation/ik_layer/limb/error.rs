//! Bones that are no limb.

/// Bones that are no limb.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LimbError {
    /// A bone of another armature.
    #[error("bone {bone} does not exist; the armature has {bones}")]
    UnknownBone {
        /// The bone's index.
        bone: usize,
        /// How many bones there are.
        bones: usize,
    },
    /// The lower bone does not hang on the upper one, or the end not on the lower one.
    #[error("bone `{lower}` does not hang on bone `{upper}`")]
    NotAbove {
        /// The lower bone.
        lower: String,
        /// The upper bone.
        upper: String,
    },
    /// An end that is not finite.
    #[error("the end of the limb is not finite")]
    BadEnd,
    /// A hinge without a direction.
    #[error("the hinge's axis is not finite or has no length")]
    BadHinge,
    /// A share of the limb's length that is none.
    #[error("{share} is no share of the limb's length within [0, 1]")]
    BadSoftening {
        /// The share.
        share: f32,
    },
}
