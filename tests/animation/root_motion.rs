//! Promise: an in-place clip and its root motion together are the original clip. The in-place clip keeps its start
//! position, and the root motion continues across the ends of loops.

use glam::{Affine3A, Quat, Vec3, Vec3A};
use kinopt::animation::{Armature, Clip, ClipError, Playback, Pose};
use support::armatures::{armature, pose};
use support::random::Random;

use super::baked_clips::at;

const RATE: f64 = 30.0;

/// Walk of two seconds on a circle, `rounds` times: `bone 2` moves and rotates about `up`, sways and leans. Its parents
/// are placed at random and scaled uniformly.
fn walk(up: Vec3, rounds: f32, random: &mut Random) -> (Armature, Clip) {
    let armature = armature(6, random);
    let rest = pose(&armature, random);
    let mut rest = rest;
    for bone in armature.bone_ids() {
        let mut local = rest.local(bone).unwrap();
        local.scale = Vec3A::splat(local.scale.x);
        rest.set_local(bone, local).unwrap();
    }
    let bone = armature.bone("bone 2").unwrap();
    let across = up.any_orthonormal_vector();
    let times: Vec<f32> = (0..=60).map(|k| k as f32 / 30.0).collect();
    let poses = times.iter().map(|time| {
        let turn = Quat::from_axis_angle(up, rounds * std::f32::consts::PI * time);
        let sway = up * (0.2 * (9.0 * time).sin());
        let lean = Quat::from_axis_angle(across, 0.3 * (7.0 * time).sin());
        placed(&armature, &rest, turn * lean, turn * (across * 2.0) + sway)
    });
    let poses: Vec<Pose> = poses.collect();
    let clip = Clip::through_poses("walk", &armature, &times, &poses).unwrap();
    assert_eq!(clip.bones(), armature.bones());
    assert!(armature.parent(bone).is_some());
    (armature, clip)
}

fn bone_placement(armature: &Armature, pose: &Pose) -> Affine3A {
    let mut places = Vec::new();
    armature.local_to_model(pose, &mut places).unwrap();
    places[2]
}

/// Pose with `bone 2` rotated and at a position of the model.
fn placed(armature: &Armature, pose: &Pose, turn: Quat, to: Vec3) -> Pose {
    let bone = armature.bone("bone 2").unwrap();
    let mut places = Vec::new();
    armature.local_to_model(pose, &mut places).unwrap();
    let above = places[armature.parent(bone).unwrap().index()];
    let (_, parent_rotation, _) = above.to_scale_rotation_translation();
    let mut local = pose.local(bone).unwrap();
    local.translation = above.inverse().transform_point3a(to.into());
    local.rotation = (parent_rotation.inverse() * turn).normalize();
    let mut posed = pose.clone();
    posed.set_local(bone, local).unwrap();
    posed
}

fn near(one: Affine3A, other: Affine3A) -> bool {
    one.abs_diff_eq(other, 2e-4)
}

#[test]
fn extracted_and_applied_motion_gives_the_clip() {
    let random = &mut Random::new(51);
    for up in [Vec3::Y, Vec3::Z, Vec3::new(0.6, 0.0, 0.8)] {
        let (armature, clip) = walk(up, 1.5, random);
        let bone = armature.bone("bone 2").unwrap();
        let (in_place, motion) = clip
            .without_root_motion(&armature, bone, 3.0 * up, RATE)
            .unwrap();
        let again = in_place
            .with_root_motion(&armature, bone, &motion, RATE)
            .unwrap();
        let start = bone_placement(&armature, &at(&clip, &armature, 0.0));
        for frame in 0..=60 {
            let time = frame as f32 / 30.0;
            let was = bone_placement(&armature, &at(&clip, &armature, time));
            assert!(near(
                bone_placement(&armature, &at(&again, &armature, time)),
                was
            ));
            let stays = bone_placement(&armature, &at(&in_place, &armature, time));
            assert!(near(motion.at(time) * stays, was));
            // It stays above its start position, at its height.
            let moved = stays.translation - start.translation;
            let height = (was.translation - start.translation).dot(up.into());
            assert!((moved - Vec3A::from(up) * height).length() < 1e-4);
        }
        // One and a half rounds, as constructed.
        let turned = motion.heading().at(2.0);
        assert!(
            (turned - 3.0 * std::f32::consts::PI).abs() < 1e-3,
            "{turned}"
        );
        assert_eq!(motion.at(0.0), Affine3A::IDENTITY);
    }
}

#[test]
fn motion_continues_over_loop_ends() {
    let random = &mut Random::new(52);
    // Not by half turns, which are their own inverses.
    let (armature, clip) = walk(Vec3::Y, 1.2, random);
    let bone = armature.bone("bone 2").unwrap();
    let (_, motion) = clip
        .without_root_motion(&armature, bone, Vec3::Y, RATE)
        .unwrap();
    let whole = motion.at(2.0);
    assert!(near(motion.after(2.0, Playback::Loop), whole));
    assert!(near(
        motion.after(5.5, Playback::Loop),
        whole * whole * motion.at(1.5)
    ));
    assert!(near(
        motion.after(-0.5, Playback::Loop),
        whole.inverse() * motion.at(1.5)
    ));
    assert_eq!(motion.after(7.0, Playback::Hold), whole);
    assert_eq!(motion.after(3.0, Playback::PingPong), motion.at(1.0));
    // Twelve thousand loops later: the same circle.
    let after_hours = motion.after(24_000.0, Playback::Loop);
    assert!(after_hours.is_finite() && after_hours.translation.length() < 10.0);
}

#[test]
fn invalid_root_motion_is_named() {
    let random = &mut Random::new(53);
    let (armature, clip) = walk(Vec3::Y, 1.5, random);
    let bone = armature.bone("bone 2").unwrap();
    for up in [Vec3::ZERO, Vec3::NAN] {
        let wrong = clip.without_root_motion(&armature, bone, up, RATE);
        assert!(matches!(wrong, Err(ClipError::BadUp { .. })));
    }
    let other = support::armatures::armature(40, random);
    let strange =
        clip.without_root_motion(&armature, other.bone("bone 39").unwrap(), Vec3::Y, RATE);
    assert!(matches!(
        strange,
        Err(ClipError::UnknownBone { bone: 39, .. })
    ));
    let single = Clip::through_poses("one", &armature, &[0.5], &[armature.rest().clone()]).unwrap();
    let (_, motion) = single
        .without_root_motion(&armature, bone, Vec3::Y, RATE)
        .unwrap();
    assert_eq!(motion.after(9.0, Playback::Loop), Affine3A::IDENTITY);
}
