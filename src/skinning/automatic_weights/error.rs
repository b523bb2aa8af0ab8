//! Why no weights can be made up.

use crate::skinning::WeightsError;

/// Why no weights can be made up.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AutomaticWeightsError {
    /// There are no bones.
    #[error("there are no bones to follow")]
    NoBones,
    /// The falloff is not a number above 0.
    #[error("a falloff of {0} is not a finite number above 0")]
    Falloff(f64),
    /// The heat that bones give is not a number above 0.
    #[error("a heat of {0} is not a finite number above 0")]
    Heat(f64),
    /// No influence may stay.
    #[error("a vertex must keep at least one influence")]
    NoInfluences,
    /// A bone's end is NaN or infinite.
    #[error("bone {bone}: an end of it is not finite")]
    NonFiniteBone {
        /// Which bone, from 0.
        bone: usize,
    },
    /// The surface is so uneven that its equations cannot be solved in double precision.
    #[error("the heat on this surface cannot be computed in double precision")]
    Unsolvable,
    /// The weights could not be normalised.
    #[error(transparent)]
    Weights(#[from] WeightsError),
}
