//! Promise: so it is for state machines: what they play, tell and pass at every moment, and what their files may not say.
#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use kinopt::animation::{Clip, StateMachineDefinition, StateMachineRun};
use kinopt::io::state_machine;
use support::random::Random;
use support::state_machines::{armature, clips, run_of};

use crate::animated::{self, check_single};
use crate::digest::{Digest, Value};

fn note(digest: &mut Digest, run: &StateMachineRun) {
    digest.bytes(run.state());
    digest.debug((run.fading(), run.leaving(), run.events_left_out()));
    digest.doubles([run.seconds(), run.played()]);
    digest.debug(run.playing().collect::<Vec<_>>());
    digest.debug(run.parameters().collect::<Vec<_>>());
    digest.pose(run.pose());
}

pub(crate) fn update(digest: &mut Digest, run: &mut StateMachineRun, seconds: f64) {
    run.update(seconds, |passed| {
        digest.bytes(format!(
            "{} {} {}",
            passed.state, passed.clip, passed.event.name
        ));
        digest.singles([passed.weight, passed.event.time]);
    })
    .unwrap();
    note(digest, run);
}

/// Every kind of motion, condition, easing and interruption.
pub(crate) const GAIT: &str = r#"{
 "parameters": {"speed": 0.5, "level": -1, "down": false, "hop": "trigger", "stop": "trigger"},
 "initial": "idle",
 "states": [
  {"name": "idle", "clip": "stand"},
  {"name": "move", "speed": 1.25, "blend": {"parameter": "speed", "clips": [
    {"at": 0, "clip": "stand"}, {"at": 1, "clip": "walk"}, {"at": 3, "clip": "run"}]}},
  {"name": "back", "clip": "run", "playback": "ping_pong", "speed": -0.75},
  {"name": "hop", "clip": "jump", "playback": "hold"},
  {"name": "frozen", "clip": "walk", "speed": 0}
 ],
 "transitions": [
  {"from": "idle", "to": "move", "seconds": 0.4, "easing": "cubic_in_out", "when": [{"parameter": "speed", "above": 0.6, "below": 4}], "interruption": "either"},
  {"from": "move", "to": "idle", "seconds": 0.3, "when": [{"parameter": "speed", "below": 0.6}], "interruption": "source"},
  {"to": "hop", "seconds": 0.25, "when": [{"parameter": "hop"}, {"parameter": "down", "is": false}], "interruption": "target"},
  {"from": "hop", "to": "back", "after": 0.8, "seconds": 0.2, "easing": {"bezier": [[0.3, 0.0], [0.6, 1.2]]}, "in_step": true},
  {"from": "back", "to": "idle", "after_seconds": 1.1, "seconds": 0.0},
  {"from": "back", "to": "move", "after": 2, "when": [{"parameter": "level", "above": 0}], "in_step": true, "seconds": 0.5},
  {"to": "frozen", "when": [{"parameter": "stop"}], "in_step": true},
  {"from": "frozen", "to": "idle", "after_seconds": 0.5, "seconds": 0.1, "easing": "quadratic_out"}
 ]}"#;

fn runs() -> Value {
    let mut digest = Digest::new();
    let mut random = Random::new(131);
    for seed in 0..6 {
        let mut run = run_of(GAIT);
        note(&mut digest, &run);
        for step in 0..60 {
            match random.below(9) {
                0 => run.trigger("hop").unwrap(),
                1 => run.clear_trigger("hop").unwrap(),
                2 => run.trigger("stop").unwrap(),
                3 => run.set_flag("down", step % 2 == 0).unwrap(),
                4 => run.set_number("level", (step % 3) as f32 - 1.0).unwrap(),
                _ => {
                    let speed = [0.2, 0.7, 1.0, 2.4, 3.0, 3.5][random.below(6)];
                    run.set_number("speed", speed).unwrap();
                }
            }
            let seconds = [0.02, 0.1, 0.25, 0.0, 1.3, -1.0, f64::NAN][(seed + step) % 7];
            update(&mut digest, &mut run, seconds);
        }
    }
    digest.value()
}

/// Rings, fades that are broken off, in every way, and more events than are told.
fn odd_ways() -> Value {
    let mut digest = Digest::new();
    let ring = r#"{"parameters": {"go": true}, "initial": "a",
      "states": [{"name": "a", "clip": "stand"}, {"name": "b", "clip": "walk"}, {"name": "c", "clip": "run", "speed": 3000}],
      "transitions": [
       {"from": "a", "to": "b", "when": [{"parameter": "go", "is": true}]},
       {"from": "b", "to": "c", "when": [{"parameter": "go", "is": true}]},
       {"from": "c", "to": "a", "when": [{"parameter": "go", "is": true}]},
       {"from": "a", "to": "a", "after": 0.5, "seconds": 0.01, "when": [{"parameter": "go", "is": false}]}]}"#;
    let mut run = run_of(ring);
    for (go, seconds) in [
        (true, 0.1),
        (true, 0.0),
        (true, 50.0),
        (false, 4.0),
        (true, 0.0),
    ] {
        run.set_flag("go", go).unwrap();
        update(&mut digest, &mut run, seconds);
    }
    // More events than are told, a state that stands still and is entered afresh, and a way back.
    let fast = r#"{"parameters": {"go": "trigger"}, "initial": "frozen",
      "states": [{"name": "frozen", "clip": "walk", "speed": 0}, {"name": "fast", "clip": "run", "speed": 3000},
       {"name": "back", "clip": "walk", "speed": -1.5, "playback": "hold"}],
      "transitions": [
       {"from": "frozen", "to": "fast", "when": [{"parameter": "go"}]},
       {"from": "fast", "to": "back", "seconds": 0.5, "after": 4500, "when": [{"parameter": "go"}]},
       {"from": "back", "to": "frozen", "seconds": 0.25, "after": 0.75}]}"#;
    let mut run = run_of(fast);
    note(&mut digest, &run);
    for (go, seconds) in [
        (false, 0.3),
        (true, 0.1),
        (false, 0.9),
        (true, 0.75),
        (false, 0.3),
        (false, 0.4),
        (false, 0.5),
        (false, 0.1),
    ] {
        if go {
            run.trigger("go").unwrap();
        }
        update(&mut digest, &mut run, seconds);
    }
    for interruption in ["never", "source", "target", "either"] {
        let text = format!(
            r#"{{"parameters": {{"x": 0, "y": 0}}, "initial": "a",
          "states": [{{"name": "a", "clip": "stand"}}, {{"name": "b", "clip": "walk"}}, {{"name": "c", "clip": "run"}},
                     {{"name": "d", "clip": "jump"}}],
          "transitions": [
           {{"from": "a", "to": "b", "seconds": 1, "when": [{{"parameter": "x", "above": 0}}], "interruption": "{interruption}"}},
           {{"from": "b", "to": "c", "seconds": 0.5, "when": [{{"parameter": "y", "above": 0}}], "interruption": "{interruption}"}},
           {{"from": "a", "to": "d", "seconds": 0.25, "in_step": true, "when": [{{"parameter": "y", "above": 1}}], "interruption": "{interruption}"}},
           {{"to": "a", "seconds": 0.5, "in_step": true, "when": [{{"parameter": "x", "below": 0}}]}}]}}"#
        );
        for [x, y] in [[1.0, 1.0], [1.0, 2.0], [1.0, 0.0], [-1.0, 2.0]] {
            let mut run = run_of(&text);
            run.set_number("x", 1.0).unwrap();
            update(&mut digest, &mut run, 0.3);
            run.set_number("x", x).unwrap();
            run.set_number("y", y).unwrap();
            for seconds in [0.2, 0.2, 0.4, 1.5] {
                update(&mut digest, &mut run, seconds);
            }
        }
        digest.json(&serde_json::from_str::<StateMachineDefinition>(&text).unwrap());
    }
    digest.json(&serde_json::from_str::<StateMachineDefinition>(GAIT).unwrap());
    digest.debug(run.state());
    digest.value()
}

fn refused() -> Value {
    let mut digest = Digest::new();
    let mut all = clips();
    let wide = animated::armature(2, &mut Random::new(132));
    let own = armature();
    all.push(Arc::new(Clip::builder("wide", &wide).build()));
    for name in ["twice", "twice", "x|end", "y|end"] {
        all.push(Arc::new(Clip::builder(name, &own).build()));
    }
    let read = |text: &str| state_machine::from_bytes(text.as_bytes(), "gait.json", &all);
    digest.debug(read(GAIT).unwrap().states().collect::<Vec<_>>());
    for (from, to) in [
        (r#""initial": "idle""#, r#""initial": "idel""#),
        (r#""initial": "idle","#, ""),
        (r#""name": "move""#, r#""name": "idle""#),
        (r#""clip": "jump""#, r#""clip": "jumq""#),
        (r#""clip": "jump""#, r#""clip": "wide""#),
        (r#""clip": "jump""#, r#""clip": "twice""#),
        (r#""clip": "jump""#, r#""clip": "end""#),
        (r#""clip": "jump""#, r#""clip": 3"#),
        (r#""clip": "jump", "#, ""),
        (r#""speed": 1.25, "#, r#""clip": "walk", "#),
        (
            r#""parameter": "speed", "clips""#,
            r#""parameter": "down", "clips""#,
        ),
        (
            r#"{"at": 1, "clip": "walk"}"#,
            r#"{"at": 0, "clip": "walk"}"#,
        ),
        (r#""at": 3"#, r#""at": 1e39"#),
        (r#""at": 3"#, r#""at": 0.5"#),
        (r#""at": 3"#, r#""to": 3"#),
        (r#""speed": -0.75"#, r#""speed": 1e999"#),
        (r#""playback": "hold""#, r#""playback": "held""#),
        (r#""from": "idle""#, r#""from": "idel""#),
        (r#""to": "move""#, r#""to": "moev""#),
        (r#""seconds": 0.3"#, r#""seconds": -0.3"#),
        (r#""after": 0.8"#, r#""after": -0.8"#),
        (r#""after_seconds": 1.1"#, r#""after_seconds": -1.1"#),
        (r#""when": [{"parameter": "stop"}]"#, r#""when": []"#),
        (r#""parameter": "stop""#, r#""parameter": "stpo""#),
        (
            r#""parameter": "stop""#,
            r#""parameter": "stop", "is": true"#,
        ),
        (r#""parameter": "stop""#, r#""parameter": "down""#),
        (
            r#""parameter": "stop""#,
            r#""parameter": "down", "above": 1"#,
        ),
        (r#""parameter": "stop""#, r#""parameter": "level""#),
        (
            r#""parameter": "stop""#,
            r#""parameter": "level", "is": true"#,
        ),
        (r#""above": 0.6, "below": 4"#, r#""above": 4, "below": 4"#),
        (r#""above": 0.6, "below": 4"#, r#""above": 1e39"#),
        (r#""easing": "cubic_in_out""#, r#""easing": "cubic""#),
        (r#""interruption": "either""#, r#""interruption": "all""#),
        (r#""level": -1"#, r#""level": "trigegr""#),
        (r#""level": -1"#, r#""speed": -1"#),
        (r#""level": -1"#, r#""level": null"#),
        (r#""bezier": [[0.3"#, r#""bezier": [[-0.3"#),
    ] {
        let text = GAIT.replacen(from, to, 1);
        assert_ne!(text, GAIT, "{from}");
        let found = read(&text);
        digest.text(found.map_or_else(|error| error.to_string(), |_| "read".to_owned()));
    }
    for text in [
        "",
        "[]",
        r#"{"initial": "a", "states": []}"#,
        r#"{"initial": "a", "states": [{"name": "a", "blend": {"parameter": "x", "clips": []}}], "parameters": {"x": 0}}"#,
        r#"{"initial": "a", "states": [{"name": "a", "clip": "walk"}], "odd": 1}"#,
    ] {
        digest.refused(read(text));
    }
    digest.refused(
        state_machine::read("no/such/machine.json", &all).map_err(|e| e.place.to_string()),
    );
    let machine = Arc::new(read(GAIT).unwrap());
    digest.refused(StateMachineRun::new(machine, wide.rest()));
    let mut run = run_of(GAIT);
    digest.refused(run.set_number("hop", 1.0));
    digest.refused(run.set_number("speed", f32::NAN));
    digest.refused(run.set_flag("speed", true));
    digest.refused(run.trigger("hpo"));
    digest.refused(run.clear_trigger("down"));
    digest.value()
}

#[test]
fn of_state_machines() {
    check_single(&[
        ("state machines, moment by moment", runs()),
        ("state machines, rings and breaks", odd_ways()),
        ("state machines: what is refused", refused()),
    ]);
}
