//! One bone at rest.

use super::SkeletonError;
use crate::model::Limits;
use crate::spatial::{Placement, Vector3};

/// How far R̂ᵀR̂ of a rest placement may stand from the identity, entry by entry.
const ORTHONORMAL_WITHIN: f64 = 1e-6;

/// A bone of one skeleton.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BoneId(u32);

impl BoneId {
    pub(crate) fn new(index: usize) -> Self {
        Self(index as u32)
    }

    /// The position in the skeleton's list.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A bone at rest and how far it may turn.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bone {
    /// Unique within the skeleton; files without names use `bone/0`, `bone/1`, …
    pub name: String,
    /// The bone it turns with; `None` for a root.
    pub parent: Option<BoneId>,
    /// From tail to tip, in the rig's own unit; zero is allowed.
    pub length: f64,
    /// T̂: canonical bone → model at rest.
    pub model_from_rest: Placement<f64>,
    /// Ranges of (θ₁, θ₂, θ₃): first twist, bend, second twist, in radians.
    pub limits: [Limits; 3],
}

impl Bone {
    /// The tail at rest, in model coordinates.
    #[must_use]
    pub fn rest_tail(&self) -> Vector3<f64> {
        self.model_from_rest.translation
    }

    /// The tip at rest, in model coordinates.
    #[must_use]
    pub fn rest_tip(&self) -> Vector3<f64> {
        self.model_from_rest
            .apply(Vector3::new(self.length, 0.0, 0.0))
    }

    /// Checks one bone that stands at `index` in its list.
    pub(super) fn check(&self, index: usize) -> Result<(), SkeletonError> {
        let bone = || self.name.clone();
        if self.parent.is_some_and(|parent| parent.index() >= index) {
            return Err(SkeletonError::ParentNotBefore { bone: bone() });
        }
        if !(self.length >= 0.0 && self.length.is_finite()) {
            return Err(SkeletonError::BadLength {
                bone: bone(),
                length: self.length,
            });
        }
        for (limits, angle) in self
            .limits
            .iter()
            .zip(["first twist", "bend", "second twist"])
        {
            if !limits.is_valid() {
                return Err(SkeletonError::BadLimits {
                    bone: bone(),
                    angle,
                    lower: limits.lower,
                    upper: limits.upper,
                });
            }
        }
        self.model_from_rest
            .check_rigid(ORTHONORMAL_WITHIN)
            .map_err(|problem| SkeletonError::BadRest {
                bone: bone(),
                problem,
            })
    }
}
