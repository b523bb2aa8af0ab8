//! Hinges: bones that rotate about one axis.

use std::collections::BTreeMap;

use super::{ANGLES_PER_BONE, BoneId, Skeleton};
use crate::model::{Limits, ModelError};
use crate::scalar::elementary;
use crate::spatial::{Quaternion, Vector3};

/// Limits of a locked twist, radians.
const LOCKED: Limits = Limits::new(0.0, 0.0);

/// A joint about one axis, as in knees and elbows.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Hinge {
    /// Axis in the bone's own axes; any length except zero. Positive angles rotate by the right-hand rule.
    pub axis: Vector3<f64>,
    /// Angles from rest, radians.
    pub limits: Limits,
}

impl Hinge {
    /// Rotation from rest by an angle in radians, in the bone's axes.
    #[doc(hidden)]
    #[must_use]
    pub fn rotation(&self, angle: f64) -> Quaternion<f64> {
        let (sine, cosine) = (elementary::sin(0.5 * angle), elementary::cos(0.5 * angle));
        let axis = self.axis * (1.0 / self.axis.norm());
        Quaternion {
            w: cosine,
            v: axis * sine,
        }
    }

    /// Angle in (−π, π] of the rotation about the axis that is closest to `rotation`, radians.
    #[doc(hidden)]
    #[must_use]
    pub fn angle_of(&self, rotation: Quaternion<f64>) -> f64 {
        let along = rotation.v.dot(self.axis) * (1.0 / self.axis.norm());
        let angle = 2.0 * elementary::atan2(along, rotation.w);
        let turn = 2.0 * std::f64::consts::PI;
        match angle {
            angle if angle > std::f64::consts::PI => angle - turn,
            angle if angle <= -std::f64::consts::PI => angle + turn,
            angle => angle,
        }
    }
}

/// Hinges by bone name.
pub type Hinges = BTreeMap<String, Hinge>;

/// Hinge of a bone, and the limits that the bone has without it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct HingedBone {
    pub(super) hinge: Hinge,
    pub(super) limits: [Limits; ANGLES_PER_BONE],
}

impl Skeleton {
    /// The skeleton with other hinges; those of this skeleton are removed.
    ///
    /// The bend of a hinged bone is the angle about its axis, within the limits of the hinge. Both twists are locked
    /// at 0. The numbers of a configuration and the axes of frames do not change.
    ///
    /// ```
    /// use kinopt::model::Limits;
    /// use kinopt::skeleton::{Hinge, Hinges};
    /// use kinopt::spatial::Vector3;
    /// # use kinopt::Skeleton;
    /// # use kinopt::skeleton::Bone;
    /// # use kinopt::spatial::Placement;
    /// # let mut builder = Skeleton::builder("arm");
    /// # let bone = |name: &str, parent, along: f64| Bone {
    /// #     name: name.to_owned(), parent, length: 0.3, limits: [Limits::UNBOUNDED; 3],
    /// #     model_from_rest: Placement::translation(Vector3::new(along, 0.0, 0.0)),
    /// # };
    /// # let upper = builder.add(bone("upper", None, 0.0));
    /// # let fore = builder.add(bone("fore", Some(upper), 0.3));
    /// # let skeleton = builder.build()?;
    /// let elbow = Hinge { axis: Vector3::new(0.0, 1.0, 0.0), limits: Limits::new(0.0, 2.6) };
    /// let hinged = skeleton.with_hinges(&Hinges::from([("fore".to_owned(), elbow)]))?;
    /// let tip = hinged.pose(&[0.0, 0.0, 0.0, 0.0, std::f64::consts::FRAC_PI_2, 0.0])?.tip(&hinged, fore)?;
    /// assert!((tip.z + 0.3).abs() < 1e-12);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// An unknown bone, a locked bone, an axis of length 0, or limits that are no interval.
    pub fn with_hinges(&self, hinges: &Hinges) -> Result<Self, ModelError> {
        let mut bones = self.bones.clone();
        for (bone, hinged) in &self.hinges {
            bones[bone.index()].limits = hinged.limits;
        }
        let mut hinged_bones = BTreeMap::new();
        for (name, &hinge) in hinges {
            let id = self.bone(name)?;
            let bone = &mut bones[id.index()];
            let fail = |problem: &str| ModelError::BadHinge {
                bone: name.clone(),
                problem: problem.to_owned(),
            };
            let length = hinge.axis.norm();
            if !(length > 0.0 && length.is_finite()) {
                return Err(fail("the axis must be finite and not zero"));
            }
            if !hinge.limits.is_valid() {
                return Err(fail("the limits are no interval"));
            }
            if bone.limits.iter().all(Limits::is_locked) {
                return Err(fail("the bone is locked"));
            }
            let limits = bone.limits;
            bone.limits = [LOCKED, hinge.limits, LOCKED];
            hinged_bones.insert(id, HingedBone { hinge, limits });
        }
        Self::assemble(self.model.name().to_owned(), bones, hinged_bones)
    }

    /// The hinges by bone name.
    #[must_use]
    pub fn hinges(&self) -> Hinges {
        let hinges = self.hinges.iter();
        let named =
            hinges.map(|(bone, hinged)| (self.bones[bone.index()].name.clone(), hinged.hinge));
        named.collect()
    }

    /// The hinge of a bone; `None` for a bone of three angles.
    #[must_use]
    pub fn hinge(&self, bone: BoneId) -> Option<Hinge> {
        self.hinges.get(&bone).map(|hinged| hinged.hinge)
    }
}
