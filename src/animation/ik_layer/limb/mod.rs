//! A limb of two bones whose end is brought to a point, in closed form.

mod error;
mod goal;
mod plane;
mod reach;

pub use error::LimbError;
pub use goal::{EndRotation, LimbGoal};

use glam::Vec3A;

use crate::animation::Armature;
use crate::skeleton::BoneId;

/// A thigh and a shin, an upper arm and a forearm: two bones of an armature and the point that
/// should go somewhere. Bones between the two turn with the upper one.
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
/// // From a straight leg, a positive turn about the hinge: the knee goes forwards, along +z.
/// assert!(model[1].translation.z > 0.3);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    upper: BoneId,
    lower: BoneId,
    end: End,
    hinge: Option<Vec3A>,
    softened_from: f32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum End {
    /// In the lower bone's coordinates.
    Point(Vec3A),
    /// The origin of a bone.
    Bone(BoneId),
}

impl Limb {
    /// The limb of two bones and its end, a point in the lower bone's coordinates: the tip of a bone
    /// that none hangs on.
    ///
    /// # Errors
    /// A [`LimbError`].
    pub fn new(
        armature: &Armature,
        upper: BoneId,
        lower: BoneId,
        end: Vec3A,
    ) -> Result<Self, LimbError> {
        if !end.is_finite() {
            return Err(LimbError::BadEnd);
        }
        Self::checked(armature, [upper, lower], End::Point(end))
    }

    /// The limb of two bones that ends where a third one starts, a hand or a foot, wherever the pose
    /// has that. Goals may say how it is turned.
    ///
    /// # Errors
    /// A [`LimbError`].
    pub fn to_bone(
        armature: &Armature,
        upper: BoneId,
        lower: BoneId,
        end: BoneId,
    ) -> Result<Self, LimbError> {
        hangs(armature, end, lower)?;
        Self::checked(armature, [upper, lower], End::Bone(end))
    }

    fn checked(
        armature: &Armature,
        [upper, lower]: [BoneId; 2],
        end: End,
    ) -> Result<Self, LimbError> {
        hangs(armature, lower, upper)?;
        Ok(Self {
            upper,
            lower,
            end,
            hinge: None,
            softened_from: 1.0,
        })
    }

    /// The axis about which the elbow or knee bends, in the lower bone's coordinates: a positive turn
    /// bends it the way it may. It says where a stretched limb bends, and a limb that the pose bends
    /// otherwise comes back to its hinge by the goal's weight.
    ///
    /// # Errors
    /// An axis that is not finite or has no length.
    pub fn with_hinge(mut self, axis: impl Into<Vec3A>) -> Result<Self, LimbError> {
        let axis = axis.into();
        self.hinge = Some(axis.try_normalize().ok_or(LimbError::BadHinge)?);
        Ok(self)
    }

    /// Slows the limb's end down as the limb is nearly stretched, so that the elbow or knee does not
    /// snap: beyond the share s of the limb's length ℓ, a target at distance d from the root counts as
    /// one at sℓ + (1 − s)ℓ (1 − e^(−(d − sℓ)/((1 − s)ℓ))), which never comes to ℓ. Some 0.95 to 0.98
    /// do; 1, as without this, is not softened at all.
    ///
    /// # Errors
    /// A share that is not within [0, 1].
    pub fn with_softening(mut self, share: f32) -> Result<Self, LimbError> {
        if !(0.0..=1.0).contains(&share) {
            return Err(LimbError::BadSoftening { share });
        }
        self.softened_from = share;
        Ok(self)
    }
}

/// Checks that a bone hangs on another one, directly or not.
fn hangs(armature: &Armature, lower: BoneId, upper: BoneId) -> Result<(), LimbError> {
    let bones = armature.bones();
    let name = |bone: BoneId| {
        let bone = bone.index();
        let name = armature.names().get(bone).cloned();
        name.ok_or(LimbError::UnknownBone { bone, bones })
    };
    let (upper_name, lower_name) = (name(upper)?, name(lower)?);
    let mut above = armature.upwards(armature.parent(lower));
    match above.any(|bone| bone == upper) {
        true => Ok(()),
        false => Err(LimbError::NotAbove {
            lower: lower_name,
            upper: upper_name,
        }),
    }
}
