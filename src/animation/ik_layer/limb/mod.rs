//! A limb of two bones whose end is brought to a point, in closed form.

mod plane;

use glam::{Mat3A, Quat, Vec3A};

use self::plane::Plane;
use super::placed::{Placed, set_rotation};
use crate::animation::blend::within;
use crate::animation::{Armature, Pose, SizeMismatch};
use crate::geometric::triangle;
use crate::skeleton::BoneId;
use crate::spatial::Vector3;

/// A thigh and a shin, an upper arm and a forearm: two bones of an armature and the point that
/// should go somewhere. Bones between the two turn with the upper one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limb {
    upper: BoneId,
    lower: BoneId,
    end: Vec3A,
}

/// Bones that are no limb.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum LimbError {
    /// A bone of another armature.
    #[error("bone {bone} does not exist; the armature has {bones}")]
    UnknownBone {
        /// The bone's index.
        bone: usize,
        /// How many bones there are.
        bones: usize,
    },
    /// The lower bone does not hang on the upper one.
    #[error("bone `{lower}` does not hang on bone `{upper}`")]
    NotAbove {
        /// The lower bone.
        lower: String,
        /// The upper bone.
        upper: String,
    },
    /// An end that is not finite.
    #[error("the end of the limb is not finite")]
    BadEnd,
}

/// What the end of a limb should do this frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LimbGoal {
    /// Where the end should be, in model coordinates.
    pub target: Vec3A,
    /// The point towards which the elbow or knee goes, in model coordinates; `None` keeps the side
    /// that the pose has.
    pub pole: Option<Vec3A>,
    /// From 0, the pose as it is, to 1, the end at the target: the end goes this share of the way.
    /// Taken into [0, 1]; NaN counts as 0.
    pub weight: f32,
}

impl Limb {
    /// The limb of two bones and its end, a point in the lower bone's coordinates: the rest
    /// translation of a hand in its forearm, or the tip of a bone.
    ///
    /// # Errors
    /// A [`LimbError`].
    pub fn new(
        armature: &Armature,
        upper: BoneId,
        lower: BoneId,
        end: Vec3A,
    ) -> Result<Self, LimbError> {
        let bones = armature.bones();
        let name = |bone: BoneId| {
            let bone = bone.index();
            let name = armature.names().get(bone).cloned();
            name.ok_or(LimbError::UnknownBone { bone, bones })
        };
        let (upper_name, lower_name) = (name(upper)?, name(lower)?);
        let mut above = armature.parent(lower);
        while above.is_some_and(|bone| bone != upper) {
            above = above.and_then(|bone| armature.parent(bone));
        }
        if above.is_none() {
            return Err(LimbError::NotAbove {
                lower: lower_name,
                upper: upper_name,
            });
        }
        if !end.is_finite() {
            return Err(LimbError::BadEnd);
        }
        Ok(Self { upper, lower, end })
    }

    /// Turns the two bones of a pose so that the end goes its weight's share of the way to the
    /// target, or as near as the bones reach (the law of cosines). The plane of the limb turns as a
    /// whole, by the shortest arc to the target and then towards the pole, so a hinge stays a hinge. A
    /// goal that is not finite changes nothing.
    ///
    /// Bones above the limb may be scaled by the same number along all axes, not by different ones.
    ///
    /// # Errors
    /// The pose is of another armature.
    pub fn reach(
        &self,
        armature: &Armature,
        pose: &mut Pose,
        goal: &LimbGoal,
    ) -> Result<(), SizeMismatch> {
        armature.rest().check_same_size(pose)?;
        let weight = within(goal.weight);
        if weight == 0.0 || !goal.target.is_finite() {
            return Ok(());
        }
        let place = |bone, above| Placed::within(armature, pose, bone, above);
        let above = place(armature.parent(self.upper), None);
        let upper = above * Placed::local(pose, self.upper);
        let above_lower = upper * place(armature.parent(self.lower), Some(self.upper));
        let lower = above_lower * Placed::local(pose, self.lower);

        let [root, mid] = [upper.affine.translation, lower.affine.translation];
        let end = lower.affine.transform_point3a(self.end);
        let target = end + (goal.target - end) * weight;
        let pole = goal.pole.filter(|pole| pole.is_finite());
        let pole = pole.map(|pole| pole - root);
        let old = Plane::of(end - root, mid - root, pole);
        let mut new = old.carried(target - root);
        if let Some(angle) = pole.and_then(|pole| new.angle_to(pole)) {
            new = new.turned(angle * weight);
        }
        let lengths = [mid - root, end - mid].map(|bone| f64::from(bone.length()));
        let solved = triangle(double(root), lengths, double(target), double(new.side()));
        let [new_mid, new_end] = [single(solved.mid), single(solved.tip)];
        if !(new_mid.is_finite() && new_end.is_finite()) {
            return Ok(());
        }

        let turn = |was: Vec3A, is: Vec3A| between(frame(was, old.normal), frame(is, new.normal));
        let upper_turn = turn(mid - root, new_mid - root);
        let lower_turn = turn(end - mid, new_end - new_mid);
        let (upper_turn, lower_turn) = match (upper_turn, lower_turn) {
            (Some(upper), Some(lower)) => (upper, lower),
            // A bone without length has nowhere to point.
            _ => return Ok(()),
        };
        let parent_from_model = above.rotation.conjugate();
        let rotation = parent_from_model * upper_turn * upper.rotation;
        set_rotation(pose, self.upper, rotation);
        let parent_from_model = (upper_turn * above_lower.rotation).conjugate();
        let rotation = parent_from_model * lower_turn * lower.rotation;
        set_rotation(pose, self.lower, rotation);
        Ok(())
    }
}

/// Axes along a direction in a plane; `None` for a direction without length.
fn frame(along: Vec3A, normal: Vec3A) -> Option<Mat3A> {
    let x = along.try_normalize()?;
    let z = (normal - x * normal.dot(x)).try_normalize()?;
    Some(Mat3A::from_cols(x, z.cross(x), z))
}

/// The rotation that takes axes to others.
fn between(from: Option<Mat3A>, to: Option<Mat3A>) -> Option<Quat> {
    Some(Quat::from_mat3a(&(to? * from?.transpose())))
}

fn double(v: Vec3A) -> Vector3<f64> {
    Vector3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z))
}

fn single(v: Vector3<f64>) -> Vec3A {
    Vec3A::from(crate::mesh::single_precision(v))
}
