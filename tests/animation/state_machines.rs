//! Promise: a state machine acts according to its data. The error for invalid data names the place and the valid names.

use std::sync::Arc;

use kinopt::animation::{Armature, Clip, StateMachineRun};
use kinopt::io::state_machine;
use support::fault_tables::ExpectedError;
use support::fault_tables::faults;
use support::state_machines::{hips, machine, run_of};

const MACHINE: &str = r#"{
  "parameters": {"speed": 0.0, "grounded": true, "jump": "trigger"},
  "initial": "idle",
  "states": [
    {"name": "idle", "clip": "stand"},
    {"name": "walk", "clip": "walk"},
    {"name": "run", "clip": "run", "speed": 2.0},
    {"name": "jump", "clip": "jump", "playback": "hold"}
  ],
  "transitions": [
    {"to": "jump", "seconds": 0.25, "when": [{"parameter": "jump"}, {"parameter": "grounded", "is": true}]},
    {"from": "idle", "to": "walk", "seconds": 0.5, "when": [{"parameter": "speed", "above": 0.5}]},
    {"from": "walk", "to": "idle", "seconds": 0.5, "when": [{"parameter": "speed", "below": 0.5}]},
    {"from": "walk", "to": "run", "seconds": 1.0, "when": [{"parameter": "speed", "above": 2.0}],
     "interruption": "either", "easing": "cubic_in_out"},
    {"from": "run", "to": "walk", "when": [{"parameter": "speed", "above": 0.5, "below": 2.0}]},
    {"from": "jump", "to": "idle", "seconds": 0.5, "after": 1.0}
  ]
}"#;

fn run() -> StateMachineRun {
    run_of(MACHINE)
}

fn step(run: &mut StateMachineRun, seconds: f64) -> [f32; 2] {
    run.update(seconds, |_| {}).unwrap();
    hips(run)
}

#[test]
fn machine_walks_runs_and_stands() {
    let mut run = run();
    assert_eq!((run.state(), hips(&run)), ("idle", [0.0, 0.0]));
    assert_eq!(step(&mut run, 0.25), [0.25, 0.0]);
    run.set_number("speed", 1.0).unwrap();
    // Halfway through the fade: half of x 0.5 standing and 0.25 walking.
    assert_eq!(step(&mut run, 0.25), [0.375, 5.0]);
    assert_eq!((run.state(), run.fading()), ("walk", Some(0.5)));
    assert_eq!(step(&mut run, 0.25), [0.5, 10.0]);
    assert_eq!(run.fading(), None);
    run.set_number("speed", 3.0).unwrap();
    // The eased weight at a quarter is 4/64.
    let [_, y] = step(&mut run, 0.25);
    assert!((y - 10.625).abs() < 1e-5);
    // The running clip is played at twice its speed.
    step(&mut run, 0.5);
    let [x, y] = step(&mut run, 0.375);
    assert_eq!((run.state(), x, y), ("run", 0.25, 20.0));
    // Without seconds the change is immediate.
    run.set_number("speed", 1.0).unwrap();
    assert_eq!((step(&mut run, 0.0), run.fading()), ([0.0, 10.0], None));
}

/// An easing of a fade may be given by two handles; here they give t², which is ¼ halfway.
#[test]
fn fade_follows_its_easing() {
    let drawn = r#""easing": {"bezier": [[0.33333333, 0], [0.66666667, 0.33333333]]}"#;
    let mut run = run_of(&MACHINE.replace(r#""easing": "cubic_in_out""#, drawn));
    run.set_number("speed", 1.0).unwrap();
    step(&mut run, 0.5);
    run.set_number("speed", 3.0).unwrap();
    let [_, y] = step(&mut run, 0.5);
    assert_eq!(run.state(), "run");
    assert!((y - 12.5).abs() < 1e-4, "{y}");
}

#[test]
fn trigger_fires_once_and_clip_must_end() {
    let mut run = run();
    run.set_flag("grounded", false).unwrap();
    run.trigger("jump").unwrap();
    step(&mut run, 0.1);
    assert_eq!(run.state(), "idle");
    run.set_flag("grounded", true).unwrap();
    step(&mut run, 0.3);
    assert_eq!(run.state(), "jump");
    // Its own transition waits until the clip of half a second has played once.
    step(&mut run, 0.1);
    assert_eq!(run.state(), "jump");
    step(&mut run, 0.2);
    step(&mut run, 0.1);
    assert_eq!(run.state(), "idle");
    step(&mut run, 5.0);
    assert_eq!(run.state(), "idle");
}

#[test]
fn fade_is_interrupted_only_if_allowed() {
    // From standing to walking nothing interrupts: the jump starts at the end of the fade.
    let mut first = run();
    first.set_number("speed", 1.0).unwrap();
    step(&mut first, 0.1);
    first.trigger("jump").unwrap();
    step(&mut first, 0.1);
    assert_eq!(first.state(), "walk");
    step(&mut first, 0.4);
    step(&mut first, 0.1);
    assert_eq!(first.state(), "jump");

    // From walking to running anything interrupts, and the next fade starts from the displayed pose.
    let mut second = run();
    second.set_number("speed", 1.0).unwrap();
    step(&mut second, 0.5);
    second.set_number("speed", 3.0).unwrap();
    let [_, shown] = step(&mut second, 0.5);
    assert!((shown - 15.0).abs() < 1e-4);
    second.trigger("jump").unwrap();
    let [_, y] = step(&mut second, 0.0);
    assert_eq!(second.state(), "jump");
    assert!((y - shown).abs() < 1e-4, "no jump in the pose: {y}");
    let [_, y] = step(&mut second, 0.125);
    assert!((y - (shown + 30.0) / 2.0).abs() < 1e-3, "{y}");
}

/// Halfway from standing to walking, both states have a transition. The fade decides which of them is allowed.
#[test]
fn fade_is_interrupted_by_the_allowed_states() {
    let after = |interruption: &str, trigger: &str| {
        let mut run = run_of(&format!(
            r#"{{
              "parameters": {{"go": "trigger", "of source": "trigger", "of target": "trigger"}},
              "initial": "stand",
              "states": [{{"name": "stand", "clip": "stand"}}, {{"name": "walk", "clip": "walk"}},
                         {{"name": "run", "clip": "run"}}, {{"name": "jump", "clip": "jump"}}],
              "transitions": [
                {{"from": "stand", "to": "walk", "seconds": 1, "when": [{{"parameter": "go"}}],
                  "interruption": "{interruption}"}},
                {{"from": "stand", "to": "run", "when": [{{"parameter": "of source"}}]}},
                {{"from": "walk", "to": "jump", "when": [{{"parameter": "of target"}}]}}
              ]
            }}"#
        ));
        run.trigger("go").unwrap();
        step(&mut run, 0.5);
        run.trigger(trigger).unwrap();
        step(&mut run, 0.0);
        run.state().to_owned()
    };
    for (interruption, states) in [
        ("never", ["walk", "walk"]),
        ("source", ["run", "walk"]),
        ("target", ["walk", "jump"]),
        ("either", ["run", "jump"]),
    ] {
        let entered = ["of source", "of target"].map(|trigger| after(interruption, trigger));
        assert_eq!(entered, states, "{interruption}");
    }
}

/// During a fade, an event has the weight of its state at that time, however long the step is.
#[test]
fn events_have_their_states_weight() {
    for steps in [1_u8, 7, 50] {
        let mut run = run_of(
            r#"{
              "parameters": {"go": "trigger"},
              "initial": "stand",
              "states": [{"name": "stand", "clip": "stand"}, {"name": "jump", "clip": "jump"}],
              "transitions": [{"from": "stand", "to": "jump", "seconds": 1, "when": [{"parameter": "go"}]}]
            }"#,
        );
        run.trigger("go").unwrap();
        let mut events = Vec::new();
        for _ in 0..steps {
            run.update(0.95 / f64::from(steps), |fired| {
                events.push((fired.event.name.clone(), fired.weight));
            })
            .unwrap();
        }
        events.sort_by(|a, b| (&a.0, a.1).partial_cmp(&(&b.0, b.1)).unwrap());
        let expected = [
            ("jump half", 0.25),
            ("jump half", 0.75),
            ("stand half", 0.5),
        ];
        assert_eq!(events.len(), expected.len(), "{events:?}");
        for ((name, weight), expected) in events.iter().zip(expected) {
            assert_eq!(name, expected.0);
            assert!((weight - expected.1).abs() < 1e-6, "{events:?}");
        }
    }
}

#[test]
fn events_come_from_the_states_clip() {
    let mut run = run();
    let mut events = Vec::new();
    for _ in 0..30 {
        run.update(0.1, |fired| events.push(fired.event.name.clone()))
            .unwrap();
    }
    assert_eq!(events, ["stand half"; 3]);
}

#[test]
fn unknown_parameters_are_named() {
    let mut run = run();
    let error = run.set_number("sped", 1.0).unwrap_err().to_string();
    assert!(
        error.contains("`sped`") && error.contains("speed"),
        "{error}"
    );
    assert!(!error.contains("grounded"), "only numbers: {error}");
    run.set_flag("speed", true).says("grounded");
    run.trigger("grounded").says("jump");
    let error = run.set_number("speed", f32::NAN).unwrap_err().to_string();
    assert!(error.contains("`speed`"), "{error}");
}

/// Faults of the machine.
const FAULTS: &str = r#"
"initial": "idle" => "initial": "idel" | machine.json | initial | `idel` | idle | walk | run | jump
"from": "walk", "to": "idle" => "from": "walk", "to": "sit" | machine.json | transitions[2].to | `sit` | run
"from": "run" => "from": "rn" | machine.json | transitions[4].from | `rn`
"clip": "run" => "clip": "sprint" | machine.json | states[2].clip | `sprint` | stand | jump
{"name": "run" => {"name": "walk" | machine.json | states[2].name | `walk` | twice
"parameter": "speed" => "parameter": "sped" | machine.json | transitions[1].when[0].parameter | speed | grounded
"easing": "cubic_in_out" => "easing": {"bezier": [[0.5, 0], [1.5, 1]]} | machine.json | transitions[3].easing | (1.5, 1) | within [0, 1]
"seconds": 0.25 => "seconds": -0.25 | machine.json | transitions[0].seconds | -0.25
"after": 1.0 => "after": -1.0 | machine.json | transitions[5].after
"after": 1.0 => "later": 1.0 | machine.json | transitions[5] | later | after
"is": true => "above": 1.0 | machine.json | transitions[0].when[1] | `grounded` | flag | `is`
"above": 2.0 => "is": true | machine.json | transitions[3].when[0] | number
"above": 0.5, "below": 2.0 => "above": 2.0, "below": 0.5 | machine.json | transitions[4].when[0] | above 2 | below 0.5
"above": 0.5, "below": 2.0 => "above": 2.0, "below": 2.0 | machine.json | transitions[4].when[0] | above 2 | below 2
{"parameter": "jump"} => {"parameter": "jump", "above": 0} | machine.json | trigger
"playback": "hold" => "playback": "bounce" | machine.json | states[3].playback | ping_pong
"interruption": "either" => "interruption": "maybe" | machine.json | transitions[3] | never
"easing": "cubic_in_out" => "easing": "elastic" | machine.json | quadratic_in
"jump": "trigger" => "jump": "event" | machine.json | parameters | `true` or `false` | "trigger"
"grounded": true => "grounded": true, "speed": 1.0 | machine.json | parameters | `speed` is given twice
"speed": 2.0 => "speed": 1e999 | machine.json | machine.json
"when": [{"parameter": "jump"}, {"parameter": "grounded", "is": true}] => "when": [] | machine.json | transitions[0].when
"#;

#[test]
fn invalid_data_is_rejected_with_its_path() {
    for fault in faults(FAULTS) {
        assert!(MACHINE.contains(&fault.from), "{}", fault.from);
        fault.check(machine(&MACHINE.replacen(&fault.from, &fault.to, 1)));
    }
    // An ambiguous clip name is an error. A clip given twice counts once, and other clips have no effect.
    let armature = Armature::new(Vec::new(), Vec::new()).unwrap();
    let clip = |name: &str| Arc::new(Clip::builder(name, &armature).build());
    let named = |clips: &[Arc<Clip>]| {
        let data = br#"{"initial": "idle", "states": [{"name": "idle", "clip": "stand"}]}"#;
        state_machine::from_bytes(data, "machine.json", clips).map(|_| ())
    };
    let (stand, walk) = (clip("stand"), clip("walk"));
    named(&[stand.clone(), clip("stand")]).says("states[0].clip | 2 clips are named `stand`");
    assert!(named(&[stand.clone(), stand, walk, clip("walk")]).is_ok());
    machine(r#"{"initial": "idle", "states": []}"#).says("no states");
    assert!(machine("{").is_err() && machine("[]").is_err());
}
