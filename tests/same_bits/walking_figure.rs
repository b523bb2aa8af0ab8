//! A figure of few bones that walks, without the system's sines.
#![allow(clippy::unwrap_used)]

use glam::{Quat, Vec3};
use kinopt::Scalar;
use kinopt::animation::{Armature, Clip, Pose};
use kinopt::skeleton::BoneId;
use support::armatures::bone;

/// Thigh and shin, metres.
const LEG: f32 = 0.45;

/// Hips with two legs and an arm on a chest.
pub(crate) fn figure() -> Armature {
    let bones = vec![
        bone("world", None, [0.0, 0.0, 0.0]),
        bone("hips", Some(0), [0.0, 0.88, 0.0]),
        bone("thigh.l", Some(1), [0.1, 0.0, 0.0]),
        bone("shin.l", Some(2), [0.0, -LEG, 0.0]),
        bone("foot.l", Some(3), [0.0, -LEG, 0.0]),
        bone("thigh.r", Some(1), [-0.1, 0.0, 0.0]),
        bone("shin.r", Some(5), [0.0, -LEG, 0.0]),
        bone("foot.r", Some(6), [0.0, -LEG, 0.0]),
        bone("chest", Some(1), [0.0, 0.4, 0.0]),
        bone("arm", Some(8), [0.2, 0.1, 0.0]),
        bone("forearm", Some(9), [0.3, 0.0, 0.0]),
        bone("hand", Some(10), [0.25, 0.0, 0.0]),
        bone("head", Some(8), [0.0, 0.2, 0.0]),
    ];
    Armature::new(bones, Vec::new()).unwrap()
}

/// About x, z or y by an angle, without the system's sines.
pub(crate) fn turn(axis: Vec3, angle: f64) -> Quat {
    let (sin, cos) = Scalar::sin_cos(0.5 * angle);
    let [x, y, z] = (axis * sin as f32).to_array();
    Quat::from_xyzw(x, y, z, cos as f32).normalize()
}

/// Bends a leg so that its foot is at a place from its hip, by roots alone, and keeps the foot level.
fn bend(pose: &mut Pose, [thigh, shin, foot]: [BoneId; 3], at: Vec3) {
    let far = at.length();
    let along = 0.5 * far;
    let out = (LEG * LEG - along * along).max(0.0).sqrt();
    let way = at / far;
    let forward = Vec3::new(0.0, -way.z, way.y) * if way.y < 0.0 { -1.0 } else { 1.0 };
    let knee = way * along + forward * out;
    let thigh_turn = Quat::from_rotation_arc(Vec3::NEG_Y, knee.normalize());
    let shin_way = thigh_turn.inverse() * (at - knee);
    let shin_turn = Quat::from_rotation_arc(Vec3::NEG_Y, shin_way.normalize());
    pose.set_rotation(thigh, thigh_turn).unwrap();
    pose.set_rotation(shin, shin_turn).unwrap();
    pose.set_rotation(foot, (thigh_turn * shin_turn).inverse())
        .unwrap();
}

/// A walk of 1.1 seconds along z, or on the spot, whose feet slip a little while they stand.
pub(crate) fn walk(armature: &Armature, travels: bool) -> Clip {
    let id = |name: &str| armature.bone(name).unwrap();
    let times: Vec<f32> = (0..=22).map(|k| k as f32 / 20.0).collect();
    let poses = times.iter().map(|&time| {
        let mut pose = armature.rest().clone();
        let forward = if travels { 1.2 * time } else { 0.0 };
        let (bob, sway) = Scalar::sin_cos(8.0 * f64::from(time));
        let height = 0.8 + 0.01 * bob as f32;
        let hips = Vec3::new(0.01 * sway as f32, height, forward);
        pose.set_translation(id("hips"), hips.into()).unwrap();
        for (side, phase) in [("l", 0.0), ("r", 0.5)] {
            let cycle = (time + phase).fract();
            let (z, y) = if cycle < 0.6 {
                (0.36 - 1.2 * cycle + 0.02 * cycle * (0.6 - cycle), 0.0)
            } else {
                let share = (cycle - 0.6) / 0.4;
                let eased = share * share * (3.0 - 2.0 * share);
                (-0.36 + 0.72 * eased, 0.4 * share * (1.0 - share))
            };
            let limb = ["thigh", "shin", "foot"].map(|part| id(&format!("{part}.{side}")));
            bend(&mut pose, limb, Vec3::new(0.0, y - height, z));
        }
        pose.set_rotation(id("arm"), turn(Vec3::Z, -0.8 + 0.2 * sway))
            .unwrap();
        pose
    });
    let poses: Vec<Pose> = poses.collect();
    Clip::through_poses("walk", armature, &times, &poses).unwrap()
}
