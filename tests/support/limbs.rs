//! Arm for tests of inverse kinematics on poses.

use glam::{Affine3A, Quat, Vec3A};
use kinopt::animation::{Armature, Limb, Pose};

use super::armatures::{apart, bone, rotation};
use super::random::Random;

/// Chain hips, spine, upper, (twist), lower, hand, with one more bone on the spine. The limb's bones are along x and
/// meet in a hinge about z.
pub fn arm() -> Armature {
    let bones = vec![
        bone("hips", None, Vec3A::Y),
        bone("spine", Some(0), Vec3A::Y * 0.5),
        bone("upper", Some(1), Vec3A::new(0.2, 0.1, 0.0)),
        bone("twist", Some(2), Vec3A::X * 0.15),
        bone("lower", Some(3), Vec3A::X * 0.15),
        bone("hand", Some(4), Vec3A::X * 0.25),
        bone("bystander", Some(1), Vec3A::X * -0.2),
    ];
    Armature::new(bones, Vec::new()).unwrap()
}

pub const END: Vec3A = Vec3A::new(0.25, 0.0, 0.0);

pub fn limb(armature: &Armature) -> Limb {
    let bone = |name| armature.bone(name).unwrap();
    Limb::new(armature, bone("upper"), bone("lower"), END).unwrap()
}

pub fn turn(armature: &Armature, pose: &mut Pose, name: &str, by: Quat) {
    let bone = armature.bone(name).unwrap();
    let mut local = pose.local(bone).unwrap();
    local.rotation *= by;
    pose.set_local(bone, local).unwrap();
}

/// Pose with the elbow bent about its hinge.
pub fn bent(armature: &Armature, random: &mut Random) -> Pose {
    let mut pose = armature.rest().clone();
    for name in ["hips", "spine", "upper"] {
        turn(armature, &mut pose, name, rotation(random, 1.2));
    }
    turn(
        armature,
        &mut pose,
        "lower",
        Quat::from_rotation_z(random.within(0.2, 2.0) as f32),
    );
    pose
}

pub struct JointPositions {
    pub root: Vec3A,
    pub mid: Vec3A,
    pub end: Vec3A,
}

pub fn joint_positions(armature: &Armature, pose: &Pose) -> JointPositions {
    let mut model = vec![Affine3A::IDENTITY; armature.bones()];
    armature.local_to_model(pose, &mut model).unwrap();
    let transform_of = |name| &model[armature.bone(name).unwrap().index()];
    JointPositions {
        root: transform_of("upper").translation,
        mid: transform_of("lower").translation,
        end: transform_of("lower").transform_point3a(END),
    }
}

/// Random target within reach of the arm from its pose.
pub fn reachable(random: &mut Random, from: &JointPositions) -> Vec3A {
    let direction = rotation(random, 3.0) * Vec3A::X;
    from.root + direction * random.within(0.12, 0.5) as f32
}

/// Largest angle between the rotations of a bone in two poses, radians.
pub fn largest_turn(a: &Pose, b: &Pose) -> f32 {
    let turns = a.rotations().iter().zip(b.rotations());
    turns.map(|(a, b)| apart(*a, *b)).fold(0.0, f32::max)
}
