//! Promise: a state that blends clips by a number shows their weighted mean and keeps them in phase.

use std::sync::Arc;

use kinopt::animation::{
    Clip, MotionDefinition, StateMachine, StateMachineDefinition, StateMachineRun,
};
use support::fault_tables::faults;
use support::random::Random;
use support::state_machines::{armature, clips, hips, machine, run_of};

/// Standing (1 s, height 0), walking (2 s, height 10) and running (1 s, height 20).
const MACHINE: &str = r#"{
  "parameters": {"speed": 2.0, "on": true},
  "initial": "move",
  "states": [
    {"name": "move", "blend": {"parameter": "speed", "clips": [
      {"at": -1.0, "clip": "stand"}, {"at": 1.0, "clip": "walk"}, {"at": 3.0, "clip": "run"}
    ]}},
    {"name": "jump", "clip": "jump"},
    {"name": "back", "speed": -1.0, "blend": {"parameter": "speed", "clips": [
      {"at": 1.0, "clip": "walk"}, {"at": 3.0, "clip": "run"}
    ]}}
  ],
  "transitions": [{"from": "move", "to": "jump", "seconds": 0.5, "after": 1.0}]
}"#;

fn moving(speed: f32) -> StateMachineRun {
    let mut run = run_of(&MACHINE.replace(r#""after": 1.0"#, r#""after": 1e9"#));
    run.set_number("speed", speed).unwrap();
    run
}

fn step(run: &mut StateMachineRun, seconds: f64) -> [f32; 2] {
    run.update(seconds, |_| {}).unwrap();
    hips(run)
}

fn near([ax, ay]: [f32; 2], [bx, by]: [f32; 2]) {
    assert!(
        (ax - bx).abs() < 1e-5 && (ay - by).abs() < 1e-4,
        "{ax} {ay} for {bx} {by}"
    );
}

/// Expected hips of the state at a phase: x of a clip runs from 0 to its duration.
fn expected(speed: f32, phase: f32) -> [f32; 2] {
    let [low, high, share] = match speed {
        s if s <= -1.0 => [0.0; 3],
        s if s < 1.0 => [0.0, 1.0, (s + 1.0) / 2.0],
        s if s < 3.0 => [1.0, 2.0, (s - 1.0) / 2.0],
        _ => [2.0, 2.0, 0.0],
    };
    let (length, height) = ([1.0, 2.0, 1.0], [0.0, 10.0, 20.0]);
    let mix =
        |values: [f32; 3]| values[low as usize] * (1.0 - share) + values[high as usize] * share;
    [phase * mix(length), mix(height)]
}

#[test]
fn clips_between_numbers_blend_at_one_phase() {
    for speed in [-5.0, -1.0, -0.25, 0.5, 1.0, 1.5, 2.0, 2.75, 3.0, 9.0] {
        // One cycle takes the mean of the durations, which is the final x.
        let [length, _] = expected(speed, 1.0);
        for phase in [0.2, 0.7, 0.95] {
            let mut run = moving(speed);
            near(
                step(&mut run, f64::from(phase * length)),
                expected(speed, phase),
            );
            assert!((run.played() - f64::from(phase)).abs() < 1e-6);
            // Another full cycle gives the same pose.
            near(step(&mut run, f64::from(length)), expected(speed, phase));
        }
    }
}

#[test]
fn phase_continues_as_the_number_changes() {
    let mut random = Random::new(12);
    let (mut run, mut phase, mut speed) = (moving(0.0), 0.0, 0.0f32);
    for _ in 0..400 {
        speed = (speed + random.within(-0.3, 0.3) as f32).clamp(-2.0, 4.0);
        run.set_number("speed", speed).unwrap();
        let [length, _] = expected(speed, 1.0);
        phase += 0.013 / f64::from(length);
        let shown = step(&mut run, 0.013);
        let fraction = phase.fract();
        // At the seam of the loop, rounding decides between end and start.
        if (0.001..0.999).contains(&fraction) {
            near(shown, expected(speed, fraction as f32));
        }
    }
}

#[test]
fn playing_clips_and_event_weights_are_reported() {
    let mut run = moving(1.5);
    let playing: Vec<(&str, f32)> = run.playing().collect();
    assert_eq!(playing, [("walk", 0.75), ("run", 0.25)]);
    let mut events = Vec::new();
    run.update(1.0, |fired| {
        assert_eq!(fired.state, "move");
        events.push((
            fired.clip.to_owned(),
            fired.event.name.clone(),
            fired.weight,
        ));
    })
    .unwrap();
    let expected = [("walk", "walk half", 0.75), ("run", "run half", 0.25)];
    assert_eq!(
        events,
        expected.map(|(c, e, w)| (c.to_owned(), e.to_owned(), w))
    );
    run.set_number("speed", 3.0).unwrap();
    assert_eq!(run.playing().collect::<Vec<_>>(), [("run", 1.0)]);
}

#[test]
fn exit_time_uses_the_mean_clip_length() {
    // Halfway between walk and run, one cycle takes 1.5 s.
    let mut run = run_of(MACHINE);
    let [_, y] = step(&mut run, 1.4999);
    assert!(run.state() == "move" && (y - 15.0).abs() < 1e-4);
    // A quarter of a second into a fade of half a second, from 15 to 30.
    let [_, y] = step(&mut run, 0.2501);
    assert!(run.state() == "jump" && (y - 22.5).abs() < 1e-3, "{y}");
    // From one blend to another.
    let two = MACHINE.replace(r#""to": "jump""#, r#""to": "back""#);
    let mut run = run_of(&two);
    let [x, y] = step(&mut run, 1.75);
    // A sixth of the cycle forwards, five sixths backwards.
    assert!(
        (x - 0.5 * 1.5).abs() < 1e-4 && (y - 15.0).abs() < 1e-4,
        "{x} {y}"
    );
}

#[test]
fn synchronised_state_starts_at_the_same_phase() {
    let text = |playback: &str, speed: f64| {
        format!(
            r#"{{
          "parameters": {{"go": "trigger"}},
          "initial": "walk",
          "states": [
            {{"name": "walk", "clip": "walk", "playback": "{playback}"}},
            {{"name": "run", "clip": "run", "speed": {speed:?}}}
          ],
          "transitions": [
            {{"from": "walk", "to": "run", "in_step": true, "seconds": 0.25, "when": [{{"parameter": "go"}}]}},
            {{"from": "run", "to": "walk", "after": 1.0}}
          ]
        }}"#
        )
    };
    // After 3.25 s a walk of 2 s is 1.25 s into its second cycle. In ping-pong playback it is 0.75 s before its start,
    // and held it is at its end.
    for (playback, position) in [("loop", 0.625), ("ping_pong", 0.375), ("hold", 1.0)] {
        for speed in [1.0, -1.0] {
            let mut run = run_of(&text(playback, speed));
            step(&mut run, 3.25);
            run.trigger("go").unwrap();
            step(&mut run, 0.0);
            assert_eq!(run.state(), "run");
            let [x, y] = step(&mut run, 0.25);
            // The clip starts again at the ends of its loop.
            let shown = position + 0.25 * speed;
            if (0.0..1.0).contains(&shown) {
                assert!((x - shown as f32).abs() < 1e-6 && y == 20.0, "{x} {y}");
            }
            // Its own transition is one cycle later.
            assert_eq!(run.played(), 0.25);
            step(&mut run, 0.7);
            assert_eq!(run.state(), "run");
            step(&mut run, 0.1);
            assert_eq!(run.state(), "walk");
        }
    }
}

/// A fade from walking to a jump is interrupted by walking's own transition to a run. The run keeps phase with the walk
/// that it follows, not with the jump.
#[test]
fn interrupted_fade_keeps_phase_with_its_source() {
    for (interruption, from, expected) in [
        ("source", "\"from\": \"walk\", ", 0.75),
        ("either", "\"from\": \"walk\", ", 0.75),
        ("target", "\"from\": \"jump\", ", 0.5),
        ("either", "\"from\": \"jump\", ", 0.5),
        // Without a state of its own, it follows the one that is checked first.
        ("source", "", 0.75),
        ("target", "", 0.5),
        ("either", "", 0.75),
    ] {
        let mut run = run_of(&format!(
            r#"{{
              "parameters": {{"leap": "trigger", "go": "trigger"}},
              "initial": "walk",
              "states": [{{"name": "walk", "clip": "walk"}}, {{"name": "jump", "clip": "jump"}},
                         {{"name": "run", "clip": "run"}}],
              "transitions": [
                {{"from": "walk", "to": "jump", "seconds": 1, "when": [{{"parameter": "leap"}}],
                  "interruption": "{interruption}"}},
                {{{from}"to": "run", "in_step": true, "when": [{{"parameter": "go"}}]}}
              ]
            }}"#
        ));
        // The walk of 2 s is at 1.25 s, then at 1.5 s; the jump of half a second is at 0.25 s.
        step(&mut run, 1.25);
        run.trigger("leap").unwrap();
        step(&mut run, 0.25);
        run.trigger("go").unwrap();
        let [x, y] = step(&mut run, 0.0);
        assert_eq!(run.state(), "run");
        assert!(
            (x - expected).abs() < 1e-6 && y == 20.0,
            "{interruption}, {from}: {x} {y}"
        );
    }
}

#[test]
fn poses_do_not_count_in_the_mean_length() {
    let armature = armature();
    let mut all = clips();
    all.push(Arc::new(Clip::builder("still", &armature).build()));
    let text = MACHINE.replace(r#""clip": "stand""#, r#""clip": "still""#);
    let definition: StateMachineDefinition = serde_json::from_str(&text).unwrap();
    let machine = Arc::new(StateMachine::new(&definition, &all).unwrap());
    let mut run = StateMachineRun::new(machine, armature.rest()).unwrap();
    // A tenth of walking: 0.4 s are a fifth of the walk's two seconds.
    run.set_number("speed", -0.8).unwrap();
    near(step(&mut run, 0.4), [0.1 * 0.4, 1.0]);
    run.set_number("speed", -3.0).unwrap();
    near(step(&mut run, 0.4), [0.0, 0.0]);
}

#[test]
fn blends_round_trip_through_json() {
    let definition: StateMachineDefinition = serde_json::from_str(MACHINE).unwrap();
    let text = serde_json::to_string(&definition).unwrap();
    let again: StateMachineDefinition = serde_json::from_str(&text).unwrap();
    assert_eq!(again, definition);
    assert!(
        matches!(&again.states[0].motion, MotionDefinition::Blend(blend) if blend.clips.len() == 3)
    );
}

/// Faults of the machine.
const FAULTS: &str = r#"
"clip": "run" => "clip": "sprint" | states[0].blend.clips[2].clip | `sprint` | stand | jump
"parameter": "speed" => "parameter": "sped" | states[0].blend.parameter | number | `sped` | speed
"parameter": "speed" => "parameter": "on" | states[0].blend.parameter | number | `on` | speed
"at": 3.0 => "at": 1.0 | states[0].blend.clips[2].at | above 1
"at": 3.0 => "place": 3.0 | states[0].blend.clips[2] | place | at
"name": "move", => "name": "move", "clip": "run", | states[0] | `move` | both
"clip": "jump"} => "speed": 1.0} | states[1] | `jump` | neither
"#;

#[test]
fn invalid_blends_are_rejected_with_their_path() {
    for fault in faults(FAULTS) {
        assert!(MACHINE.contains(&fault.from), "{}", fault.from);
        fault.check(machine(&MACHINE.replacen(&fault.from, &fault.to, 1)));
    }
    let mut definition: StateMachineDefinition = serde_json::from_str(MACHINE).unwrap();
    let path_of = |definition: &StateMachineDefinition| {
        StateMachine::new(definition, &clips()).unwrap_err().path
    };
    if let MotionDefinition::Blend(blend) = &mut definition.states[2].motion {
        blend.clips[1].at = f32::NAN;
    }
    assert_eq!(path_of(&definition), "states[2].blend.clips[1].at");
    if let MotionDefinition::Blend(blend) = &mut definition.states[2].motion {
        blend.clips.clear();
    }
    assert_eq!(path_of(&definition), "states[2].blend.clips");
}
