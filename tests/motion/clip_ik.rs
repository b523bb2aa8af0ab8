//! Promise: feet in contact do not slide during a clip, however it travels and whatever other targets it has.

use std::f32::consts::TAU;

use glam::{DVec3, Quat, Vec3, Vec3A};
use kinopt::animation::{Armature, Clip, Cursor, Playback, Pose};
use kinopt::motion::clip_ik::{ClipIk, ClipIkError, Reach, ground_speed};
use kinopt::skeleton::BoneId;
use support::armatures::bone;

/// Metres.
pub(crate) const THIGH: f32 = 0.45;
pub(crate) const SHIN: f32 = 0.45;
/// Height of the hips.
pub(crate) const HIPS: f32 = 0.88;
/// Metres per second.
const SPEED: f32 = 1.2;

/// Hips with two legs, and a chest with an arm.
pub(crate) fn figure() -> Armature {
    let bones = vec![
        bone("hips", None, [0.0, HIPS, 0.0]),
        bone("thigh.l", Some(0), [0.1, 0.0, 0.0]),
        bone("shin.l", Some(1), [0.0, -THIGH, 0.0]),
        bone("foot.l", Some(2), [0.0, -SHIN, 0.0]),
        bone("thigh.r", Some(0), [-0.1, 0.0, 0.0]),
        bone("shin.r", Some(4), [0.0, -THIGH, 0.0]),
        bone("foot.r", Some(5), [0.0, -SHIN, 0.0]),
        bone("chest", Some(0), [0.0, 0.4, 0.0]),
        bone("arm", Some(7), [0.2, 0.1, 0.0]),
        bone("forearm", Some(8), [0.3, 0.0, 0.0]),
        bone("hand", Some(9), [0.25, 0.0, 0.0]),
        bone("head", Some(7), [0.0, 0.2, 0.0]),
    ];
    Armature::new(bones, Vec::new()).unwrap()
}

/// Bends a leg so that its foot is at a position relative to its hip, by the law of cosines with the knee forward.
pub(crate) fn bend(pose: &mut Pose, [thigh, shin, foot]: [BoneId; 3], at: Vec3) {
    let reach = at.length().min(THIGH + SHIN - 1e-4);
    let cosine =
        |a: f32, b: f32, c: f32| ((a * a + b * b - c * c) / (2.0 * a * b)).clamp(-1.0, 1.0);
    let knee = std::f32::consts::PI - cosine(THIGH, SHIN, reach).acos();
    let hip = cosine(THIGH, reach, SHIN).acos();
    let swing = Quat::from_rotation_arc(Vec3::NEG_Y, at.normalize());
    let thigh_turn = swing * Quat::from_rotation_x(-hip);
    pose.set_rotation(thigh, thigh_turn).unwrap();
    pose.set_rotation(shin, Quat::from_rotation_x(knee))
        .unwrap();
    let level = (thigh_turn * Quat::from_rotation_x(knee)).inverse();
    pose.set_rotation(foot, level).unwrap();
}

/// A walk of two seconds along z, or on the spot. Its feet slide by centimetres during contact.
pub(crate) fn walk(armature: &Armature, travels: bool) -> Clip {
    let id = |name: &str| armature.bone(name).unwrap();
    let times: Vec<f32> = (0..=60).map(|k| k as f32 / 30.0).collect();
    let poses = times.iter().map(|&time| {
        let mut pose = armature.rest().clone();
        let forward = if travels { SPEED * time } else { 0.0 };
        let bob = 0.01 * (2.0 * TAU * time).sin();
        let hips = Vec3::new(0.0, HIPS + bob - 0.08, forward);
        pose.set_translation(id("hips"), hips.into()).unwrap();
        for (side, x, phase) in [("l", 0.1_f32, 0.0), ("r", -0.1, 0.5)] {
            let cycle = (time + phase).fract();
            // Contact for six tenths of a second, with a sliding motion of 1.5 cm.
            let (z, y) = if cycle < 0.6 {
                (
                    0.36 - SPEED * cycle + 0.015 * (TAU * cycle / 0.6).sin(),
                    0.0,
                )
            } else {
                let share = (cycle - 0.6) / 0.4;
                let eased = share * share * (3.0 - 2.0 * share);
                (-0.36 + 0.72 * eased, 0.12 * (share * TAU / 2.0).sin())
            };
            let foot = Vec3::new(0.0, y - (HIPS + bob - 0.08), z);
            let limb = ["thigh", "shin", "foot"].map(|part| id(&format!("{part}.{side}")));
            let _ = x;
            bend(&mut pose, limb, foot);
        }
        pose
    });
    let poses: Vec<Pose> = poses.collect();
    Clip::through_poses("walk", armature, &times, &poses).unwrap()
}

/// Position of a bone in the model at a time.
pub(crate) fn at(armature: &Armature, clip: &Clip, bone: &str, time: f64) -> Vec3A {
    let pose = pose(armature, clip, time);
    let placement = armature.model_from_bone(&pose, armature.bone(bone).unwrap());
    placement.unwrap().translation
}

pub(crate) fn pose(armature: &Armature, clip: &Clip, time: f64) -> Pose {
    let mut pose = armature.rest().clone();
    clip.sample(time, Playback::Hold, &mut Cursor::new(), &mut pose)
        .unwrap();
    pose
}

pub(crate) fn planted<'a>(armature: &'a Armature) -> ClipIk<'a> {
    let id = |name: &str| armature.bone(name).unwrap();
    ClipIk::new(armature)
        .with_planted(id("foot.l"))
        .with_planted(id("foot.r"))
}

#[test]
fn planted_feet_slide_by_less_than_2_mm() {
    let armature = figure();
    let walk = walk(&armature, true);
    let edited = planted(&armature)
        .with_keys_per_second(60.0)
        .solve(&walk)
        .unwrap();
    // Two feet, two seconds, one step per second each.
    assert!(
        edited.report.stances.len() >= 4,
        "{:?}",
        edited.report.stances
    );
    let (mut before, mut after) = (0.0_f32, 0.0_f32);
    for stance in &edited.report.stances {
        let name = &armature.names()[stance.bone.index()];
        let [from, to] = stance.span;
        assert!(to - from > 0.05);
        assert!(stance.slide < 1e-4);
        // Between keys as well.
        let moments = (0..=500).map(|k| from + (to - from) * f64::from(k) / 500.0);
        let position_at = |clip: &Clip, time| at(&armature, clip, name, time);
        let slide = |clip: &Clip| {
            let first = position_at(clip, from);
            let all = moments
                .clone()
                .map(|time| position_at(clip, time).distance(first));
            all.fold(0.0, f32::max)
        };
        (before, after) = (before.max(slide(&walk)), after.max(slide(&edited.clip)));
    }
    assert!(before > 0.01, "{before}");
    assert!(after < 0.002, "{after}");
    // The root did not have to move.
    assert_eq!(edited.report.root_moved, 0.0);
    for time in [0.0, 0.3, 1.1, 2.0] {
        let [old, new] = [&walk, &edited.clip].map(|clip| at(&armature, clip, "hips", time));
        assert_eq!(old, new);
    }
}

#[test]
fn walk_on_the_spot_travels_with_its_feet() {
    let armature = figure();
    let on_the_spot = walk(&armature, false);
    let feet = ["foot.l", "foot.r"].map(|name| armature.bone(name).unwrap());
    let speed = ground_speed(&armature, &on_the_spot, &feet, Vec3::Y, 60.0).unwrap();
    assert!(speed.distance(Vec3::new(0.0, 0.0, SPEED)) < 0.1, "{speed}");
    let travel = Vec3::new(0.0, 0.0, SPEED);
    let edited = planted(&armature)
        .with_root_velocity(travel)
        .solve(&on_the_spot)
        .unwrap();
    let same = planted(&armature).solve(&walk(&armature, true)).unwrap();
    assert_eq!(edited.report.stances.len(), same.report.stances.len());
    for time in [0.0, 0.37, 1.0, 1.9] {
        for bone in ["hips", "foot.l", "foot.r", "hand"] {
            let [one, other] = [&edited, &same].map(|made| at(&armature, &made.clip, bone, time));
            assert!(
                one.distance(other) < 2e-3,
                "{bone} at {time}: {one} {other}"
            );
        }
    }
}

/// Linear interpolation of joints between keys moves feet off their positions. More keys are set where a foot would
/// deviate, and only there.
#[test]
fn planted_feet_stay_put_between_sparse_keys() {
    let armature = figure();
    let leg = f64::from(THIGH + SHIN);
    for rate in [10.0, 15.0, 24.0, 30.0] {
        let clip = walk(&armature, true);
        let edited = planted(&armature)
            .with_keys_per_second(rate)
            .solve(&clip)
            .unwrap();
        assert!(edited.report.stances.len() >= 4);
        for stance in &edited.report.stances {
            let name = &armature.names()[stance.bone.index()];
            let [from, to] = stance.span;
            let deviation_of = |time| {
                let at = at(&armature, &edited.clip, name, time).as_dvec3();
                at.distance(stance.place)
            };
            let moments = (0..=2000).map(|k| from + (to - from) * f64::from(k) / 2000.0);
            let measured = moments.map(deviation_of).fold(0.0, f64::max);
            let reported = stance.slide.max(stance.stray);
            assert!(measured < 1.2e-3 * leg, "{rate} a second: {measured}");
            // The solver checks three times between keys.
            assert!(
                (0.7 * measured - 1e-6..measured + 1e-6).contains(&reported),
                "{rate} a second: {reported} told, {measured} measured"
            );
        }
        let shin = armature.bone("shin.l").unwrap();
        let channels = edited.clip.channels(&armature).unwrap();
        let channel = channels.iter().find(|(bone, _)| *bone == shin).unwrap();
        let times = channel.1.times();
        let in_stance = |time: f32| {
            let spans = edited.report.stances.iter().map(|stance| stance.span);
            spans
                .into_iter()
                .any(|[from, to]| (from - 1e-6..to + 1e-6).contains(&f64::from(time)))
        };
        // In the swing phase there are as many keys as requested.
        for pair in times.windows(2) {
            let close = f64::from(pair[1] - pair[0]) < 0.9 / rate;
            assert!(
                !close || (in_stance(pair[0]) && in_stance(pair[1])),
                "{pair:?}"
            );
        }
        let even = (2.0 * rate) as usize + 1;
        assert!(
            (even..4 * even).contains(&times.len()),
            "{} keys",
            times.len()
        );
    }
}

/// A foot too far from its position at the keys gets no additional keys.
#[test]
fn unreachable_contact_gets_no_additional_keys() {
    let armature = figure();
    let id = |name: &str| armature.bone(name).unwrap();
    let clip = walk(&armature, true);
    // Only the shin may rotate; the thigh moves as in the clip, so the foot misses its position.
    let edited = ClipIk::new(&armature)
        .with_planted(id("foot.l"))
        .with_root(id("thigh.l"))
        .with_keys_per_second(30.0)
        .solve(&clip)
        .unwrap();
    assert!(edited.report.led[0].miss > 5e-3, "{:?}", edited.report.led);
    let channels = edited.clip.channels(&armature).unwrap();
    let channel = channels.iter().find(|(bone, _)| *bone == id("shin.l"));
    let keys = channel.unwrap().1.times().len();
    assert!((61..90).contains(&keys), "{keys} keys");
}

#[test]
fn planted_feet_follow_stairs() {
    let armature = figure();
    let stairs = |at: DVec3| 0.1 * ((at.z + 0.2) / 0.4).floor().max(0.0);
    let edited = planted(&armature)
        .with_ground(move |at| stairs(at.into()))
        .solve(&walk(&armature, true))
        .unwrap();
    let level = planted(&armature).solve(&walk(&armature, true)).unwrap();
    for (stance, before) in edited.report.stances.iter().zip(&level.report.stances) {
        let expected = before.place + DVec3::Y * stairs(before.place);
        assert!(stance.place.distance(expected) < 1e-9);
        assert!(stance.slide < 5e-4, "{stance:?}");
    }
    // No foot penetrates a step.
    for step in 0..=200 {
        let time = f64::from(step) / 100.0;
        for foot in ["foot.l", "foot.r"] {
            let at = at(&armature, &edited.clip, foot, time).as_dvec3();
            assert!(at.y > stairs(at) - 0.02, "{foot} at {time} s: {at}");
        }
    }
    let climbed =
        at(&armature, &edited.clip, "hips", 2.0).y - at(&armature, &level.clip, "hips", 2.0).y;
    assert!((0.3..0.7).contains(&climbed), "{climbed}");
}

#[test]
fn invalid_clip_ik_is_named() {
    let armature = figure();
    let walk = walk(&armature, true);
    let id = |name: &str| armature.bone(name).unwrap();
    let says = |ik: ClipIk<'_>| ik.solve(&walk).unwrap_err().to_string();
    let reach = |bone: &str| Reach::to(id(bone), [0.5, 1.0, 0.0]).unwrap();
    let ik = || ClipIk::new(&armature);
    assert_eq!(ik().solve(&walk).unwrap_err(), ClipIkError::Nothing);
    assert!(
        says(ik().with_reach(reach("hand")).with_root(id("shin.l")))
            .contains("`hand` is not below the root `shin.l`")
    );
    assert!(
        says(ik().with_reach(reach("hand")).with_planted(id("hand")))
            .contains("`hand`: two targets")
    );
    assert!(says(ik().with_reach(reach("hand")).with_reach(reach("hand"))).contains("two targets"));
    assert!(
        says(ik().with_reach(reach("hand").with_span(1.0..=0.5))).contains("from 1 s to 0.5 s")
    );
    assert!(says(ik().with_reach(reach("hand").with_span(5.0..=6.0))).contains("0 s to 2 s"));
    assert!(
        says(ik().with_reach(reach("hand").with_span(0.0..=1.0).with_fade(0.6)))
            .contains("fades of 0.6 s")
    );
    assert!(says(ik().with_reach(reach("hand").with_fade(f64::NAN))).contains("NaN"));
    assert!(says(ik().with_planted(id("foot.l")).with_keys_per_second(0.0)).contains("keys/s"));
    assert!(says(ik().with_planted(id("foot.l")).with_up(Vec3::ZERO)).contains("up axis"));
    assert!(says(ik().with_reach(reach("hips")).with_root_velocity(Vec3::X)).contains("root"));
    assert!(Reach::to(id("hand"), [f64::NAN, 0.0, 0.0]).is_err());
    let other = Armature::new(Vec::new(), Vec::new()).unwrap();
    assert!(
        ClipIk::new(&other)
            .with_planted(id("hand"))
            .solve(&walk)
            .is_err()
    );
}

/// A foot rises early over a higher step, and descends late.
#[test]
fn foot_rises_early_and_descends_late() {
    let armature = figure();
    let walk = walk(&armature, true);
    let level = planted(&armature).solve(&walk).unwrap();
    for rise in [0.01, -0.01] {
        let stairs = move |at: DVec3| rise * ((at.z + 0.2) / 0.4).floor();
        let edited = planted(&armature)
            .with_ground(move |at| stairs(at.into()))
            .solve(&walk)
            .unwrap();
        let mut swings = 0;
        for pair in edited
            .report
            .stances
            .windows(2)
            .zip(level.report.stances.windows(2))
        {
            let ([from, to], [under_from, under_to]) = pair else {
                continue;
            };
            let [first, last] = [under_from, under_to].map(|stance| stairs(stance.place));
            if from.bone != to.bone || first == last {
                continue;
            }
            let name = &armature.names()[from.bone.index()];
            let middle = 0.5 * (from.span[1] + to.span[0]);
            let [after, before] = [&edited.clip, &level.clip]
                .map(|clip| f64::from(at(&armature, clip, name, middle).y));
            let gone = (after - before - first) / (last - first);
            match rise > 0.0 {
                true => assert!((0.7..1.1).contains(&gone), "{gone} of the way up"),
                false => assert!((-0.1..0.3).contains(&gone), "{gone} of the way down"),
            }
            swings += 1;
        }
        assert!(swings > 0);
    }
}

/// The root rises evenly over steps too low for any leg to be too short.
#[test]
fn root_rises_evenly_over_low_steps() {
    let armature = figure();
    let walk = walk(&armature, true);
    let stairs = |z: f32| 0.01 * ((z + 0.2) / 0.4).floor();
    let edited = planted(&armature)
        .with_ground(move |at| stairs(at.z as f32).into())
        .solve(&walk)
        .unwrap()
        .clip;
    let risen = |clip: &Clip, k: u32| at(&armature, clip, "hips", f64::from(k) / 30.0).y;
    let rises: Vec<f32> = (0..=60)
        .map(|k| risen(&edited, k) - risen(&walk, k))
        .collect();
    let jerks = rises
        .windows(3)
        .map(|rise| (rise[2] - 2.0 * rise[1] + rise[0]).abs());
    let largest = jerks.fold(0.0_f32, f32::max);
    assert!(rises[60] - rises[0] > 0.03, "{rises:?}");
    assert!(largest < 5e-4, "{largest} m");
}

/// Feet keep their contact positions while a hand is moved elsewhere in the clip, and while it is not.
#[test]
fn feet_stay_planted_around_a_hand_target() {
    let armature = figure();
    let walk = walk(&armature, true);
    let alone = planted(&armature).solve(&walk).unwrap();
    let hand = armature.bone("hand").unwrap();
    let reach = Reach::to(hand, [0.4, 1.2, 1.4]).unwrap();
    let reach = reach.with_span(0.9..=1.3).with_fade(0.1);
    let edited = planted(&armature).with_reach(reach).solve(&walk).unwrap();
    assert_eq!(edited.report.stances.len(), alone.report.stances.len());
    for (stance, before) in edited.report.stances.iter().zip(&alone.report.stances) {
        assert!(stance.slide < before.slide + 1e-4, "{stance:?} {before:?}");
        let name = &armature.names()[stance.bone.index()];
        let [from, to] = stance.span;
        for k in 0..=10 {
            let time = from + (to - from) * f64::from(k) / 10.0;
            let off = at(&armature, &edited.clip, name, time).as_dvec3();
            assert!(off.distance(stance.place) < 2e-3, "{name} at {time}");
        }
    }
}

/// Files often have a mesh node next to the hips. It carries no bone, so the node above both is no branch.
#[test]
fn mesh_node_beside_the_hips_is_no_branch() {
    let solved = |with_mesh: bool| {
        let mut bones = vec![bone("Armature", None, Vec3A::ZERO)];
        let joints = figure();
        for (index, name) in joints.names().iter().enumerate() {
            let id = joints.bone_at(index).unwrap();
            let parent = joints.parent(id).map_or(0, |parent| parent.index() + 1);
            let rest = joints.rest().local(id).unwrap();
            bones.push(bone(name, Some(parent), rest.translation));
        }
        if with_mesh {
            bones.push(bone("mesh", Some(0), Vec3A::ZERO));
        }
        let armature = Armature::new(bones, Vec::new()).unwrap();
        // The feet stay on the ground only if the hips sink.
        let rise = Clip::through_poses(
            "rise",
            &armature,
            &[0.0, 0.5, 1.0],
            &[0.8, 0.92, 0.8].map(|height| {
                let mut pose = armature.rest().clone();
                let id = |name: &str| armature.bone(name).unwrap();
                pose.set_translation(id("hips"), Vec3A::new(0.0, height, 0.0))
                    .unwrap();
                for side in ["l", "r"] {
                    let limb = ["thigh", "shin", "foot"].map(|part| id(&format!("{part}.{side}")));
                    bend(&mut pose, limb, Vec3::new(0.0, -0.8, 0.0));
                }
                pose
            }),
        );
        let edited = planted(&armature).solve(&rise.unwrap()).unwrap();
        let hips = at(&armature, &edited.clip, "hips", 0.5);
        (hips, at(&armature, &edited.clip, "Armature", 0.5), edited)
    };
    let [(hips, _, without_mesh), (beside_mesh, node, edited)] = [false, true].map(solved);
    assert_eq!((hips, node), (beside_mesh, Vec3A::ZERO));
    assert_eq!(edited.report.stances, without_mesh.report.stances);
    assert_eq!(edited.report.root_moved, without_mesh.report.root_moved);
}
