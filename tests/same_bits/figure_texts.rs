//! Promise: so it is for files of figures with several things changed: captures, rigs with their tables, cones and state machines.
#![allow(clippy::unwrap_used)]

use kinopt::animation::StateMachineDefinition;
use kinopt::io::{bvh, cones, dmat, state_machine};
use support::random::Random;
use support::small_rig::{DMAT, PLY, SmallRig};
use support::state_machines::clips;
use support::{changed_json, changed_text};

use crate::animated::check_single;
use crate::digest::{Digest, Value};
use crate::machines::GAIT;
use crate::robot_texts::{add_error, add_text};
use crate::{captures, rigs};

/// Channels in other orders, two at a place, a joint without any, names of several words, nothing but a root.
const MORE: &str = "HIERARCHY\nROOT a\n{\nOFFSET 1 2 3\nCHANNELS 2 Yposition Xrotation\nJOINT b c\n{\nOFFSET 0 1 0\nCHANNELS 4 Zposition Xposition Zrotation Yrotation\nEnd Site\n{\nOFFSET 0 0 1\n}\nJOINT d\n{\nOFFSET 1 0 0\nEnd Site\n{\nOFFSET 2 0 0\n}\n}\n}\n}\nROOT e\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Yrotation Zrotation\n}\nMOTION\nFrames: 2\nFrame Time: .5\n1 90 2 3 4 5 10 20 30\n-1 -90 .5 1e-1 4. -5 170 -80 0\n";

fn capture(digest: &mut Digest, bytes: &[u8]) {
    match bvh::from_bytes(bytes, "a/walk.bvh") {
        Ok(capture) => {
            // Only small ones: what a frame count promises is not made.
            captures::add(digest, &capture);
            let rate = [4.0, 30.0, 1.0 / capture.frame_time][capture.frames % 3];
            match bvh::to_text(&capture.armature, &capture.clip, rate) {
                Ok(text) => add_text(digest, &text),
                Err(error) => add_error(digest, &error),
            }
        }
        Err(error) => add_error(digest, &error),
    }
}

fn figures() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(931));
    for order in [
        "4 Xrotation Yrotation Xrotation Yrotation",
        "4 Xrotation Yrotation Zposition Xrotation",
        "3 Xrotation Zposition Xrotation",
        "6 Zrotation Zposition Xposition Xrotation Yposition Zrotation",
        "2 Zposition Zposition",
        "7 Xposition",
    ] {
        let text = MORE.replace("4 Zposition Xposition Zrotation Yrotation", order);
        capture(&mut digest, text.as_bytes());
    }
    for (text, count) in [(captures::FILE, 90), (MORE, 120)] {
        capture(&mut digest, text.as_bytes());
        for text in changed_text::changed(text, count, &mut random) {
            capture(&mut digest, text.as_bytes());
        }
    }
    digest.value()
}

fn rigs() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(932));
    let text = rigs::text();
    let mut add = |rig: SmallRig| match rig.parse() {
        Ok(rig) => {
            rigs::add(&mut digest, &rig);
            let again = rig.to_json("small.ply", "small.dmat");
            add_text(&mut digest, &again);
            if let (Some(_), Some(table)) = (&rig.mesh, rig.weights_table()) {
                let mut own = SmallRig::with_json(&again);
                own.dmat = Some(dmat::to_bytes(&table, dmat::DmatEncoding::Text));
                match own.parse() {
                    Ok(again) => rigs::add(&mut digest, &again),
                    Err(error) => add_text(&mut digest, &rigs::without_io(&error)),
                }
            }
        }
        Err(error) => add_text(&mut digest, &rigs::without_io(&error)),
    };
    for text in changed_json::changed(&text, 130, &mut random) {
        add(SmallRig::with_json(&text));
    }
    for text in changed_text::changed(&text, 40, &mut random) {
        add(SmallRig::with_json(&text));
    }
    // Ends of angles at and about what stands for no limit, one at a time.
    for from in ["-10,-20,-1e10", "10,90,1e10"] {
        for to in [
            "1e10", "-1e10", "9.9e9", "1e11", "-1e11", "90", "-20", "0", "180", "-180.5",
        ] {
            for at in 0..3 {
                let mut parts: Vec<&str> = from.split(',').collect();
                parts[at] = to;
                add(SmallRig::with_json(&text.replace(from, &parts.join(","))));
            }
        }
    }
    for name in [
        "bone/0", "bone/1", "bone/12", "a/b", "/", "", "hip/tip", "\u{e9}",
    ] {
        for from in ["{\"parent_id\":0", "{\"parent_id\":1"] {
            let named = from.replace('{', &format!("{{\"name\":\"{name}\","));
            add(SmallRig::with_json(&text.replacen(from, &named, 1)));
        }
    }
    for part in changed_text::changed(DMAT, 50, &mut random) {
        let mut own = SmallRig::with_json(&text);
        own.dmat = Some(part.into_bytes());
        add(own);
    }
    for part in changed_text::changed(PLY, 30, &mut random) {
        let mut own = SmallRig::with_json(&text);
        own.ply = Some(part.into_bytes());
        add(own);
    }
    digest.value()
}

/// Tables of text and of bytes, each damaged.
fn tables() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(933));
    let table = dmat::from_bytes(b"3 2\n1\n-0.5\n1e-3\n0\n2.5\n7\n", "t.dmat").unwrap();
    for encoding in [dmat::DmatEncoding::Text, dmat::DmatEncoding::Binary] {
        let good = dmat::to_bytes(&table, encoding);
        for round in 0..60 {
            let mut bytes = good.clone();
            let at = random.below(bytes.len());
            match round % 6 {
                0 => bytes[at] ^= 1 << random.below(8),
                1 => bytes.truncate(at),
                2 => bytes.extend_from_slice([&b" \n"[..], b"1 2 3", b"\0"][random.below(3)]),
                3 => drop(bytes.remove(at)),
                4 => bytes.insert(at, [b' ', b'0', b'\n', b'-', b'.'][random.below(5)]),
                _ => {}
            }
            match dmat::from_bytes(&bytes, "t.dmat") {
                Ok(table) => {
                    digest.debug(&table);
                    digest.bytes(dmat::to_bytes(&table, encoding));
                }
                Err(error) => add_error(&mut digest, &error),
            }
        }
    }
    digest.value()
}

const CONES: &str = r#"{"arm": {"swing": 90, "twist": [-60, 60]}, "elbow": {"axis": [0, 1, 0], "swing": 2, "twist": [-150, 0], "angle": 170},
 "neck": {"swing": [45, 25], "about": [1, 0, 0], "twist": [-70, 70]}, "q\"\\": {"angle": 30}, "\\": {"twist": [1, 1], "axis": [0, 0, 2]}}"#;

fn objects() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(934));
    let mut texts = changed_json::changed(CONES, 150, &mut random);
    texts.extend(changed_text::changed(CONES, 70, &mut random));
    texts.push(CONES.to_owned());
    for text in texts {
        match cones::from_bytes(text.as_bytes(), "man.json") {
            Ok(cones) => digest.debug(&cones),
            Err(error) => add_error(&mut digest, &error),
        }
    }
    let clips = clips();
    let mut texts = changed_json::changed(GAIT, 200, &mut random);
    texts.extend(changed_text::changed(GAIT, 60, &mut random));
    for text in texts {
        match state_machine::from_bytes(text.as_bytes(), "gait.json", &clips) {
            Ok(machine) => add_text(
                &mut digest,
                &format!("{:?}", machine.states().collect::<Vec<_>>()),
            ),
            Err(error) => add_error(&mut digest, &error),
        }
        match serde_json::from_str::<StateMachineDefinition>(&text) {
            Ok(own) => add_text(
                &mut digest,
                &format!("{own:?} {}", serde_json::to_string(&own).unwrap()),
            ),
            Err(error) => add_error(&mut digest, &error),
        }
    }
    digest.value()
}

#[test]
fn of_texts_of_figures() {
    check_single(&[
        ("texts of figures: captures, changed", figures()),
        ("texts of figures: rigs, changed", rigs()),
        ("texts of figures: tables, changed", tables()),
        ("texts of figures: cones and machines, changed", objects()),
    ]);
}
