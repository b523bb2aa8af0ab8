//! Errors of skeletons; each names the bone.

use thiserror::Error;

use crate::model::{ModelError, UnknownName};
use crate::spatial::RigidDefect;

/// Error of building a skeleton.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SkeletonError {
    /// A bone comes before its parent. This check also excludes cycles.
    #[error("bone `{bone}`: its parent must precede it in the list")]
    ParentNotBefore {
        /// Name of the child.
        bone: String,
    },
    /// A length is negative or not finite.
    #[error("bone `{bone}`: length {length} is not a finite number of at least 0")]
    BadLength {
        /// Name of the bone.
        bone: String,
        /// Given length.
        length: f64,
    },
    /// Limits are NaN or out of order.
    #[error("bone `{bone}`: limits [{lower}, {upper}] rad of its {angle} are not an interval")]
    BadLimits {
        /// Name of the bone.
        bone: String,
        /// Angle of the bone: first twist, bend or second twist.
        angle: &'static str,
        /// Lower limit, radians.
        lower: f64,
        /// Upper limit, radians.
        upper: f64,
    },
    /// A rest placement is not a rigid motion.
    #[error("bone `{bone}`: its rest placement is not a rigid motion ({problem})")]
    BadRest {
        /// Name of the bone.
        bone: String,
        /// Defect of the placement.
        problem: RigidDefect,
    },
    /// A bone of another skeleton.
    #[error("bone {bone} does not exist; there are {bones} bones")]
    ForeignBone {
        /// Index of the bone.
        bone: usize,
        /// Number of bones.
        bones: usize,
    },
    /// Two bones have the same name.
    #[error("bone name `{name}` is used twice")]
    DuplicateName {
        /// The name.
        name: String,
    },
    /// A cone of a bone without a joint.
    #[error("bone `{bone}` is locked; only a rotating bone has a cone")]
    ConeOfStillBone {
        /// Name of the bone.
        bone: String,
    },
    /// A cone of the bone of a free root.
    #[error("bone `{bone}` is a free root, which has no cone")]
    ConeOfFreeBone {
        /// Name of the bone.
        bone: String,
    },
    /// A cone of a bone that does not exist.
    #[error(transparent)]
    UnknownBone(#[from] UnknownName),
    /// A name clash or an overflow in the compiled model.
    #[error(transparent)]
    Model(#[from] ModelError),
}
