//! A bone at rest.

use crate::model::Limits;
use crate::model::ModelError;
use crate::spatial::{Placement, Vector3};

/// Largest deviation of R̂ᵀR̂ of a rest placement from the identity, per entry.
const ORTHONORMAL_TOLERANCE: f64 = 1e-6;

/// Id of a bone in one skeleton.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct BoneId(u32);

impl BoneId {
    #[doc(hidden)]
    pub fn new(index: usize) -> Self {
        Self(index as u32)
    }

    /// Index in the skeleton's list.
    #[must_use]
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// A bone at rest, with its limits.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Bone {
    /// Name, unique in the skeleton. Files without names give `bone/0`, `bone/1`, …
    pub name: String,
    /// Parent bone; `None` for a root.
    pub parent: Option<BoneId>,
    /// Length from tail to tip, in the rig's unit; may be 0.
    pub length: f64,
    /// T̂: canonical bone → model at rest.
    pub model_from_rest: Placement<f64>,
    /// Limits of (θ₁, θ₂, θ₃): first twist, bend, second twist, in radians.
    pub limits: [Limits; 3],
}

impl Bone {
    /// Position of the tail at rest, in model coordinates.
    #[must_use]
    pub fn rest_tail(&self) -> Vector3<f64> {
        self.model_from_rest.translation
    }

    /// Position of the tip at rest, in model coordinates.
    #[must_use]
    pub fn rest_tip(&self) -> Vector3<f64> {
        self.model_from_rest
            .apply(Vector3::new(self.length, 0.0, 0.0))
    }

    /// Checks a bone at `index` of its list.
    pub(super) fn check(&self, index: usize) -> Result<(), ModelError> {
        let bone = || self.name.clone();
        if self.parent.is_some_and(|parent| parent.index() >= index) {
            return Err(ModelError::ParentNotBefore { bone: bone() });
        }
        if !(self.length >= 0.0 && self.length.is_finite()) {
            return Err(ModelError::BadLength {
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
                return Err(ModelError::BadBoneLimits {
                    bone: bone(),
                    angle,
                    lower: limits.lower,
                    upper: limits.upper,
                });
            }
        }
        self.model_from_rest
            .check_rigid(ORTHONORMAL_TOLERANCE)
            .map_err(|problem| ModelError::BadRest {
                bone: bone(),
                problem,
            })
    }
}
