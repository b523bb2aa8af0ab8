//! Solution of a limb for a goal.

use glam::{Mat3A, Quat, Vec3A};

use super::plane::LimbPlane;
use super::{EndRotation, Limb, LimbEnd, LimbGoal};
use crate::animation::blend::{clamp_to_unit, finite_or_0};
use crate::animation::ik_layer::bone_placement::{BonePlacement, set_rotation};
use crate::animation::ik_layer::{Corrected, ShearCorrection};
use crate::animation::rotation::slerp;
use crate::animation::{Armature, Pose, SizeMismatch};
use kinopt_kinematics::scalar::elementary::single;
use kinopt_kinematics::spatial::Vector3;
use kinopt_solver::geometric::triangle;

/// Distance of the end from its target at single precision, as a fraction of the limb's length.
const RELATIVE_TOLERANCE: f64 = 3e-7;

/// Limb of a pose in the model: its bones, their parents and its points.
struct PosedLimb {
    parent: BonePlacement,
    upper: BonePlacement,
    lower_parent: BonePlacement,
    lower: BonePlacement,
    root: Vec3A,
    mid: Vec3A,
    end: Vec3A,
}

impl PosedLimb {
    /// True if the limb's bone lengths allow its end to be at a point.
    fn reaches(&self, point: Vec3A) -> bool {
        let lengths = [self.root.distance(self.mid), self.mid.distance(self.end)];
        let distance = self.root.distance(point);
        distance < lengths[0] + lengths[1] && distance > (lengths[0] - lengths[1]).abs()
    }
}

impl Limb {
    /// Rotates the two bones so that the end moves towards the target by the goal's weight, or to the closest reachable
    /// point (law of cosines). The plane of the limb rotates rigidly, by the shortest arc to the target and then
    /// towards the pole, so a hinge remains a hinge. The bone at the end is rotated last. A target that is not finite
    /// leaves the two bones unchanged.
    ///
    /// Uneven scales shear the bones that rotate below them. The limb is then corrected until its end is at the
    /// position of an unsheared limb, as far as this converges.
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
        let weight = clamp_to_unit(goal.weight);
        let moves = weight > 0.0 && goal.target.is_finite();
        let end_rotation = match self.end {
            LimbEnd::Bone(bone) => {
                end_rotation_goal(goal.end).map(|(goal, weight)| (bone, goal, weight))
            }
            LimbEnd::Point(_) => None,
        };
        if !moves && end_rotation.is_none() {
            return Ok(());
        }
        let limb = self.posed_limb(armature, pose);
        let target = self.end_target(&limb, goal, weight);
        let rotations = moves.then(|| self.bone_rotations(&limb, target, goal, weight));
        let mut lower_rotation = Quat::IDENTITY;
        if let Some(rotations) = rotations.flatten() {
            lower_rotation = rotations[1];
            self.rotate_bones(pose, &limb, rotations);
            if limb.lower.uneven {
                lower_rotation = self.correct(armature, pose, target) * lower_rotation;
            }
        }
        if let Some((bone, rotation, weight)) = end_rotation {
            let parent = armature.parent(bone);
            let parent = BonePlacement::within(armature, pose, parent, Some(self.lower));
            let before = limb.lower * parent;
            let (mirror, before) = (before.mirror, before.rotation);
            let after = lower_rotation * before;
            let local = mirror.single(pose.local_of(bone).rotation);
            let goal_rotation = rotation.unwrap_or(before * local);
            let rotation = slerp(after * local, goal_rotation, weight);
            set_rotation(pose, bone, mirror.single(after.conjugate() * rotation));
        }
        Ok(())
    }

    /// Rotates the two bones of a pose in the model.
    fn rotate_bones(
        &self,
        pose: &mut Pose,
        limb: &PosedLimb,
        [upper_rotation, lower_rotation]: [Quat; 2],
    ) {
        let parent_from_model = limb.parent.rotation.conjugate();
        let rotation = parent_from_model * upper_rotation * limb.upper.rotation;
        set_rotation(pose, self.upper, limb.parent.mirror.single(rotation));
        let parent_from_model = (upper_rotation * limb.lower_parent.rotation).conjugate();
        let rotation = parent_from_model * lower_rotation * limb.lower.rotation;
        set_rotation(pose, self.lower, limb.lower_parent.mirror.single(rotation));
    }

    /// Corrects a sheared limb until its end is at a point, as far as this converges. Returns the rotation of the lower
    /// bone in the model.
    fn correct(&self, armature: &Armature, pose: &mut Pose, target: Vec3A) -> Quat {
        let mut lower_rotation = Quat::IDENTITY;
        let mut limb = self.posed_limb(armature, pose);
        let end_of = |limb: &PosedLimb| [limb.end.as_dvec3()];
        let mut correction = ShearCorrection::new(&[target.as_dvec3()], &end_of(&limb));
        while !correction.gives_up() {
            let length = limb.root.distance(limb.mid) + limb.mid.distance(limb.end);
            if correction.off() <= RELATIVE_TOLERANCE * f64::from(length) {
                break;
            }
            let commands = correction.commands();
            let command = commands.first().map_or(target, |point| point.as_vec3a());
            let follow = LimbGoal::at(command);
            let Some(rotations) = self.bone_rotations(&limb, command, &follow, 0.0) else {
                break;
            };
            let before = [self.upper, self.lower].map(|bone| pose.local_of(bone).rotation);
            self.rotate_bones(pose, &limb, rotations);
            let corrected = self.posed_limb(armature, pose);
            let reached = limb.reaches(command);
            if correction.learn(&end_of(&corrected), reached) != Corrected::Undone {
                lower_rotation = rotations[1] * lower_rotation;
                limb = corrected;
            } else {
                set_rotation(pose, self.upper, before[0]);
                set_rotation(pose, self.lower, before[1]);
            }
        }
        lower_rotation
    }

    fn posed_limb(&self, armature: &Armature, pose: &Pose) -> PosedLimb {
        let placement = |bone, parent| BonePlacement::within(armature, pose, bone, parent);
        let parent = placement(armature.parent(self.upper), None);
        let upper = parent * BonePlacement::local(pose, self.upper);
        let lower_parent = upper * placement(armature.parent(self.lower), Some(self.upper));
        let lower = lower_parent * BonePlacement::local(pose, self.lower);
        let end = match self.end {
            LimbEnd::Point(end) => end,
            LimbEnd::Bone(bone) => placement(Some(bone), Some(self.lower)).affine.translation,
        };
        PosedLimb {
            parent,
            upper,
            lower_parent,
            lower,
            root: upper.affine.translation,
            mid: lower.affine.translation,
            end: lower.affine.transform_point3a(end),
        }
    }

    /// Position of the end: moved by the weight towards the softened target.
    fn end_target(&self, limb: &PosedLimb, goal: &LimbGoal, weight: f32) -> Vec3A {
        let &PosedLimb { root, mid, end, .. } = limb;
        let lengths = [mid - root, end - mid].map(Vec3A::length);
        let softened_target = root + self.softened(goal.target - root, lengths[0] + lengths[1]);
        end + (softened_target - end) * weight
    }

    /// Rotations of the two bones in the model that bring the end to `target`; `None` if a bone has zero length.
    /// `weight` scales the pole, twist and hinge of `goal`.
    fn bone_rotations(
        &self,
        limb: &PosedLimb,
        target: Vec3A,
        goal: &LimbGoal,
        weight: f32,
    ) -> Option<[Quat; 2]> {
        let &PosedLimb { root, mid, end, .. } = limb;
        let [upper, lower] = [mid - root, end - mid];
        let lengths = [upper.length(), lower.length()];
        let pole = goal.pole.filter(|pole| pole.is_finite());
        let pole = pole.map(|pole| pole - root);

        // Roll is measured from the hinge if there is one; the plane itself may deviate from it.
        let hinge = self.hinge.map(|axis| {
            let axis = limb.lower_parent.mirror.axis(axis.as_dvec3());
            limb.lower.rotation * axis.as_vec3a()
        });
        let (old, deviation) = LimbPlane::of_limb(end - root, upper, pole, hinge);
        let mut new = old.moved_to(target - root);
        new = match pole {
            Some(pole) if weight == 1.0 => new.facing(pole),
            Some(pole) => new.rotated(new.angle_to(pole) * weight),
            None => new,
        };
        new = new.rotated(finite_or_0(goal.twist) * weight);
        let side = new.rotated(deviation * (1.0 - weight)).side();
        let [base, target, side] = [root, target, side].map(double);
        let solved = triangle(base, lengths.map(f64::from), target, side);
        let [new_mid, new_end] = [single(solved.mid), single(solved.tip)];
        if !(new_mid.is_finite() && new_end.is_finite()) {
            return None;
        }
        let bone_rotation = |from, to| between(frame(from, old.normal), frame(to, new.normal));
        bone_rotation(upper, new_mid - root)
            .zip(bone_rotation(lower, new_end - new_mid))
            .map(<[Quat; 2]>::from)
    }

    /// Vector to a target, shortened if it nearly stretches a limb of this length. Nicholas, "Soft IK": an exponential
    /// that joins the straight line smoothly.
    fn softened(&self, to_target: Vec3A, length: f32) -> Vec3A {
        let start = self.softened_from * length;
        let [slack, distance] = [length - start, to_target.length()];
        if slack <= 0.0 || distance <= start {
            return to_target;
        }
        to_target * ((start + slack * (1.0 - single::exp(-(distance - start) / slack))) / distance)
    }
}

/// Target rotation of the end bone and its weight; `None` if the rotation does not change. The inner rotation is `None`
/// for the one before the solve.
fn end_rotation_goal(end: EndRotation) -> Option<(Option<Quat>, f32)> {
    let (rotation, weight) = match end {
        EndRotation::Follow => return None,
        EndRotation::Hold { weight } => (None, weight),
        EndRotation::Goal { rotation, weight } => {
            let unit = glam::Vec4::from(rotation).try_normalize()?;
            (Some(Quat::from_vec4(unit)), weight)
        }
    };
    let weight = clamp_to_unit(weight);
    (weight > 0.0).then_some((rotation, weight))
}

/// Axes along a direction in a plane; `None` for a zero direction.
fn frame(along: Vec3A, normal: Vec3A) -> Option<Mat3A> {
    let x = along.try_normalize()?;
    let z = (normal - x * normal.dot(x)).try_normalize()?;
    Some(Mat3A::from_cols(x, z.cross(x), z))
}

/// Rotation between two sets of axes.
fn between(from: Option<Mat3A>, to: Option<Mat3A>) -> Option<Quat> {
    Some(Quat::from_mat3a(&(to? * from?.transpose())))
}

fn double(v: Vec3A) -> Vector3<f64> {
    Vector3::new(f64::from(v.x), f64::from(v.y), f64::from(v.z))
}

fn single(v: Vector3<f64>) -> Vec3A {
    Vec3A::from(kinopt_mesh::mesh::single_precision(v))
}
