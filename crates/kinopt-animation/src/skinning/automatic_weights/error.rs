//! Errors of automatic skin weights.

use crate::skinning::WeightsError;

/// Error of computing skin weights.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AutomaticWeightsError {
    /// The skeleton has no bones.
    #[error("there are no bones")]
    NoBones,
    /// The falloff is not a finite number above 0.
    #[error("falloff {0}: it must be finite and above 0")]
    Falloff(f64),
    /// The heat factor is not a finite number above 0.
    #[error("heat {0}: it must be finite and above 0")]
    Heat(f64),
    /// The largest number of influences is 0.
    #[error("a vertex must keep at least one influence")]
    NoInfluences,
    /// An end of a bone is NaN or infinite.
    #[error("bone {bone}: an end is not finite")]
    NonFiniteBone {
        /// Index of the bone, from 0.
        bone: usize,
    },
    /// The heat equations of the surface cannot be solved in double precision.
    #[error("the heat on this surface cannot be computed in double precision")]
    Unsolvable,
    /// The weights cannot be normalised.
    #[error(transparent)]
    Weights(#[from] WeightsError),
}
