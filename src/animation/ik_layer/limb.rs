//! A limb of two bones whose end is brought to a point, in closed form.

use glam::{Affine3A, Mat3A, Quat, Vec3A};

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
    /// whole, so a hinge stays a hinge. A goal that is not finite changes nothing.
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
        let weight = if goal.weight > 0.0 {
            goal.weight.min(1.0)
        } else {
            0.0
        };
        if weight == 0.0 || !goal.target.is_finite() {
            return Ok(());
        }
        let from = |bone: Option<BoneId>, root: Option<BoneId>| placed(armature, pose, bone, root);
        let above = from(armature.parent(self.upper), None);
        let upper = above * Placed::of(pose, self.upper);
        let above_lower = upper * from(armature.parent(self.lower), Some(self.upper));
        let lower = above_lower * Placed::of(pose, self.lower);

        let [root, mid] = [upper.affine.translation, lower.affine.translation];
        let end = lower.affine.transform_point3a(self.end);
        let target = end + (goal.target - end) * weight;
        let side = mid - root;
        let pole = goal.pole.filter(|pole| pole.is_finite());
        let towards = pole.map_or(side, |pole| side + (pole - root - side) * weight);
        let lengths = [side.length(), (end - mid).length()].map(f64::from);
        let solved = triangle(double(root), lengths, double(target), double(towards));
        let [new_mid, new_end] = [single(solved.mid), single(solved.tip)];
        if !(new_mid.is_finite() && new_end.is_finite()) {
            return Ok(());
        }

        let old = normal(end - root, side, towards);
        let new = normal(new_end - root, new_mid - root, towards);
        let turn = |was: Vec3A, is: Vec3A| between(frame(was, old), frame(is, new));
        let upper_turn = turn(side, new_mid - root);
        let lower_turn = turn(end - mid, new_end - new_mid);
        let (upper_turn, lower_turn) = match (upper_turn, lower_turn) {
            (Some(upper), Some(lower)) => (upper, lower),
            // A bone without length has nowhere to point.
            _ => return Ok(()),
        };
        let set = |pose: &mut Pose, bone: BoneId, rotation: Quat| {
            if let Some(own) = pose.rotations.get_mut(bone.index()) {
                *own = rotation.normalize();
            }
        };
        let parent_from_model = above.rotation.conjugate();
        set(
            pose,
            self.upper,
            parent_from_model * upper_turn * upper.rotation,
        );
        let parent_from_model = (upper_turn * above_lower.rotation).conjugate();
        set(
            pose,
            self.lower,
            parent_from_model * lower_turn * lower.rotation,
        );
        Ok(())
    }
}

/// A bone in the model, or in a bone above it.
#[derive(Clone, Copy)]
struct Placed {
    affine: Affine3A,
    rotation: Quat,
}

impl Placed {
    fn of(pose: &Pose, bone: BoneId) -> Self {
        let local = pose.local(bone);
        Self {
            affine: local.to_affine(),
            rotation: local.rotation,
        }
    }
}

impl std::ops::Mul for Placed {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            affine: self.affine * other.affine,
            rotation: self.rotation * other.rotation,
        }
    }
}

/// Where a bone is in the coordinates of a bone above it (in the model without one).
fn placed(armature: &Armature, pose: &Pose, bone: Option<BoneId>, above: Option<BoneId>) -> Placed {
    let mut product = Placed {
        affine: Affine3A::IDENTITY,
        rotation: Quat::IDENTITY,
    };
    let mut next = bone.filter(|bone| Some(*bone) != above);
    while let Some(bone) = next {
        product = Placed::of(pose, bone) * product;
        next = armature.parent(bone).filter(|bone| Some(*bone) != above);
    }
    product
}

/// The normal of the limb's plane: of the way to its end and the side of its middle, or, where it is
/// stretched, the side that is asked for.
fn normal(way: Vec3A, mid: Vec3A, towards: Vec3A) -> Vec3A {
    let across = way.cross(mid);
    let straight = across.length_squared() < 1e-6 * way.length_squared() * mid.length_squared();
    let own = if straight {
        None
    } else {
        across.try_normalize()
    };
    let asked = || {
        let across = mid.cross(towards);
        let flat = 1e-6 * mid.length_squared() * towards.length_squared();
        let usable = across.length_squared() > flat;
        usable.then(|| across.try_normalize()).flatten()
    };
    own.or_else(asked).unwrap_or_else(|| {
        let along = mid.try_normalize().unwrap_or(Vec3A::X);
        along.any_orthonormal_vector()
    })
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
