//! Promise: so it is for what names tell of bodies, and for maps as texts.
#![allow(clippy::unwrap_used)]

use kinopt::model::{Limits, Model};
use kinopt::motion::retarget::{
    BodyMap, BodyPart, Capture, KnownSkeleton, MapGuess, RetargetError, UpAxis,
};
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;

use crate::digest::{Digest, Value, check};
use crate::robot_texts::{add_error, add_text};
use crate::walking_person::{biped, capture};

fn add_guess(digest: &mut Digest, guess: Result<MapGuess, RetargetError>) {
    match guess {
        Ok(guess) => {
            add_text(digest, &format!("{guess:?} {}", guess.map.to_json()));
            let again = BodyMap::from_json(&guess.map.to_json(), "").unwrap();
            assert_eq!(again.drives, guess.map.drives);
        }
        Err(error) => add_error(digest, &error),
    }
}

const KNOWN_BODIES: [&str; 4] = [
    include_str!("../../crates/kinopt-motion/maps/bodies/g1.json"),
    include_str!("../../crates/kinopt-motion/maps/bodies/h1.json"),
    include_str!("../../crates/kinopt-motion/maps/bodies/humanoid.json"),
    include_str!("../../crates/kinopt-motion/maps/bodies/nao.json"),
];

/// The frames that a known body has.
fn frames_in(text: &str) -> Vec<String> {
    let read: serde_json::Value = serde_json::from_str(text).unwrap();
    let parts = read["parts"].as_object().unwrap().values();
    let frames = parts.map(|part| part.as_str().or_else(|| part["frame"].as_str()));
    let mut names: Vec<String> = Vec::new();
    for frame in frames.map(Option::unwrap) {
        if !names.iter().any(|name| name == frame) {
            names.push(frame.to_owned());
        }
    }
    names
}

/// Frames of these names, apart.
fn model(names: &[String]) -> Model {
    let mut builder = Model::builder("named");
    for (place, name) in names.iter().enumerate() {
        // Two of them at one place.
        let x = if place == 5 { 4.0 } else { place as f64 };
        let at = Placement::translation(Vector3::new(x, 0.0, 0.0));
        let turns = Limits::new(-1.0, 1.0);
        let joint = builder.revolute(format!("j{place}"), None, at, Vector3::UNITS[2], turns);
        builder.frame(name, Some(joint), Placement::identity());
    }
    builder.build().unwrap()
}

fn named(names: &[String]) -> Capture {
    let numbers = (0..3 * 5 * names.len()).map(|k| ((k * k) % 17) as f64 * 0.1);
    Capture::new(names.to_vec(), &numbers.collect::<Vec<_>>(), 5.0).unwrap()
}

const WORDS: [&str; 17] = [
    "hips",
    "spine",
    "head",
    "LeftUpLeg",
    "LeftLeg",
    "LeftFoot",
    "LeftToeBase",
    "LeftArm",
    "LeftForeArm",
    "LeftHand",
    "RightUpLeg",
    "RightLeg",
    "RightFoot",
    "RightToeBase",
    "RightArm",
    "RightForeArm",
    "RightHand",
];

/// The same names as many programs write them.
fn spelt() -> Vec<Vec<String>> {
    let own = |change: &dyn Fn(&str) -> String| WORDS.map(change).to_vec();
    let sided = |left: &str, right: &str, word: &str| match (
        word.strip_prefix("Left"),
        word.strip_prefix("Right"),
    ) {
        (Some(rest), _) => left.replace('*', rest),
        (_, Some(rest)) => right.replace('*', rest),
        _ => word.to_owned(),
    };
    let mut all = vec![
        own(&|word| word.to_owned()),
        own(&|word| word.to_lowercase()),
        own(&|word| format!("mixamorig:{word}")),
        own(&|word| format!("mixamorig12_{word}")),
        own(&|word| sided("l_*", "r_*", word)),
        own(&|word| sided("*.L", "*.R", word)),
        own(&|word| format!("a|b:{word}_link")),
        own(&|word| format!("Bip01 {}", sided("L *", "R *", word))),
        own(&|word| sided("*_lft1", "*_rgt1", word)),
        own(&|word| word.to_uppercase()),
    ];
    for (from, to) in [
        ("UpLeg", "Thigh"),
        ("UpLeg", "Hip"),
        ("Leg", "Knee"),
        ("LeftLeg", "left_calf"),
        ("Foot", "Ankle"),
        ("ToeBase", "Ball"),
        ("ToeBase", "Foot"),
        ("Arm", "Shoulder"),
        ("Arm", "Elbow"),
        ("ForeArm", "LowerArm"),
        ("Hand", "Wrist"),
        ("hips", "torso"),
        ("spine", "torso"),
        ("hips", "x"),
        ("head", "Head01"),
        ("Hand", "rubber_hand"),
        ("UpLeg", "hip_yaw_joint"),
        ("Foot", "ankle_roll_link"),
        ("RightHand", "LeftHand"),
    ] {
        all.push(own(&|word| word.replace(from, to)));
    }
    let more = ["l_hand", "Head01", "hip", "L Foot", "Chest2", "skull"].map(str::to_owned);
    all.push([&all[0][..], &more].concat());
    all.push([&more, &all[0][..]].concat());
    all.push(["a", "b", "c"].map(str::to_owned).to_vec());
    all.push((0..20).map(|k| format!("bone{k}")).collect());
    all.push(["hips", "head", "tail"].map(str::to_owned).to_vec());
    all
}

fn guesses() -> Value {
    let mut digest = Digest::new();
    let bodies = [
        biped("", "").model().clone(),
        robot("aldebaran_nao").model().clone(),
        robot("franka_panda").model().clone(),
    ];
    let all: Vec<Vec<String>> = spelt()
        .into_iter()
        .map(|names| {
            let mut seen = Vec::new();
            names
                .into_iter()
                .filter(|name| {
                    !seen.contains(name) && {
                        seen.push(name.clone());
                        true
                    }
                })
                .collect()
        })
        .collect();
    for names in &all {
        let captured = named(names);
        for body in &bodies {
            add_guess(&mut digest, BodyMap::guess(&captured, body));
        }
        add_guess(&mut digest, BodyMap::guess(&captured, &model(names)));
    }
    let walker = capture(12, true);
    add_guess(&mut digest, BodyMap::guess(&walker, &bodies[0]));
    for text in KNOWN_BODIES {
        let frames = frames_in(text);
        add_guess(&mut digest, BodyMap::guess(&walker, &model(&frames)));
        // One of them is missing, so names tell.
        add_guess(&mut digest, BodyMap::guess(&walker, &model(&frames[1..])));
    }
    for name in KnownSkeleton::names().chain(["smp", "nobody"]) {
        let known = match KnownSkeleton::named(name) {
            Ok(known) => known,
            Err(error) => {
                add_error(&mut digest, &error);
                continue;
            }
        };
        add_text(&mut digest, &format!("{known:?}"));
        for count in 0..80 {
            digest.word(known.joints_of_array(count).map_or(0, <[String]>::len) as u64);
        }
        let prefixed: Vec<String> = known
            .joints()
            .iter()
            .map(|joint| format!("who:{joint}"))
            .collect();
        let lacking: Vec<String> = known.joints().iter().skip(1).cloned().collect();
        for joints in [known.joints().to_vec(), prefixed, lacking, all[2].clone()] {
            add_text(
                &mut digest,
                &format!("{:?}", KnownSkeleton::of_joints(&joints)),
            );
            if joints.is_empty() {
                continue;
            }
            let captured = named(&joints);
            add_guess(
                &mut digest,
                BodyMap::from_skeleton(&known, &captured, &bodies[1]),
            );
            add_guess(&mut digest, BodyMap::guess(&captured, &bodies[0]));
        }
    }
    digest.value()
}

/// Maps as texts, and completed by names.
fn texts() -> Value {
    let mut digest = Digest::new();
    let body = biped("", "");
    let walker = capture(3, false);
    for text in [
        "{}",
        "[]",
        " [1",
        "{",
        "{\"drives\": {}}",
        "{\"drives\": []}",
        "{\"what\": 1}",
        "{\"fps\": 0}",
        "{\"fps\": -1.5}",
        "{\"fps\": 24}",
        "{\"up\": \"x\"}",
        "{\"up\": \"y\"}",
        "{\"up\": \"z\", \"contacts\": [\"left_ankle\"]}",
        "{\"joints\": [\"a\", \"b\", \"a\"]}",
        "{\"joints\": [\"b\", \"a\"], \"about\": \"x\"}",
        "{\"drives\": {\"pelvis\": \"pelvis\", \"left_hand\": {\"frame\": \"left_hand\", \"weight\": 2, \"offset\": [0, 0, -0.05], \"scale\": 0.8}}}",
        "{\"drives\": {\"pelvis\": \"pelvis\", \"head\": {\"frame\": \"head\", \"weight\": 1, \"offset\": [0, 0, 0]}}, \"contacts\": []}",
        "{\"drives\": {\"pelvis\": {\"frame\": 1}}}",
        "{\"drives\": {\"pelvis\": {\"fram\": \"x\"}}}",
        "{\"drives\": {\"pelvis\": 3}}",
        "{\"drives\": {\"pelvis\": {\"frame\": \"x\", \"offset\": [1, 2]}}}",
        "{\"drives\": {\"biped.xml\": {\"pelvis\": \"pelvis\"}, \"other\": {\"head\": \"head\"}}}",
        "{\"drives\": {\"other\": {\"head\": \"head\"}}}",
    ] {
        for robot in ["biped.xml", "other"] {
            match BodyMap::from_json(text, robot) {
                Ok(map) => {
                    add_text(&mut digest, &format!("{map:?} {}", map.to_json()));
                    add_guess(&mut digest, map.completed(&walker, body.model()));
                }
                Err(error) => add_error(&mut digest, &error),
            }
        }
    }
    for (part, name) in BodyPart::ALL {
        add_text(
            &mut digest,
            &format!("{part:?} {name} {} {}", part.name(), part.stands()),
        );
    }
    for up in [UpAxis::Y, UpAxis::Z] {
        add_text(&mut digest, &format!("{:?}", up.turned_to_z()));
    }
    digest.value()
}

#[test]
fn of_maps_and_guesses() {
    check(&[
        ("body maps: what names tell", guesses()),
        ("body maps: texts", texts()),
    ]);
}
