//! Promise: so it is for state machines that are drawn at random, as they run and where they are refused.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use kinopt::animation::{Armature, Clip, StateMachineRun};
use kinopt::io::state_machine;
use support::random::Random;

use crate::animated::check_single;
use crate::digest::{Digest, Value};
use crate::drawn::{at_times, one_of};
use crate::drawn_clips::{body, clip};
use crate::machines::update;

const NUMBERS: [&str; 2] = ["speed", "height"];
const FLAGS: [&str; 2] = ["down", "armed"];
const TRIGGERS: [&str; 2] = ["hop", "stop"];

/// Clips of one body, one of which lasts no time, and one of another.
fn clips(random: &mut Random) -> (Armature, Vec<Arc<Clip>>) {
    let (body, other) = (body(random, 2), body(random, 3));
    let still = Clip::builder("still", &body).build();
    let mut clips = ["walk", "run", "Armature|jump"]
        .map(|name| clip(name, &body, random))
        .to_vec();
    clips.extend([still, clip("wide", &other, random)]);
    (body, clips.into_iter().map(Arc::new).collect())
}

/// A name, seldom a wrong one.
fn name(random: &mut Random, names: &[&str]) -> String {
    match at_times(random, 0.01) {
        true => one_of(random, &["", "hpo", "sped", "Walk", "c"]).to_owned(),
        false => one_of(random, names).to_owned(),
    }
}

/// A number, seldom one that is out of range.
fn value(random: &mut Random, numbers: &[&str]) -> String {
    match at_times(random, 0.01) {
        true => one_of(random, &["-1", "1e39", "1e999", "true", "null", "\"x\""]).to_owned(),
        false => one_of(random, numbers).to_owned(),
    }
}

fn clip_name(random: &mut Random) -> String {
    let odd = at_times(random, 0.01);
    let names: &[&str] = if odd {
        &["wide", "jumq"]
    } else {
        &["walk", "run", "jump", "still"]
    };
    one_of(random, names).to_owned()
}

fn state(random: &mut Random, index: usize) -> String {
    let mut text = format!(r#"{{"name": "{}""#, ["a", "b", "c", "d"][index]);
    if at_times(random, 0.5) {
        text += &format!(r#", "clip": "{}""#, clip_name(random));
    } else {
        let parameter = name(random, &NUMBERS);
        let count = 1 + random.below(3);
        let ends = ["-1", "0.5", "2"].map(|at| {
            let at = value(random, &[at]);
            format!(r#"{{"at": {at}, "clip": "{}"}}"#, clip_name(random))
        });
        let ends = ends[..count].join(", ");
        text += &format!(r#", "blend": {{"parameter": "{parameter}", "clips": [{ends}]}}"#);
    }
    if at_times(random, 0.5) {
        text += &format!(
            r#", "playback": "{}""#,
            one_of(random, &["hold", "loop", "ping_pong"])
        );
    }
    if at_times(random, 0.5) {
        text += &format!(
            r#", "speed": {}"#,
            value(random, &["1.5", "-0.75", "0", "0.2", "40"])
        );
    }
    text + "}"
}

fn condition(random: &mut Random) -> String {
    let mut text = String::from("{\"parameter\": \"");
    let kind = random.below(3);
    match kind {
        0 => {
            text += &name(random, &NUMBERS);
            text += "\"";
            let sides = 1 + random.below(3);
            if sides % 2 == 1 {
                text += &format!(r#", "above": {}"#, value(random, &["-0.5", "0", "0.7"]));
            }
            if sides > 1 {
                text += &format!(r#", "below": {}"#, value(random, &["1.5", "0.9", "3"]));
            }
        }
        1 => {
            text += &name(random, &FLAGS);
            text += &format!("\", \"is\": {}", one_of(random, &["true", "false"]));
        }
        _ => text += &format!("{}\"", name(random, &TRIGGERS)),
    }
    if at_times(random, 0.01) {
        text += &format!(
            ", {}",
            one_of(random, &[r#""is": true"#, r#""above": 9"#, r#""odd": 1"#])
        );
    }
    text + "}"
}

fn transition(random: &mut Random, names: &[&str]) -> String {
    let mut text = format!(r#"{{"to": "{}""#, name(random, names));
    let anywhere = at_times(random, 0.25);
    if !anywhere {
        text += &format!(r#", "from": "{}""#, name(random, names));
    }
    let seconds = ["0", "0.05", "0.3", "1.1"];
    for (key, share) in [("seconds", 0.8), ("after", 0.3), ("after_seconds", 0.3)] {
        if at_times(random, share) {
            text += &format!(r#", "{key}": {}"#, value(random, &seconds));
        }
    }
    if at_times(random, 0.4) {
        let easings = [
            r#""quadratic_in""#,
            r#""cubic_in_out""#,
            r#"{"bezier": [[0.3, 0.0], [0.6, 1.2]]}"#,
        ];
        text += &format!(r#", "easing": {}"#, one_of(random, &easings));
    }
    if at_times(random, 0.4) {
        text += &format!(r#", "in_step": {}"#, one_of(random, &["true", "false"]));
    }
    if at_times(random, 0.7) {
        text += &format!(
            r#", "interruption": "{}""#,
            one_of(random, &["never", "source", "target", "either"])
        );
    }
    let least = usize::from(anywhere && at_times(random, 0.97));
    let conditions: Vec<String> = (0..least + random.below(2))
        .map(|_| condition(random))
        .collect();
    text + &format!(r#", "when": [{}]}}"#, conditions.join(", "))
}

fn machine(random: &mut Random) -> String {
    let count = 1 + random.below(4);
    let names = &["a", "b", "c", "d"][..count];
    let states: Vec<String> = (0..count).map(|index| state(random, index)).collect();
    let transitions: Vec<String> = (0..random.below(8))
        .map(|_| transition(random, names))
        .collect();
    let mut parameters = format!(
        r#"{{"speed": {}, "height": 0.6, "down": false, "armed": true, "hop": "trigger", "stop": "trigger"}}"#,
        value(random, &["0", "0.8", "-2"])
    );
    if at_times(random, 0.02) {
        let odd = [
            "[]",
            r#"{"hop": "triger"}"#,
            r#"{"hop": "trigger", "hop": 1}"#,
            "3",
        ];
        parameters = one_of(random, &odd).to_owned();
    }
    format!(
        r#"{{"parameters": {parameters}, "initial": "{}", "states": [{}], "transitions": [{}]}}"#,
        name(random, names),
        states.join(", "),
        transitions.join(", ")
    )
}

fn change(digest: &mut Digest, random: &mut Random, run: &mut StateMachineRun) {
    match random.below(6) {
        0 => digest.answer(run.trigger(&name(random, &TRIGGERS))),
        1 => digest.answer(run.clear_trigger(&name(random, &TRIGGERS))),
        2 => digest.answer(run.set_flag(&name(random, &FLAGS), at_times(random, 0.5))),
        _ => {
            let values = [-1.0, -0.25, 0.5, 0.8, 1.2, 2.0, 2.5, f32::NAN];
            digest.answer(run.set_number(&name(random, &NUMBERS), one_of(random, &values)))
        }
    };
}

fn runs() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(2021));
    for case in 0..260 {
        let (body, clips) = clips(&mut random.clone());
        let text = machine(&mut random);
        let read = state_machine::from_bytes(text.as_bytes(), "drawn.json", &clips);
        let Some(machine) = digest.answer(read) else {
            continue;
        };
        let rest = if case % 40 == 39 {
            crate::drawn_clips::body(&mut random, 3)
        } else {
            body
        };
        let run = StateMachineRun::new(Arc::new(machine), rest.rest());
        let Some(mut run) = digest.answer(run) else {
            continue;
        };
        for _ in 0..16 {
            change(&mut digest, &mut random, &mut run);
            let seconds = one_of(&mut random, &[0.0, 0.05, 0.2, 0.45, 1.3, -1.0]);
            update(&mut digest, &mut run, seconds);
        }
    }
    digest.value()
}

#[test]
fn of_drawn_state_machines() {
    check_single(&[("drawn state machines", runs())]);
}
