//! Promise: a long step of a state machine ends where many short steps end, and no step is endless.

use std::sync::Arc;

use kinopt::animation::{StateMachine, StateMachineRun};
use support::random::Random;
use support::state_machines::{hips, machine, run_of};

/// Combo of blows that follow each other at the ends of their clips, and a transition back.
const COMBO: &str = r#"{
  "parameters": {"speed": 0.0, "hit": "trigger", "dead": false},
  "initial": "idle",
  "states": [
    {"name": "idle", "clip": "stand"},
    {"name": "first", "clip": "jump", "playback": "hold"},
    {"name": "second", "clip": "run", "playback": "hold", "speed": -1.25},
    {"name": "third", "clip": "walk"},
    {"name": "down", "clip": "stand", "playback": "ping_pong"}
  ],
  "transitions": [
    {"to": "down", "seconds": 0.3, "when": [{"parameter": "dead", "is": true}]},
    {"from": "idle", "to": "first", "seconds": 0.1, "when": [{"parameter": "hit"}]},
    {"from": "first", "to": "second", "seconds": 0.15, "after": 0.8, "easing": "quadratic_in_out"},
    {"from": "second", "to": "third", "seconds": 0.7, "after": 0.9, "interruption": "target"},
    {"from": "third", "to": "idle", "seconds": 0.25, "after": 0.3}
  ]
}"#;

type EventLog = Vec<String>;

fn step(run: &mut StateMachineRun, seconds: f64, events: &mut EventLog) {
    run.update(seconds, |fired| events.push(fired.event.name.clone()))
        .unwrap();
}

fn same(a: &StateMachineRun, b: &StateMachineRun) {
    assert_eq!(a.state(), b.state());
    let fading = |run: &StateMachineRun| run.fading().unwrap_or(1.0);
    assert!((fading(a) - fading(b)).abs() < 1e-4);
    let ([ax, ay], [bx, by]) = (hips(a), hips(b));
    assert!(
        (ax - bx).abs() < 1e-4 && (ay - by).abs() < 1e-3,
        "{ax} {bx} {ay} {by}"
    );
}

#[test]
fn long_step_equals_short_steps() {
    let mut random = Random::new(5);
    for _ in 0..40 {
        let seconds = random.within(0.0, 5.0);
        let [mut long, mut short] = [run_of(COMBO), run_of(COMBO)];
        let mut events = [EventLog::new(), EventLog::new()];
        long.trigger("hit").unwrap();
        short.trigger("hit").unwrap();
        step(&mut long, seconds, &mut events[0]);
        let steps = 1 + random.below(400);
        for _ in 0..steps {
            step(&mut short, seconds / steps as f64, &mut events[1]);
        }
        // A transition that time opens at the end of a step is taken at the start of the next one.
        step(&mut long, 1e-7, &mut events[0]);
        step(&mut short, 1e-7, &mut events[1]);
        same(&long, &short);
        let [long, short] = &mut events;
        long.sort();
        short.sort();
        assert_eq!(long, short, "{seconds} s in {steps} steps");
    }
}

/// Random machine whose transitions all take time, so that no two of them coincide except by chance.
fn any_machine(random: &mut Random) -> String {
    let mut pick = |words: &[&str]| words[random.below(words.len())].to_owned();
    let names = ["a", "b", "c", "d"];
    let states: Vec<String> = names
        .iter()
        .map(|name| {
            let motion = pick(&[
                r#""clip": "stand""#,
                r#""clip": "walk""#,
                r#""clip": "jump""#,
                r#""blend": {"parameter": "x", "clips": [{"at": 0, "clip": "walk"}, {"at": 1, "clip": "run"}]}"#,
            ]);
            let playback = pick(&["loop", "hold", "ping_pong"]);
            let speed = pick(&["1.0", "-0.8", "1.3"]);
            format!(r#"{{"name": "{name}", {motion}, "playback": "{playback}", "speed": {speed}}}"#)
        })
        .collect();
    let transitions: Vec<String> = (0..8u32)
        .map(|k| {
            let (from, to) = (names[k as usize % 4], pick(&names));
            let number: u32 = pick(&["0", "1", "2", "3", "4", "5", "6"]).parse().unwrap();
            let after = pick(&["after", "after_seconds"]);
            // All different, so that no two times are equal up to rounding.
            let share = 0.2 + 0.0917 * f64::from(number) + 0.003 * f64::from(k);
            let seconds = pick(&["0.0", "0.17", "0.61"]);
            let interruption = pick(&["never", "source", "target", "either"]);
            let in_step = pick(&["true", "false"]);
            format!(
                r#"{{"from": "{from}", "to": "{to}", "{after}": {share}, "seconds": {seconds}, "interruption": "{interruption}", "in_step": {in_step}}}"#
            )
        })
        .collect();
    format!(
        r#"{{"parameters": {{"x": 0.37}}, "initial": "a", "states": [{}], "transitions": [{}]}}"#,
        states.join(", "),
        transitions.join(", ")
    )
}

#[test]
fn random_machines_are_step_invariant() {
    let mut random = Random::new(6);
    for _ in 0..300 {
        let text = any_machine(&mut random);
        let seconds = random.within(0.0, 3.0);
        let [mut long, mut short] = [run_of(&text), run_of(&text)];
        step(&mut long, seconds, &mut EventLog::new());
        let steps = 1 + random.below(100);
        for _ in 0..steps {
            step(&mut short, seconds / steps as f64, &mut EventLog::new());
        }
        step(&mut long, 1e-7, &mut EventLog::new());
        step(&mut short, 1e-7, &mut EventLog::new());
        let at = (long.state(), long.leaving(), short.state(), short.leaving());
        assert_eq!(
            (at.0, at.1),
            (at.2, at.3),
            "{seconds} s in {steps} steps: {text}"
        );
        assert!((long.seconds() - short.seconds()).abs() < 1e-6, "{text}");
        assert!((long.played() - short.played()).abs() < 1e-6, "{text}");
        let ([ax, ay], [bx, by]) = (hips(&long), hips(&short));
        // At the seam of a loop, rounding decides between end and start.
        let closing = |x: f32| (x - x.round()).abs() < 1e-3;
        assert!((ay - by).abs() < 1e-3, "{ay} {by}: {text}");
        assert!((ax - bx).abs() < 1e-3 || closing(ax), "{ax} {bx}: {text}");
    }
}

#[test]
fn step_passes_through_a_chain_of_states() {
    // 0.8 of the half second of the first blow, 0.9 of the 0.8 s of the second, then a fade of 0.7 s. The transition of
    // the third (0.6 s) may interrupt it: idle since 1.72 s, completely faded by 1.97 s.
    let mut run = run_of(COMBO);
    run.trigger("hit").unwrap();
    step(&mut run, 2.22, &mut EventLog::new());
    assert_eq!((run.state(), run.fading()), ("idle", None));
    let [x, y] = hips(&run);
    assert!((x - 0.5).abs() < 1e-5 && y == 0.0, "{x} {y}");
    // The trigger was used once: nothing happens again.
    step(&mut run, 10.0, &mut EventLog::new());
    assert_eq!(run.state(), "idle");
}

#[test]
fn rest_of_a_step_is_spent_in_the_new_state() {
    let mut run = run_of(COMBO);
    run.set_flag("dead", true).unwrap();
    // After the fade of 0.3 s the pose is that of the new state.
    step(&mut run, 0.75, &mut EventLog::new());
    assert_eq!((run.state(), run.fading()), ("down", None));
    assert_eq!(hips(&run), [0.75, 0.0]);
}

#[test]
fn met_conditions_pass_several_states_at_once() {
    let text = r#"{
      "parameters": {"speed": 3.0},
      "initial": "idle",
      "states": [
        {"name": "idle", "clip": "stand"}, {"name": "walk", "clip": "walk"}, {"name": "run", "clip": "run"}
      ],
      "transitions": [
        {"from": "idle", "to": "walk", "when": [{"parameter": "speed", "above": 0.5}]},
        {"from": "walk", "to": "run", "when": [{"parameter": "speed", "above": 2.0}]}
      ]
    }"#;
    let mut run = run_of(text);
    step(&mut run, 0.25, &mut EventLog::new());
    assert_eq!((run.state(), hips(&run)), ("run", [0.25, 20.0]));
}

#[test]
fn cycle_of_transitions_ends() {
    let ring = |mode: &str| {
        format!(
            r#"{{
          "parameters": {{"on": true}},
          "initial": "a",
          "states": [{{"name": "a", "clip": "stand"}}, {{"name": "b", "clip": "walk"}}, {{"name": "c", "clip": "jump"}}],
          "transitions": [{{"from": "a", "to": "b"{mode}}}, {{"from": "b", "to": "c"{mode}}}, {{"from": "c", "to": "a"{mode}}}]
        }}"#
        )
    };
    // Without durations: one round, and the time is spent at the start.
    let mut run = run_of(&ring(""));
    step(&mut run, 0.25, &mut EventLog::new());
    assert_eq!((run.state(), hips(&run)), ("a", [0.25, 0.0]));
    // With durations: 1 + 2 + 0.5 s a round, so after 9 s it is 2 s into the third round.
    let mut run = run_of(&ring(r#", "after": 1.0"#));
    step(&mut run, 9.0, &mut EventLog::new());
    let [x, y] = hips(&run);
    assert_eq!((run.state(), y), ("b", 10.0));
    assert!((x - 1.0).abs() < 1e-6, "{x}");
    // Beyond the maximum number of transitions the last state entered keeps the remaining time.
    let mut run = run_of(&ring(r#", "after": 1.0"#));
    step(&mut run, 1000.0, &mut EventLog::new());
    let max_transitions = StateMachineRun::MOST_TRANSITIONS;
    assert_eq!(run.state(), ["a", "b", "c"][max_transitions % 3]);
}

#[test]
fn invalid_steps_take_no_time() {
    let machine: Arc<StateMachine> = Arc::new(machine(COMBO).unwrap());
    for seconds in [0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let mut run = run_of(COMBO);
        step(&mut run, 0.25, &mut EventLog::new());
        let before = hips(&run);
        step(&mut run, seconds, &mut EventLog::new());
        assert_eq!(hips(&run), before);
        assert_eq!(machine.states().next(), Some(run.state()));
    }
}

/// A transition that requires a number of cycles and a time waits for both.
#[test]
fn longer_of_two_waits_applies() {
    for (after, seconds, end_time) in [(2.0, 1.0, 4.0), (0.5, 3.0, 3.0)] {
        let mut run = run_of(&format!(
            r#"{{"initial": "a", "states": [{{"name": "a", "clip": "walk"}}, {{"name": "b", "clip": "run"}}],
            "transitions": [{{"from": "a", "to": "b", "after": {after}, "after_seconds": {seconds}}}]}}"#
        ));
        run.update(end_time - 0.01, |_| {}).unwrap();
        assert_eq!(run.state(), "a");
        run.update(0.02, |_| {}).unwrap();
        assert_eq!(run.state(), "b");
    }
}
