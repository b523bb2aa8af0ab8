//! Two-bone IK of limbs, in closed form.

mod goal;
mod plane;
mod reach;

pub use goal::{EndRotation, LimbGoal};

use glam::Vec3A;

use crate::animation::{Armature, LayerError};
use kinopt_kinematics::skeleton::BoneId;

/// Two bones and an end point to be moved to a target: thigh and shin, or upper arm and forearm. Bones between the two
/// rotate with the upper one.
///
/// ```
/// use glam::{Affine3A, Vec3A};
/// use kinopt::animation::{Armature, ArmatureBone, Limb, LimbGoal, LocalTransform};
///
/// let bone = |name: &str, parent, translation| ArmatureBone {
///     name: name.into(),
///     parent,
///     rest: LocalTransform { translation, ..LocalTransform::IDENTITY },
/// };
/// let armature = Armature::new(
///     vec![
///         bone("thigh", None, Vec3A::Y),
///         bone("shin", Some(0), Vec3A::Y * -0.5),
///         bone("foot", Some(1), Vec3A::Y * -0.5),
///     ],
///     Vec::new(),
/// )?;
/// let [thigh, shin, foot] = ["thigh", "shin", "foot"].map(|name| armature.bone(name));
/// let leg = Limb::to_bone(&armature, thigh?, shin?, foot?)?.with_hinge(Vec3A::X)?;
///
/// let mut pose = armature.rest().clone();
/// leg.reach(&armature, &mut pose, &LimbGoal::at(Vec3A::Y * 0.3))?;
/// let mut model = vec![Affine3A::IDENTITY; 3];
/// armature.local_to_model(&pose, &mut model)?;
/// assert!(model[2].translation.abs_diff_eq(Vec3A::Y * 0.3, 1e-6));
/// // A positive rotation about the hinge moves the knee forwards, along +z.
/// assert!(model[1].translation.z > 0.3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    upper: BoneId,
    lower: BoneId,
    end: LimbEnd,
    hinge: Option<Vec3A>,
    softened_from: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum LimbEnd {
    /// In the lower bone's coordinates.
    Point(Vec3A),
    /// Origin of a bone.
    Bone(BoneId),
}

impl Limb {
    /// Limb that ends in a point in the lower bone's coordinates, such as the tip of a leaf bone.
    ///
    /// # Errors
    /// A [`LayerError`].
    pub fn new(
        armature: &Armature,
        upper: BoneId,
        lower: BoneId,
        end: Vec3A,
    ) -> Result<Self, LayerError> {
        if !end.is_finite() {
            return Err(LayerError::BadEnd);
        }
        Self::checked(armature, [upper, lower], LimbEnd::Point(end))
    }

    /// Limb that ends at the origin of a third bone, a hand or foot, with its position in the pose. Goals can set the
    /// rotation of that bone.
    ///
    /// # Errors
    /// A [`LayerError`].
    pub fn to_bone(
        armature: &Armature,
        upper: BoneId,
        lower: BoneId,
        end: BoneId,
    ) -> Result<Self, LayerError> {
        check_descendant(armature, end, lower)?;
        Self::checked(armature, [upper, lower], LimbEnd::Bone(end))
    }

    fn checked(
        armature: &Armature,
        [upper, lower]: [BoneId; 2],
        end: LimbEnd,
    ) -> Result<Self, LayerError> {
        check_descendant(armature, lower, upper)?;
        Ok(Self {
            upper,
            lower,
            end,
            hinge: None,
            softened_from: 1.0,
        })
    }

    /// Sets the hinge axis of the elbow or knee, in the lower bone's coordinates. A positive rotation bends the joint
    /// in its allowed direction. A straight limb bends about the hinge. A limb that the pose bends about another axis
    /// is rotated to its hinge by the goal's weight.
    ///
    /// # Errors
    /// The axis is not finite or zero.
    /// An axis that is not finite or has no length.
    pub fn with_hinge(mut self, axis: impl Into<Vec3A>) -> Result<Self, LayerError> {
        let axis = axis.into();
        self.hinge = Some(axis.try_normalize().ok_or(LayerError::BadHinge)?);
        Ok(self)
    }

    /// Softens the motion of the end as the limb becomes straight, so that the elbow or knee does not snap. With
    /// fraction s and limb length ℓ, targets at a distance d above sℓ from the root are pulled in. They count as sℓ +
    /// (1 − s)ℓ (1 − e^(−(d − sℓ)/((1 − s)ℓ))), which is always below ℓ. Usual values are 0.95 to 0.98; the default 1
    /// disables softening.
    ///
    /// # Errors
    /// The fraction is outside [0, 1].
    pub fn with_softening(mut self, share: f32) -> Result<Self, LayerError> {
        if !(0.0..=1.0).contains(&share) {
            return Err(LayerError::BadSoftening { share });
        }
        self.softened_from = share;
        Ok(self)
    }
}

/// Checks that a bone is a descendant of another.
fn check_descendant(armature: &Armature, lower: BoneId, upper: BoneId) -> Result<(), LayerError> {
    let bones = armature.bones();
    let name = |bone: BoneId| {
        let bone = bone.index();
        let name = armature.names().get(bone).cloned();
        name.ok_or(LayerError::UnknownBone { bone, bones })
    };
    let (upper_name, lower_name) = (name(upper)?, name(lower)?);
    let mut ancestors = armature.bone_and_ancestors(armature.parent(lower));
    match ancestors.any(|bone| bone == upper) {
        true => Ok(()),
        false => Err(LayerError::NotAbove {
            lower: lower_name,
            upper: upper_name,
        }),
    }
}
