//! Promise: so it is for movements on robots by options, maps and captures that are drawn at random, together.
#![allow(clippy::unwrap_used)]

use kinopt::collision::{Checker, CollisionModel};
use kinopt::motion::retarget::{
    BodyMap, BodyPart, Capture, ContactDetection, FootShapes, KnownSkeleton, RetargetOptions,
    Retargeting, UpAxis,
};
use kinopt::motion::trajectory::Windows;
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;
use support::random::Random;

use crate::digest::{Digest, Value, check};
use crate::drawn::{at_times, one_of};
use crate::retargeting::{add, add_fitted};
use crate::robot_texts::add_text;
use crate::walking_person::{BOXES, biped, places};

/// A person's way of which some parts are moved, at another rate, y upward or not, parts in another order.
fn capture(random: &mut Random, frames: usize, y_up: bool) -> Capture {
    let mut order: Vec<usize> = (0..17).collect();
    if at_times(random, 0.4) {
        order.rotate_left(1 + random.below(16));
    }
    let (moved, rate) = (random.below(17), one_of(random, &[10.0, 12.0, 25.0]));
    let by = random.vector(1.5);
    let first = one_of(random, &[0, 3, 8]);
    let names = order
        .iter()
        .map(|&k| BodyPart::ALL[k].1.to_owned())
        .collect();
    let mut numbers = Vec::new();
    for frame in first..first + frames {
        let mut own = places(frame);
        own[moved] += Vector3::from(by) * (0.1 * (frame - first) as f64);
        for &part in &order {
            let at = own[part];
            numbers.extend(match y_up {
                true => [at.y, at.z, at.x],
                false => at.to_array(),
            });
        }
    }
    Capture::new(names, &numbers, rate).unwrap()
}

/// A map of which drives are left out, changed, named wrongly or doubled.
fn changed(random: &mut Random, mut map: BodyMap, robot: &Robot) -> BodyMap {
    for _ in 0..random.below(4) {
        let count = map.drives.len();
        let own = random.below(count.max(1));
        if count == 0 {
            break;
        }
        match random.below(9) {
            0 => _ = map.drives.remove(own),
            1 => map.drives[own].weight = one_of(random, &[0.0, 0.3, 4.0, 4.0, -1.0]),
            2 => map.drives[own].scale = Some(one_of(random, &[0.05, 0.02, 0.02, f64::NAN])),
            3 => map.drives[own].offset = Vector3::from(random.vector(0.05)),
            4 => {
                let frames = robot.model().frames();
                let frame = frames[random.below(frames.len())].name.clone();
                map.drives[own].frame = one_of(
                    random,
                    &[frame.clone(), frame.clone(), frame, "hnad".to_owned()],
                );
            }
            5 => map.drives.swap(0, own),
            6 => {
                let stands: Vec<String> =
                    map.drives.iter().map(|drive| drive.joint.clone()).collect();
                map.contacts = Some(
                    (0..random.below(4))
                        .map(|_| one_of(random, &stands))
                        .collect(),
                );
            }
            7 => map.up = Some(one_of(random, &[UpAxis::Y, UpAxis::Z])),
            _ => map.contacts = None,
        }
    }
    map
}

fn options(random: &mut Random, robot: &Robot) -> RetargetOptions {
    let mut contacts = ContactDetection::default().with_speed(one_of(random, &[0.18, 0.25, 0.5]));
    if at_times(random, 0.4) {
        contacts = contacts.with_height(one_of(random, &[0.0, 0.03, 0.2]));
    }
    if at_times(random, 0.4) {
        contacts = contacts.with_shortest(one_of(random, &[0.0, 0.2, 0.5]));
    }
    if at_times(random, 0.5) {
        contacts = contacts.with_lead(one_of(random, &[0.0, 0.3, 0.7]));
    }
    let mut own = RetargetOptions::default().with_contacts(contacts);
    if at_times(random, 0.3) {
        own = own.with_shapes(one_of(
            random,
            &[FootShapes::default(), FootShapes::of(robot)],
        ));
    }
    if at_times(random, 0.3) {
        own = own.with_landing_weight(one_of(random, &[0.5, 20.0, 20.0, 0.0]));
    }
    if at_times(random, 0.5) {
        own = own.with_acceleration(one_of(random, &[0.0, 1e-2, -1.0]));
    }
    if at_times(random, 0.5) {
        own = own.with_windows(Windows::new(
            one_of(random, &[2, 4, 0]),
            one_of(random, &[0, 2]),
        ));
    }
    own.with_tolerance(one_of(random, &[0.1, 0.3]))
}

/// Puts joints at their limits, or so near that it hardly counts.
fn at_limits(random: &mut Random, robot: &Robot, q: &mut [f64]) {
    let limits: Vec<_> = robot.model().limits().collect();
    for q in q.chunks_exact_mut(limits.len()) {
        for (q, own) in q.iter_mut().zip(&limits) {
            let room = own.upper - own.lower;
            if room.is_finite() && at_times(random, 0.4) {
                let off = one_of(
                    random,
                    &[0.0, 0.5e-9, 2e-9, 0.5e-9 * room, 2e-9 * room, 0.5 * room],
                );
                *q = one_of(random, &[own.lower + off, own.upper - off]);
            }
        }
    }
}

fn movements() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2061));
    let feet = [
        ["", ""],
        BOXES,
        [r#"<geom type="sphere" size="0.03" pos="0 0 -0.03"/>"#, ""],
        [
            r#"<geom type="cylinder" size="0.05 0.01" pos="0.02 0 -0.04"/>"#,
            r#"<geom type="capsule" fromto="0 -0.02 0 0 0.02 0" size="0.01"/>"#,
        ],
    ];
    let narrow = "joint_limits:\n  left_toe: {min_position: -0.05, max_position: 0.2}\n  nod: {min_position: -0.001, max_position: 0.002}\n";
    let robots = feet.map(|[foot, toe]| biped(foot, toe));
    let narrower = |robot: Robot| {
        robot
            .with_joint_limits_of(narrow.as_bytes(), "narrow.yaml")
            .unwrap()
    };
    let robots = robots.map(narrower);
    for case in 0..34 {
        let robot = &robots[case % 4];
        let y_up = at_times(&mut random, 0.3);
        let captured = capture(&mut random, 5 + case % 3, y_up);
        let Some(guess) = digest.answer(BodyMap::guess(&captured, robot.model())) else {
            continue;
        };
        let map = changed(&mut random, guess.map, robot);
        if let Some(guess) = digest.answer(map.clone().completed(&captured, robot.model())) {
            add_text(&mut digest, &format!("{guess:?}"));
        }
        add_text(&mut digest, &map.to_json());
        let mut options = options(&mut random, robot);
        if at_times(&mut random, 0.9) {
            options = options.with_up(if y_up { UpAxis::Y } else { UpAxis::Z });
        }
        let asked = Retargeting::new(robot, &map, &captured, options);
        let Some(mut asked) = digest.answer(asked) else {
            continue;
        };
        if at_times(&mut random, 0.15) {
            let shapes = CollisionModel::of(robot).unwrap();
            let shapes = shapes.with_touching_ignored(&robot.model().neutral());
            asked = asked.keep_clear(&Checker::new(shapes.unwrap()).with_margin(0.02).unwrap());
        }
        add_fitted(&mut digest, &asked);
        let found = match at_times(&mut random, 0.5) {
            true => asked.whole(),
            false => asked.per_frame(),
        };
        if let Some(mut found) = digest.answer(found) {
            add(&mut digest, &asked, &found);
            at_limits(&mut random, robot, &mut found.q);
            add_text(&mut digest, &format!("{:?}", asked.active_limits(&found)));
        }
        if let Some(mut follower) = digest.answer(asked.follower()) {
            let count = follower.places();
            let [given, stood] = [(); 2].map(|()| match random.below(4) {
                0 => count.saturating_sub(1),
                _ => count,
            });
            let places = asked.targets(1).unwrap_or_default();
            let stands: Vec<f64> = (0..stood)
                .map(|_| one_of(&mut random, &[0.0, 0.4, 1.0]))
                .collect();
            let given = &places[..given.min(places.len())];
            if let Some(q) = digest.answer(follower.advance(given, &stands)) {
                digest.doubles(q.iter().copied());
            }
        }
        let Some(mut live) = digest.answer(asked.live()) else {
            continue;
        };
        for frame in 0..captured.frames() {
            let mut own = captured.frame(frame).unwrap().to_vec();
            if at_times(&mut random, 0.15) {
                own[random.below(17)].z -= 3.0;
            }
            if at_times(&mut random, 0.05) {
                own[random.below(17)].y = f64::NAN;
            }
            if let Some(q) = digest.answer(live.step(&own)) {
                digest.doubles(q.iter().copied());
            }
        }
    }
    digest.value()
}

/// Texts of maps, of which pieces are left out, doubled and changed.
fn texts() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2062));
    let pieces = [
        r#""about": "a map""#,
        r#""joints": ["a", "b", "c"]"#,
        r#""joints": ["a", "b", "a"]"#,
        r#""fps": 30"#,
        r#""fps": 0"#,
        r#""up": "y""#,
        r#""up": "z""#,
        r#""up": "x""#,
        r#""contacts": ["a"]"#,
        r#""contacts": []"#,
        r#""drives": {}"#,
        r#""drives": {"a": "left", "b": {"frame": "right", "weight": 2, "offset": [0, 0.5, 1]}}"#,
        r#""drives": {"b": {"frame": "right", "scale": 0.5}, "a": "left"}"#,
        r#""drives": {"biped": {"a": "left"}, "other": {"b": "right"}}"#,
        r#""drives": {"other": {"b": "right"}}"#,
        r#""drives": {"biped": {"a": {"frame": "left", "odd": 1}}}"#,
        r#""drives": {"a": {"frame": "left", "offset": [0, 1]}}"#,
        r#""drives": {"a": 3}"#,
        r#""drives": null"#,
        r#""odd": true"#,
    ];
    for _ in 0..160 {
        let count = 1 + random.below(4);
        let own: Vec<&str> = (0..count).map(|_| one_of(&mut random, &pieces)).collect();
        let ends = one_of(
            &mut random,
            &[
                ["{", "}"],
                ["{", "}"],
                ["{", "}"],
                ["{", "}"],
                [" [", "]"],
                ["{", ""],
            ],
        );
        let text = format!("{}{}{}", ends[0], own.join(", "), ends[1]);
        if let Some(map) = digest.answer(BodyMap::from_json(&text, "biped")) {
            add_text(&mut digest, &format!("{map:?} {}", map.to_json()));
            let again = BodyMap::from_json(&map.to_json(), "biped").ok();
            add_text(&mut digest, &format!("{again:?}"));
        }
    }
    for name in KnownSkeleton::names().chain(["cmv", ""]) {
        let Some(known) = digest.answer(KnownSkeleton::named(name)) else {
            continue;
        };
        for count in 0..=known.joints().len() + 1 {
            let first = &known.joints()[..count.min(known.joints().len())];
            let found = KnownSkeleton::of_joints(first);
            add_text(
                &mut digest,
                &format!(
                    "{:?} {:?}",
                    known.joints_of_array(count),
                    found.map(|own| own.name())
                ),
            );
        }
    }
    digest.value()
}

#[test]
fn of_drawn_retargeting() {
    check(&[
        ("drawn movements on robots", movements()),
        ("drawn texts of maps", texts()),
    ]);
}
