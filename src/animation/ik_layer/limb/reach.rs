//! The turns that bring a limb to its goal.

use glam::{Mat3A, Quat, Vec3A};

use super::plane::Plane;
use super::{End, EndRotation, Limb, LimbGoal};
use crate::animation::blend::{finite_or_0, within};
use crate::animation::ik_layer::bone_placement::{Placed, set_rotation};
use crate::animation::rotation::slerp;
use crate::animation::{Armature, Pose, SizeMismatch};
use crate::geometric::triangle;
use crate::scalar::elementary::single;
use crate::spatial::Vector3;

/// A limb as a pose has it, in the model: the rotations of its bones and of what they hang on, and its
/// points.
struct Standing {
    above: Quat,
    upper: Quat,
    above_lower: Quat,
    lower: Quat,
    root: Vec3A,
    mid: Vec3A,
    end: Vec3A,
}

impl Limb {
    /// Turns the two bones of a pose so that the end goes its weight's share of the way to the
    /// target, or as near as the bones reach (the law of cosines). The plane of the limb turns as a
    /// whole, by the shortest arc to the target and then towards the pole, so a hinge stays a hinge.
    /// Then the bone at the end is turned. A target that is not finite leaves the two bones alone.
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
        let moves = weight > 0.0 && goal.target.is_finite();
        let asked = match self.end {
            End::Bone(bone) => wanted_rotation(goal.end).map(|(goal, weight)| (bone, goal, weight)),
            End::Point(_) => None,
        };
        if !moves && asked.is_none() {
            return Ok(());
        }
        let standing = self.standing(armature, pose);
        let turns = moves.then(|| self.turns(&standing, goal, weight)).flatten();
        let [upper_turn, lower_turn] = turns.unwrap_or([Quat::IDENTITY; 2]);
        if turns.is_some() {
            let parent_from_model = standing.above.conjugate();
            let rotation = parent_from_model * upper_turn * standing.upper;
            set_rotation(pose, self.upper, rotation);
            let parent_from_model = (upper_turn * standing.above_lower).conjugate();
            let rotation = parent_from_model * lower_turn * standing.lower;
            set_rotation(pose, self.lower, rotation);
        }
        if let Some((bone, rotation, weight)) = asked {
            let above = armature.parent(bone);
            let above = Placed::within(armature, pose, above, Some(self.lower)).rotation;
            let before = standing.lower * above;
            let after = lower_turn * before;
            let local = pose.local_of(bone).rotation;
            let wanted = rotation.unwrap_or(before * local);
            let rotation = slerp(after * local, wanted, weight);
            set_rotation(pose, bone, after.conjugate() * rotation);
        }
        Ok(())
    }

    fn standing(&self, armature: &Armature, pose: &Pose) -> Standing {
        let place = |bone, above| Placed::within(armature, pose, bone, above);
        let above = place(armature.parent(self.upper), None);
        let upper = above * Placed::local(pose, self.upper);
        let above_lower = upper * place(armature.parent(self.lower), Some(self.upper));
        let lower = above_lower * Placed::local(pose, self.lower);
        let end = match self.end {
            End::Point(end) => end,
            End::Bone(bone) => place(Some(bone), Some(self.lower)).affine.translation,
        };
        Standing {
            above: above.rotation,
            upper: upper.rotation,
            above_lower: above_lower.rotation,
            lower: lower.rotation,
            root: upper.affine.translation,
            mid: lower.affine.translation,
            end: lower.affine.transform_point3a(end),
        }
    }

    /// How the two bones turn in the model; `None` where a bone without length has nowhere to point.
    fn turns(&self, standing: &Standing, goal: &LimbGoal, weight: f32) -> Option<[Quat; 2]> {
        let &Standing { root, mid, end, .. } = standing;
        let [upper, lower] = [mid - root, end - mid];
        let lengths = [upper.length(), lower.length()];
        let wanted = root + self.softened(goal.target - root, lengths[0] + lengths[1]);
        let target = end + (wanted - end) * weight;
        let pole = goal.pole.filter(|pole| pole.is_finite());
        let pole = pole.map(|pole| pole - root);

        // Roll is measured from the hinge where there is one; the plane itself may be off it.
        let hinge = self.hinge.map(|axis| standing.lower * axis);
        let (old, off) = Plane::of(end - root, upper, pole, hinge);
        let mut new = old.carried(target - root);
        new = match pole {
            Some(pole) if weight == 1.0 => new.facing(pole),
            Some(pole) => new.turned(new.angle_to(pole) * weight),
            None => new,
        };
        new = new.turned(finite_or_0(goal.twist) * weight);
        let side = new.turned(off * (1.0 - weight)).side();
        let [base, target, side] = [root, target, side].map(double);
        let solved = triangle(base, lengths.map(f64::from), target, side);
        let [new_mid, new_end] = [single(solved.mid), single(solved.tip)];
        if !(new_mid.is_finite() && new_end.is_finite()) {
            return None;
        }
        let turn = |was, is| between(frame(was, old.normal), frame(is, new.normal));
        turn(upper, new_mid - root)
            .zip(turn(lower, new_end - new_mid))
            .map(<[Quat; 2]>::from)
    }

    /// The way to a target, shortened where it nearly stretches a limb of this length (Nicholas, "Soft
    /// IK": an exponential that leaves the straight line without a kink).
    fn softened(&self, way: Vec3A, length: f32) -> Vec3A {
        let start = self.softened_from * length;
        let [room, distance] = [length - start, way.length()];
        if room <= 0.0 || distance <= start {
            return way;
        }
        way * ((start + room * (1.0 - single::exp(-(distance - start) / room))) / distance)
    }
}

/// The rotation asked for (`None` for the one from before) and how much of it; `None` where there is
/// nothing to do.
fn wanted_rotation(end: EndRotation) -> Option<(Option<Quat>, f32)> {
    let (rotation, weight) = match end {
        EndRotation::Follow => return None,
        EndRotation::Hold { weight } => (None, weight),
        EndRotation::Goal { rotation, weight } => {
            let unit = glam::Vec4::from(rotation).try_normalize()?;
            (Some(Quat::from_vec4(unit)), weight)
        }
    };
    let weight = within(weight);
    (weight > 0.0).then_some((rotation, weight))
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
