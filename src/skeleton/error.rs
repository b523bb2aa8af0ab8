//! What can be wrong with a skeleton, each naming the bone.

use thiserror::Error;

use crate::model::{ModelError, UnknownName};
use crate::spatial::RigidDefect;

/// Why bones do not make a skeleton.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SkeletonError {
    /// Parents must come before children, which also rules rings out.
    #[error("bone `{bone}`: its parent does not come before it")]
    ParentNotBefore {
        /// The child.
        bone: String,
    },
    /// A length that is negative or not finite.
    #[error("bone `{bone}`: length {length} is not a finite number of at least 0")]
    BadLength {
        /// The bone.
        bone: String,
        /// The length as given.
        length: f64,
    },
    /// Limits that are NaN or out of order.
    #[error("bone `{bone}`: limits [{lower}, {upper}] rad of its {angle} are not an interval")]
    BadLimits {
        /// The bone.
        bone: String,
        /// Which of its three angles.
        angle: &'static str,
        /// Lower end, radians.
        lower: f64,
        /// Upper end, radians.
        upper: f64,
    },
    /// A rest placement that is not a rigid motion.
    #[error("bone `{bone}`: its rest placement is not a rigid motion ({problem})")]
    BadRest {
        /// The bone.
        bone: String,
        /// What is wrong with it.
        problem: RigidDefect,
    },
    /// A bone of another skeleton.
    #[error("bone number {bone} was asked for, but there are {bones}")]
    ForeignBone {
        /// The position that the id stands for.
        bone: usize,
        /// How many bones there are.
        bones: usize,
    },
    /// Two bones of one name.
    #[error("bone name `{name}` is used twice")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// A cone of a bone that does not turn.
    #[error("bone `{bone}` does not turn, so a cone means nothing to it")]
    ConeOfStillBone {
        /// The bone.
        bone: String,
    },
    /// A cone of the bone that a free root turns.
    #[error("bone `{bone}` is a free root, which turns any way: it has no cone")]
    ConeOfFreeBone {
        /// The bone.
        bone: String,
    },
    /// A cone of a bone that there is not.
    #[error(transparent)]
    UnknownBone(#[from] UnknownName),
    /// A name clash or an overflow that only shows in the compiled model.
    #[error(transparent)]
    Model(#[from] ModelError),
}
