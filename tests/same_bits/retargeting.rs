//! Promise: so it is for movements on robots: by each option, on feet of each shape, by maps that say what counts, frame by frame, as a
//! whole and live, clear of what is in the way, with what is reported and what is refused.
#![allow(clippy::unwrap_used)]

use kinopt::collision::{Checker, CollisionModel, CollisionObject, Shape};
use kinopt::motion::retarget::{
    BodyMap, BodyPart, Capture, ContactDetection, Drive, FootShapes, RetargetOptions, Retargeted,
    Retargeting, UpAxis,
};
use kinopt::motion::trajectory::Windows;
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3, rotation_exp};

use crate::digest::{Digest, Value, check};
use crate::robot_texts::{add_error, add_text};
use crate::walking_person::{BOXES, biped, capture, places};

/// Everything that a movement says, and what is asked of it.
pub(crate) fn add(digest: &mut Digest, retargeting: &Retargeting<'_>, found: &Retargeted) {
    digest.doubles(found.q.iter().copied());
    let mut rest = found.clone();
    rest.q.clear();
    add_text(digest, &format!("{rest:?} {}", found.frames()));
    add_text(digest, &format!("{:?}", retargeting.active_limits(found)));
}

pub(crate) fn add_fitted(digest: &mut Digest, retargeting: &Retargeting<'_>) {
    for frame in 0..=retargeting.frames() {
        let targets = retargeting.targets(frame).into_iter().flatten();
        digest.doubles(targets.flat_map(|at| at.to_array()));
    }
    digest.doubles([retargeting.stride(), retargeting.frame_rate()]);
    let fitted = (retargeting.driven(), retargeting.model_stands_along());
    add_text(digest, &format!("{fitted:?}"));
}

fn options() -> RetargetOptions {
    let contacts = ContactDetection::default()
        .with_speed(0.18)
        .with_shortest(0.2);
    RetargetOptions::default().with_contacts(contacts)
}

fn guessed(robot: &Robot, captured: &Capture) -> BodyMap {
    BodyMap::guess(captured, robot.model()).unwrap().map
}

/// A movement of few frames by each option, frame by frame.
fn by_options() -> [Value; 2] {
    let (mut one_by_one, mut whole) = (Digest::new(), Digest::new());
    let robot = biped(BOXES[0], BOXES[1]);
    let (upright, lying) = (capture(26, false), capture(26, true));
    let map = guessed(&robot, &upright);
    let contacts = options().contacts;
    let shapes = FootShapes::of_collision_model(&CollisionModel::of(&robot).unwrap());
    let all = [
        options(),
        options().with_up(UpAxis::Y),
        options().with_contacts(ContactDetection::default()),
        options().with_contacts(contacts.with_height(0.02)),
        options().with_contacts(contacts.with_shortest(0.7)),
        options().with_contacts(contacts.with_lead(0.0)),
        options().with_contacts(contacts.with_lead(0.4)),
        options().with_contacts(contacts.with_lead(0.9)),
        options().with_contacts(contacts.with_speed(0.0)),
        options().with_shapes(FootShapes::default()),
        options().with_shapes(shapes),
        options().with_landing_weight(40.0),
        options().with_landing_weight(0.5),
    ];
    for (case, options) in all.into_iter().enumerate() {
        let captured = if case == 1 { &lying } else { &upright };
        let retargeting = Retargeting::new(&robot, &map, captured, options).unwrap();
        add_fitted(&mut one_by_one, &retargeting);
        let found = retargeting.per_frame().unwrap();
        add(&mut one_by_one, &retargeting, &found);
    }
    let short = capture(12, false);
    for options in [
        options().with_acceleration(0.0),
        options().with_acceleration(1e-2).with_tolerance(1e-4),
        options()
            .with_windows(Windows::new(7, 4))
            .with_tolerance(0.2),
        options()
            .with_contacts(contacts.with_lead(0.3))
            .with_shapes(FootShapes::default()),
    ] {
        let retargeting = Retargeting::new(&robot, &map, &short, options).unwrap();
        let mut heard = Vec::new();
        let found = retargeting.whole_with_progress(&mut |frames| heard.push(frames));
        add(&mut whole, &retargeting, &found.unwrap());
        add_text(&mut whole, &format!("{heard:?}"));
    }
    [one_by_one.value(), whole.value()]
}

/// On feet of every shape, and on none.
fn by_feet() -> Value {
    let mut digest = Digest::new();
    let captured = capture(20, false);
    let geoms = [
        ["", ""],
        BOXES,
        [
            r#"<geom type="sphere" size="0.03" pos="0 0 -0.03"/>"#,
            r#"<geom type="sphere" size="0.02"/>"#,
        ],
        [
            r#"<geom type="capsule" fromto="-0.03 0.02 -0.04 0.06 -0.02 -0.04" size="0.015"/>"#,
            "",
        ],
        [
            r#"<geom type="cylinder" size="0.05 0.01" pos="0.02 0 -0.04"/>"#,
            r#"<geom type="cylinder" size="0.02 0.03" euler="90 0 0"/>"#,
        ],
        [
            r#"<geom type="ellipsoid" size="0.07 0.03 0.02" pos="0.02 0 -0.04" euler="0 10 20"/>"#,
            r#"<geom type="ellipsoid" size="0.02 0.03 0.01"/>"#,
        ],
    ];
    for [foot, toe] in geoms {
        let robot = biped(foot, toe);
        let map = guessed(&robot, &captured);
        let retargeting = Retargeting::new(&robot, &map, &captured, options()).unwrap();
        add_fitted(&mut digest, &retargeting);
        add(&mut digest, &retargeting, &retargeting.per_frame().unwrap());
        let shapes = [FootShapes::of(&robot), FootShapes::of_files(&robot)];
        add_text(&mut digest, &format!("{shapes:?}"));
    }
    digest.value()
}

/// The shapes of a foot that only a collision model has, and what is written of options and answers.
fn shapes_and_files() -> Value {
    let mut digest = Digest::new();
    let robot = biped("", "");
    let toe = robot.model().frame("left_toe").unwrap();
    let at = Placement::new(
        rotation_exp(Vector3::new(0.1, 0.2, 0.0)),
        Vector3::new(0.01, 0.0, -0.02),
    );
    let corners = [
        [0.02, 0.0, 0.0],
        [0.0, 0.03, 0.0],
        [-0.02, 0.0, 0.01],
        [0.0, 0.0, 0.03],
        [0.0, -0.02, -0.01],
    ];
    let corners = corners.map(Vector3::from).to_vec();
    let faces = vec![[0, 1, 3], [1, 2, 3], [2, 4, 3], [4, 0, 3]];
    for shape in [
        Shape::convex(&corners),
        Shape::mesh(corners.clone(), faces),
        Shape::points(corners, 0.01),
        Shape::sphere(0.02),
        Shape::capsule(0.02, 0.05),
        Shape::cylinder(0.02, 0.05),
        Shape::cuboid([0.02, 0.05, 0.01]),
    ] {
        let own = CollisionObject::new("own", toe, at, shape.unwrap());
        let model = CollisionModel::new(robot.model(), vec![own]).unwrap();
        add_text(
            &mut digest,
            &format!("{:?}", FootShapes::of_collision_model(&model)),
        );
    }
    let captured = capture(6, false);
    let map = guessed(&robot, &captured);
    let low = options().contacts.with_height(0.2);
    for options in [
        options(),
        options()
            .with_contacts(low)
            .with_up(UpAxis::Y)
            .with_shapes(FootShapes::of(&robot)),
    ] {
        let text = serde_json::to_string(&options).unwrap();
        assert_eq!(
            serde_json::from_str::<RetargetOptions>(&text).unwrap(),
            options
        );
        add_text(&mut digest, &text);
        let retargeting = Retargeting::new(&robot, &map, &captured, options).unwrap();
        let found = retargeting.per_frame().unwrap();
        let text = serde_json::to_string(&found).unwrap();
        assert_eq!(serde_json::from_str::<Retargeted>(&text).unwrap(), found);
        add_text(&mut digest, &text);
    }
    digest.value()
}

/// By maps that leave parts out, lead other points, count them differently, and say what stands.
fn by_maps() -> Value {
    let mut digest = Digest::new();
    let robot = biped(BOXES[0], BOXES[1]);
    let captured = capture(14, false);
    let whole = guessed(&robot, &captured);
    let without = |parts: &[&str]| {
        let mut map = whole.clone();
        map.drives
            .retain(|drive| !parts.iter().any(|part| drive.joint.ends_with(part)));
        let driven: Vec<String> = map.drives.iter().map(|drive| drive.joint.clone()).collect();
        map.contacts = map
            .contacts
            .map(|own| own.into_iter().filter(|own| driven.contains(own)).collect());
        map
    };
    let mut changed = vec![
        without(&["toe"]),
        without(&["ankle"]),
        without(&["hip"]),
        without(&["left_hip"]),
        without(&["knee", "elbow", "head"]),
        without(&["pelvis"]),
        without(&["toe", "ankle"]),
        without(&["chest", "shoulder", "hand", "elbow", "head"]),
    ];
    let ask = |map: &mut BodyMap, joint: &str, set: &dyn Fn(&mut Drive)| {
        map.drives
            .iter_mut()
            .filter(|drive| drive.joint.ends_with(joint))
            .for_each(set);
    };
    for case in 0..7 {
        let mut map = whole.clone();
        match case {
            0 => ask(&mut map, "hand", &|drive| {
                drive.offset = Vector3::new(0.02, 0.01, -0.05)
            }),
            1 => ask(&mut map, "knee", &|drive| drive.weight = 5.0),
            2 => ask(&mut map, "hand", &|drive| drive.weight = 0.0),
            3 => ask(&mut map, "elbow", &|drive| drive.scale = Some(0.05)),
            4 => map.contacts = None,
            5 => map.contacts = Some(vec!["left_toe".to_owned(), "right_hand".to_owned()]),
            _ => map.contacts = Some(Vec::new()),
        }
        changed.push(map);
    }
    for mut map in changed {
        map.up = Some(UpAxis::Z);
        let retargeting =
            Retargeting::new(&robot, &map, &captured, options().with_up(UpAxis::Y)).unwrap();
        add_fitted(&mut digest, &retargeting);
        add(&mut digest, &retargeting, &retargeting.per_frame().unwrap());
    }
    digest.value()
}

/// Live, with a frame of nobody, and the follower by itself.
fn live() -> Value {
    let mut digest = Digest::new();
    let robot = biped(BOXES[0], BOXES[1]);
    let captured = capture(24, false);
    let map = guessed(&robot, &captured);
    for options in [
        options(),
        options().with_contacts(options().contacts.with_shortest(0.5).with_height(0.05)),
    ] {
        let retargeting = Retargeting::new(&robot, &map, &captured, options).unwrap();
        let mut live = retargeting.live().unwrap();
        digest.word(live.joints() as u64);
        digest.doubles([live.frame_rate()]);
        for frame in 0..24 {
            let mut places = places(frame).to_vec();
            if frame == 9 {
                places[3].y = f64::NAN;
            }
            digest.doubles(live.step(&places).unwrap().iter().copied());
        }
        add_error(&mut digest, &live.step(&places(0)[1..]).unwrap_err());
        digest.doubles(live.q().iter().copied());
        let mut follower = retargeting.follower().unwrap();
        let count = retargeting.driven().len();
        for frame in 0..12 {
            let firmness: Vec<f64> = (0..count).map(|k| ((frame + k) % 5) as f64 / 4.0).collect();
            let places = retargeting.targets(frame).unwrap();
            digest.doubles(follower.advance(places, &firmness).unwrap().iter().copied());
        }
        digest.doubles(follower.q().iter().copied());
    }
    digest.value()
}

/// So many frames, each with places changed.
fn changed_capture(frames: usize, change: impl Fn(usize, &mut [Vector3<f64>; 17])) -> Capture {
    let names = BodyPart::ALL.map(|(_, name)| name.to_owned()).to_vec();
    let numbers = (0..frames).flat_map(|frame| {
        let mut own = places(frame);
        change(frame, &mut own);
        own.map(Vector3::to_array)
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
    });
    Capture::new(names, &numbers.collect::<Vec<_>>(), 10.0).unwrap()
}

/// Hands that are led through the body, which is kept clear of them, from the first frame on or later.
fn clear() -> Value {
    let mut digest = Digest::new();
    let robot = biped(BOXES[0], BOXES[1]);
    let shapes = CollisionModel::of(&robot).unwrap();
    let shapes = shapes
        .with_touching_ignored(&robot.model().neutral())
        .unwrap();
    let checker = Checker::new(shapes);
    for (frames, deepest, margin) in [(9, 5.0, 0.01), (2, 0.0, 0.15)] {
        let captured = changed_capture(frames, |frame, own| {
            let share = 0.18 * (frame as f64 - deepest).abs();
            own[9] = own[0] + (own[9] - own[0]) * share;
            own[16] = own[1] + (own[16] - own[1]) * share;
        });
        let map = guessed(&robot, &captured);
        let retargeting = Retargeting::new(&robot, &map, &captured, options()).unwrap();
        let plain = retargeting.per_frame().unwrap();
        let kept = retargeting.keep_clear(&checker.clone().with_margin(margin).unwrap());
        let found = kept.per_frame().unwrap();
        assert_ne!(plain.q, found.q);
        add(&mut digest, &kept, &found);
        if margin < 0.02 {
            add(&mut digest, &kept, &kept.whole().unwrap());
        }
    }
    digest.value()
}

/// Feet that stand while the body is drawn away from them, where nothing but smoothness counts, come back and are lifted.
fn lost_contacts() -> Value {
    let mut digest = Digest::new();
    let robot = biped(BOXES[0], BOXES[1]);
    let captured = changed_capture(18, |frame, own| {
        let away = if (5..11).contains(&frame) { 7.0 } else { 0.0 };
        let stood = places(0);
        for ((place, stood), (part, _)) in own.iter_mut().zip(stood).zip(BodyPart::ALL) {
            match part.stands() {
                true => {
                    *place = stood - Vector3::new(1.0, 0.2, 0.0) * (4.0 - frame as f64).max(0.0)
                }
                false => *place += Vector3::new(0.0, 0.3 * away, away),
            }
        }
        own[5].z += if frame > 14 { 2.0 } else { 0.0 };
    });
    let map = guessed(&robot, &captured);
    let options = options().with_acceleration(0.3).with_tolerance(3.0);
    let options = options.with_windows(Windows::new(6, 2));
    let retargeting = Retargeting::new(&robot, &map, &captured, options).unwrap();
    let found = retargeting.whole().unwrap();
    assert!(!found.lost_contacts.is_empty());
    add(&mut digest, &retargeting, &found);
    digest.value()
}

/// A body that crouches over standing feet until ankles end, stands up, steps and crouches again; and feet whose ankles are pressed into
/// the ground while they slide.
fn pressed() -> Value {
    let mut digest = Digest::new();
    let robot = biped(BOXES[0], BOXES[1]);
    let crouched = changed_capture(30, |frame, own| {
        let deep = [0.0, 0.5, 1.0, 1.0, 0.5, 0.0][frame / 2 % 6];
        let stood = places(if frame < 14 { 0 } else { 11 });
        for ((place, stood), (part, _)) in own.iter_mut().zip(stood).zip(BodyPart::ALL) {
            let down = Vector3::new(2.5, 0.0, -3.5) * deep;
            *place = match part {
                part if part.stands() => stood,
                BodyPart::LeftKnee | BodyPart::RightKnee => {
                    stood + Vector3::new(3.0, 0.0, 0.0) * deep
                }
                _ => stood + down,
            };
        }
    });
    let sliding = changed_capture(10, |frame, own| {
        let by = Vector3::new(1.2 * frame as f64, 0.0, 0.0);
        for (place, stood) in own.iter_mut().zip(places(0)) {
            *place = stood + by;
        }
        let dip = if (2..7).contains(&frame) { 2.5 } else { 0.0 };
        (own[5].z, own[12].z) = (own[5].z - dip, own[12].z - 0.5 * dip);
    });
    for (captured, ankles) in [(crouched, true), (sliding, false)] {
        let mut map = guessed(&robot, &captured);
        if !ankles {
            map.contacts = Some(vec!["left_toe".to_owned(), "right_toe".to_owned()]);
        }
        let retargeting = Retargeting::new(&robot, &map, &captured, options()).unwrap();
        add(&mut digest, &retargeting, &retargeting.per_frame().unwrap());
    }
    digest.value()
}

/// Values at limits of position and speed, and just beside them.
fn active_limits() -> Value {
    let mut digest = Digest::new();
    let robot = biped("", "");
    let captured = capture(9, false);
    let map = guessed(&robot, &captured);
    let retargeting = Retargeting::new(&robot, &map, &captured, options()).unwrap();
    let mut found = retargeting.per_frame().unwrap();
    let model = robot.model();
    let (width, moves) = (found.configuration_len, robot.moves_within(0.1));
    for (coordinate, limits) in model.limits().enumerate() {
        if limits.lower.is_infinite() {
            continue;
        }
        let most = if moves[coordinate].is_finite() {
            moves[coordinate]
        } else {
            0.1
        };
        let middle = 0.5 * (limits.lower + limits.upper);
        let all = [
            limits.lower + 0.5e-9,
            limits.lower + 1.5e-9,
            limits.upper - 0.5e-9,
            limits.upper - 1.5e-9,
            middle,
            middle + most * (1.0 - 0.5e-9),
            middle + most * 1e-9,
            middle + most,
            middle,
        ];
        for (frame, value) in all.into_iter().enumerate() {
            found.q[frame * width + coordinate] = value;
        }
    }
    add_text(
        &mut digest,
        &format!("{:?}", retargeting.active_limits(&found)),
    );
    digest.value()
}

#[test]
fn of_movements_by_options() {
    let [one_by_one, whole] = by_options();
    check(&[
        ("retargeting: each option, frame by frame", one_by_one),
        ("retargeting: each option, as a whole", whole),
    ]);
}

#[test]
fn of_movements_by_feet_and_maps() {
    check(&[
        ("retargeting: feet of each shape", by_feet()),
        (
            "retargeting: shapes, and what is written",
            shapes_and_files(),
        ),
        ("retargeting: maps that say more", by_maps()),
    ]);
}

#[test]
fn of_movements_live_and_clear() {
    check(&[
        ("retargeting: live, step by step", live()),
        ("retargeting: clear of oneself", clear()),
        ("retargeting: what is given up", lost_contacts()),
        ("retargeting: feet that are pressed", pressed()),
        ("retargeting: limits that are met", active_limits()),
    ]);
}
