//! Promise: during a clip, hands reach for targets within their time spans without a jump. Nothing outside of the spans
//! changes, and the root moves no further than limbs are too short.

use glam::{Affine3A, DVec3, Quat, Vec3, Vec3A};
use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::{Armature, Clip};
use kinopt::model::Limits;
use kinopt::motion::clip_ik::{ClipIk, Reach};
use kinopt::skeleton::{Bone, BoneId, Skeleton};
use kinopt::spatial::{Placement, Vector3};

use crate::clip_ik::{HIPS, SHIN, THIGH, at, figure, pose, walk};

/// The figure, its hand, and a clip of two seconds in the rest pose.
fn rest_figure() -> (Armature, BoneId, Clip) {
    let armature = figure();
    let hand = armature.bone("hand").unwrap();
    let poses = vec![armature.rest().clone(); 2];
    let stand = Clip::through_poses("stand", &armature, &[0.0, 2.0], &poses).unwrap();
    (armature, hand, stand)
}

/// Outside of the span the figure travels as usual.
#[test]
fn reaching_figure_travels_before_and_after() {
    let (armature, hand, stand) = rest_figure();
    let travel = Vec3::new(0.3, 0.0, 0.5);
    // Nearer to the shoulder, so that the root need not follow.
    let [hand_start, shoulder] = ["hand", "arm"].map(|bone| at(&armature, &stand, bone, 0.0));
    let target = hand_start.lerp(shoulder, 0.3) + Vec3A::from(travel);
    let reach = Reach::to(hand, target.as_dvec3())
        .unwrap()
        .with_span(0.9..=1.1);
    let edited = ClipIk::new(&armature)
        .with_root_velocity(travel)
        .with_reach(reach)
        .solve(&stand)
        .unwrap();
    for time in [0.0, 0.2, 0.5, 0.8, 1.2, 1.5, 2.0] {
        for bone in ["hips", "foot.l", "hand"] {
            let on = at(&armature, &stand, bone, time) + Vec3A::from(travel) * time as f32;
            let found = at(&armature, &edited.clip, bone, time);
            assert!(found.distance(on) < 1e-4, "{bone} at {time}: {found} {on}");
        }
    }
    assert!(at(&armature, &edited.clip, "hand", 1.0).distance(target) < 1e-3);
}

#[test]
fn hand_reaches_in_its_span_and_nothing_else_changes() {
    let armature = figure();
    let walk = walk(&armature, true);
    let hand = armature.bone("hand").unwrap();
    let target = DVec3::new(0.5, 1.3, 1.5);
    let reach = Reach::to(hand, target)
        .unwrap()
        .with_span(0.8..=1.6)
        .with_fade(0.3);
    let edited = ClipIk::new(&armature)
        .with_reach(reach)
        .solve(&walk)
        .unwrap();
    for time in [1.1, 1.2, 1.3] {
        let deviation = at(&armature, &edited.clip, "hand", time)
            .as_dvec3()
            .distance(target);
        assert!(deviation < 1e-3, "{time} s: {deviation}");
    }
    for step in 0..=200 {
        let time = f64::from(step) / 100.0;
        let [old, new] = [&walk, &edited.clip].map(|clip| pose(&armature, clip, time));
        for bone in armature.bone_ids() {
            let moved =
                ["chest", "arm", "forearm", "hand"].map(|name| armature.bone(name).unwrap());
            let [old, new] = [old.local(bone).unwrap(), new.local(bone).unwrap()];
            if !moved.contains(&bone) {
                assert_eq!(old, new, "{time} s");
            } else if !(0.8..=1.6).contains(&time) {
                assert!(old.rotation.abs_diff_eq(new.rotation, 2e-7), "{time} s");
            }
        }
    }
    // No jump: the distance moved in a hundredth of a second is close to that of its neighbours.
    let position_at = |step: i32| at(&armature, &edited.clip, "hand", f64::from(step) / 100.0);
    let ways: Vec<f32> = (1..=200)
        .map(|step| position_at(step).distance(position_at(step - 1)))
        .collect();
    for pair in ways.windows(2) {
        assert!((pair[1] - pair[0]).abs() < 6e-3, "{pair:?}");
    }
}

#[test]
fn root_moves_only_as_far_as_limbs_are_too_short() {
    let armature = figure();
    let stand = Clip::through_poses(
        "stand",
        &armature,
        &[0.0, 1.0],
        &vec![armature.rest().clone(); 2],
    )
    .unwrap();
    let foot = armature.bone("foot.l").unwrap();
    // The leg hangs straight down, so 5 cm lower is 5 cm too far. The 2 mm by which the leg is not fully stretched are
    // within the tolerance.
    let hip = DVec3::new(0.1, f64::from(HIPS), 0.0);
    let straight = f64::from(THIGH + SHIN);
    let target = hip - DVec3::new(0.0, straight + 0.05, 0.0);
    let edited = ClipIk::new(&armature)
        .with_reach(Reach::to(foot, target).unwrap())
        .solve(&stand)
        .unwrap();
    let hips = at(&armature, &edited.clip, "hips", 0.5).as_dvec3();
    let expected = DVec3::new(0.0, f64::from(HIPS) - 0.05, 0.0);
    assert!(hips.distance(expected) < 1e-3, "{hips}");
    assert!((edited.report.root_moved - 0.05).abs() < 1e-3);
    assert!(edited.report.led[0].miss < 1e-4, "{:?}", edited.report.led);
    // Within reach the root does not move.
    let near = hip - DVec3::new(0.0, straight - 0.1, 0.1);
    let edited = ClipIk::new(&armature)
        .with_reach(Reach::to(foot, near).unwrap())
        .solve(&stand)
        .unwrap();
    assert_eq!(edited.report.root_moved, 0.0);
    assert!(edited.report.led[0].miss < 1e-5);
}

/// The hand moves to its target and back over the fade time. Its default is a fifth of a second, or half of a shorter
/// span. At the start and end of the clip itself there is no fade.
#[test]
fn hand_fades_at_span_ends_within_the_clip() {
    let (armature, hand, stand) = rest_figure();
    let target = DVec3::new(0.55, 1.3, 0.3);
    let start = at(&armature, &stand, "hand", 0.0).as_dvec3();
    let smooth = |share: f64| share * share * (3.0 - 2.0 * share);
    for (span, fade, in_use) in [
        ([0.0, 1.0], None, 0.2),
        ([1.0, 2.0], None, 0.2),
        ([0.5, 1.5], None, 0.2),
        ([0.5, 0.8], None, 0.15),
        ([0.5, 1.5], Some(0.4), 0.4),
        ([0.0, 2.0], None, 0.2),
    ] {
        let mut reach = Reach::to(hand, target)
            .unwrap()
            .with_span(span[0]..=span[1]);
        if let Some(fade) = fade {
            reach = reach.with_fade(fade);
        }
        let edited = ClipIk::new(&armature)
            .with_reach(reach)
            .solve(&stand)
            .unwrap();
        let side = |since: f64, at_end: bool| match (since < 0.0, at_end) {
            (true, _) => 0.0,
            (_, true) => 1.0,
            _ => smooth((since / in_use).min(1.0)),
        };
        for frame in 0..=120 {
            let time = f64::from(frame) / 60.0;
            let share = side(time - span[0], span[0] == 0.0) * side(span[1] - time, span[1] == 2.0);
            let expected = start.lerp(target, share);
            let found = at(&armature, &edited.clip, "hand", time).as_dvec3();
            assert!(
                found.distance(expected) < 2e-3,
                "{span:?}, {time} s: {found} {expected}"
            );
        }
    }
}

/// The target moves out of reach of the arm and back. The largest error is where it is farthest.
#[test]
fn time_of_the_largest_error_is_reported() {
    let (armature, hand, stand) = rest_figure();
    let start = at(&armature, &stand, "hand", 0.0).as_dvec3();
    let far_position = start + DVec3::new(3.0, 0.0, 0.0);
    let curve = KeyedCurve::linear(vec![0.0, 1.5, 2.0], vec![start, far_position, start]).unwrap();
    let reach = Reach::along(hand, curve.clone());
    let edited = ClipIk::new(&armature)
        .with_reach(reach)
        .solve(&stand)
        .unwrap();
    let result = &edited.report.led[0];
    let deviation_of = |frame: u32| {
        let time = f64::from(frame) / 60.0;
        let found = at(&armature, &edited.clip, "hand", time).as_dvec3();
        found.distance(curve.at(time))
    };
    let worst = (0..=120)
        .max_by(|a, b| deviation_of(*a).total_cmp(&deviation_of(*b)))
        .unwrap();
    assert!(
        result.miss > 1e-4 && (result.miss - deviation_of(worst)).abs() < 1e-4,
        "{result:?}"
    );
    assert!(
        (result.at - f64::from(worst) / 60.0).abs() < 1e-6,
        "{result:?} {worst}"
    );
    assert!(result.at > 1.0);
}

/// The root that follows a hand beyond its arm's reach is back in the clip's pose when the hand is released, without a
/// jump. Keys at the ends of a span replace neighbouring keys.
#[test]
fn root_returns_within_the_span() {
    let (armature, hand, stand) = rest_figure();
    let span = [0.501, 1.4005];
    let target = at(&armature, &stand, "hand", 0.0).as_dvec3() + DVec3::new(0.6, 0.0, 0.0);
    let reach = Reach::to(hand, target)
        .unwrap()
        .with_span(span[0]..=span[1]);
    let edited = ClipIk::new(&armature)
        .with_reach(reach)
        .solve(&stand)
        .unwrap();
    assert!(
        edited.report.root_moved > 0.3,
        "{}",
        edited.report.root_moved
    );
    let hips = |time: f64| at(&armature, &edited.clip, "hips", time).as_dvec3();
    let hips_at_rest = DVec3::new(0.0, f64::from(HIPS), 0.0);
    // A sixtieth of a second outside the span the pose is the clip's.
    for time in [0.0, 0.4, span[0] - 0.017, span[1] + 0.017, 1.5, 2.0] {
        assert!(
            hips(time).distance(hips_at_rest) < 1e-5,
            "{time} s: {}",
            hips(time)
        );
    }
    let ways = (1..=400).map(|k| hips(f64::from(k) / 200.0) - hips(f64::from(k - 1) / 200.0));
    let ways: Vec<DVec3> = ways.collect();
    let jerk = ways.windows(2).map(|pair| pair[1].distance(pair[0]));
    let jerk = jerk.fold(0.0, f64::max);
    assert!(jerk < 0.02, "{jerk} m");
    for (_, channel) in edited.clip.channels(&armature).unwrap() {
        let inner = channel.times().windows(2).map(|pair| pair[1] - pair[0]);
        assert!(inner.fold(f32::INFINITY, f32::min) > 0.45 / 60.0);
    }
}

/// The tip of a rig's bone moves from its position in the clip.
#[test]
fn tip_of_a_rig_fades_from_its_clip_position() {
    let mut builder = Skeleton::builder("arm");
    let (mut parent, mut along) = (None, 0.0);
    for (name, length) in [("root", 0.1), ("upper", 0.5), ("lower", 0.4), ("hand", 0.2)] {
        parent = Some(builder.add(Bone {
            name: name.into(),
            parent,
            length,
            model_from_rest: Placement::translation(Vector3::new(along, 0.0, 0.0)),
            limits: [Limits::new(-2.0, 2.0); 3],
        }));
        along += length;
    }
    let skeleton = builder.build().unwrap();
    let armature = Armature::of_skeleton(&skeleton);
    let mut bent = armature.rest().clone();
    for (name, by) in [("upper", 0.6), ("lower", -1.0), ("hand", 0.3)] {
        let bone = armature.bone(name).unwrap();
        let local = bent.local(bone).unwrap();
        bent.set_rotation(bone, local.rotation * Quat::from_rotation_z(by))
            .unwrap();
    }
    let stand =
        Clip::through_poses("stand", &armature, &[0.0, 1.0], &[bent.clone(), bent]).unwrap();
    let hand = armature.bone("hand").unwrap();
    let tip = |clip: &Clip, time: f64| {
        let mut model = vec![Affine3A::IDENTITY; 4];
        armature
            .local_to_model(&pose(&armature, clip, time), &mut model)
            .unwrap();
        model[3].transform_point3a(Vec3A::X * 0.2).as_dvec3()
    };
    let start = tip(&stand, 0.5);
    let target = start + DVec3::new(-0.1, 0.15, 0.05);
    let reach = Reach::to(hand, target)
        .unwrap()
        .with_span(0.2..=0.8)
        .with_fade(0.2);
    let edited = ClipIk::new(&armature)
        .with_root(armature.bone("root").unwrap())
        .with_joints_of(&skeleton)
        .with_reach(reach)
        .solve(&stand)
        .unwrap();
    for (time, share) in [
        (0.1, 0.0),
        (0.2, 0.0),
        (0.3, 0.5),
        (0.5, 1.0),
        (0.7, 0.5),
        (0.8, 0.0),
    ] {
        let deviation = tip(&edited.clip, time).distance(start.lerp(target, share));
        assert!(deviation < 1e-4, "{time}: {deviation}");
    }
}
