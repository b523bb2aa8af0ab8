//! Errors of limb definitions.

/// Error of a limb definition.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LimbError {
    /// A bone of another armature.
    #[error("bone {bone} does not exist; the armature has {bones} bones")]
    UnknownBone {
        /// Index of the bone.
        bone: usize,
        /// Number of bones.
        bones: usize,
    },
    /// The lower bone is not a descendant of the upper one, or the end not one of the lower bone.
    #[error("bone `{lower}` must be a descendant of bone `{upper}`")]
    NotAbove {
        /// Name of the lower bone.
        lower: String,
        /// Name of the upper bone.
        upper: String,
    },
    /// An end point that is not finite.
    #[error("the end of the limb must be finite")]
    BadEnd,
    /// A hinge axis that is not finite or zero.
    #[error("the hinge axis must be finite and not zero")]
    BadHinge,
    /// A softening fraction outside [0, 1].
    #[error("the softening {share} is outside [0, 1]")]
    BadSoftening {
        /// The fraction given.
        share: f32,
    },
}
