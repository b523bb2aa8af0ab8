//! Promise: a state machine reports its state and parameters, and its data survives a round trip.

use std::sync::Arc;

use kinopt::animation::{
    Clip, ParameterValue, StateMachine, StateMachineDefinition, StateMachineRun,
};
use support::fault_tables::ExpectedError;
use support::state_machines::{armature, clips, hips, machine, run_of};

const MACHINE: &str = r#"{
  "parameters": {"go": "trigger", "stop": "trigger"},
  "initial": "idle",
  "states": [
    {"name": "idle", "clip": "stand"},
    {"name": "walk", "clip": "walk"},
    {"name": "pause", "clip": "stand"}
  ],
  "transitions": [
    {"from": "idle", "to": "walk", "seconds": 1.0, "when": [{"parameter": "go"}], "interruption": "target"},
    {"from": "walk", "to": "pause", "seconds": 0.5, "when": [{"parameter": "stop"}]},
    {"from": "pause", "to": "idle", "after_seconds": 2.5, "after": 1.0}
  ]
}"#;

#[test]
fn current_state_and_fade_are_reported() {
    let mut run = run_of(MACHINE);
    run.update(0.25, |_| {}).unwrap();
    assert_eq!((run.state(), run.leaving()), ("idle", None));
    assert_eq!((run.seconds(), run.played()), (0.25, 0.25));
    run.trigger("go").unwrap();
    run.update(0.5, |_| {}).unwrap();
    // Half a second of two is a quarter.
    assert_eq!((run.state(), run.leaving()), ("walk", Some("idle")));
    assert_eq!(
        (run.seconds(), run.played(), run.fading()),
        (0.5, 0.25, Some(0.5))
    );
    // An interrupted fade starts from a pose that belongs to no state.
    run.trigger("stop").unwrap();
    run.update(0.25, |_| {}).unwrap();
    assert_eq!((run.state(), run.leaving()), ("pause", None));
    assert_eq!(run.fading(), Some(0.5));
}

#[test]
fn parameters_are_reported() {
    let text = MACHINE.replace(
        r#""go": "trigger""#,
        r#""go": "trigger", "on": true, "speed": 0.5"#,
    );
    let mut run = run_of(&text);
    run.set_number("speed", 2.0).unwrap();
    run.trigger("go").unwrap();
    use ParameterValue::{Flag, Number, Trigger};
    let values = |run: &StateMachineRun| -> Vec<(String, ParameterValue)> {
        let all = run.parameters();
        all.map(|(name, value)| (name.to_owned(), value)).collect()
    };
    let expected = |go: bool| {
        [
            ("go", Trigger(go)),
            ("on", Flag(true)),
            ("speed", Number(2.0)),
            ("stop", Trigger(false)),
        ]
        .map(|(name, value)| (name.to_owned(), value))
    };
    assert_eq!(values(&run), expected(true));
    run.update(0.1, |_| {}).unwrap();
    assert_eq!(values(&run), expected(false));
}

/// A looping clip of 80 ns has 200 000 events in a frame of 16 ms.
#[test]
fn bounded_events_are_reported() {
    let armature = armature();
    let mut builder = Clip::builder("buzz", &armature);
    builder.span(0.0, 8e-8).unwrap();
    builder.event(4e-8, "tick").unwrap();
    let buzz = Arc::new(builder.build());
    let definition =
        r#"{"initial": "buzz", "states": [{"name": "buzz", "clip": "buzz"}], "transitions": []}"#;
    let definition: StateMachineDefinition = serde_json::from_str(definition).unwrap();
    let machine = Arc::new(StateMachine::new(&definition, &[buzz]).unwrap());
    let mut run = StateMachineRun::new(machine, armature.rest()).unwrap();
    let count_events = |run: &mut StateMachineRun, seconds: f64| {
        let mut count = 0;
        run.update(seconds, |_| count += 1).unwrap();
        (count, run.events_left_out())
    };
    assert_eq!(count_events(&mut run, 4e-8 * 9.5), (5, false));
    let max_events = StateMachineRun::MOST_EVENTS;
    assert_eq!(count_events(&mut run, 0.016), (max_events, true));
    assert_eq!(count_events(&mut run, 1e9), (max_events, true));
    assert_eq!(count_events(&mut run, 0.0), (0, false));
}

/// Also if the state that passed too many events was left within the update.
#[test]
fn dropped_events_are_reported_after_a_transition() {
    let armature = armature();
    let clip = |name: &str, seconds: f32| {
        let mut builder = Clip::builder(name, &armature);
        builder.span(0.0, seconds).unwrap();
        builder.event(0.5 * seconds, "tick").unwrap();
        Arc::new(builder.build())
    };
    let definition = r#"{"initial": "buzz",
        "states": [{"name": "buzz", "clip": "buzz"}, {"name": "calm", "clip": "calm"}],
        "transitions": [{"from": "buzz", "to": "calm", "after_seconds": 0.5}]}"#;
    let definition: StateMachineDefinition = serde_json::from_str(definition).unwrap();
    let clips = [clip("buzz", 8e-8), clip("calm", 10.0)];
    let machine = Arc::new(StateMachine::new(&definition, &clips).unwrap());
    let mut run = StateMachineRun::new(machine, armature.rest()).unwrap();
    run.update(1.0, |_| {}).unwrap();
    assert_eq!((run.state(), run.events_left_out()), ("calm", true));
}

#[test]
fn event_weight_is_that_of_its_state() {
    // The event of `idle` is half a second after the start: 0.3 s into the fade, with a weight of 0.3.
    let mut run = run_of(MACHINE);
    run.update(0.2, |_| {}).unwrap();
    run.trigger("go").unwrap();
    let mut events = Vec::new();
    run.update(0.9, |fired| {
        events.push((fired.state.to_owned(), fired.weight))
    })
    .unwrap();
    assert_eq!(events.len(), 1);
    assert!(
        events[0].0 == "idle" && (events[0].1 - 0.7).abs() < 1e-5,
        "{events:?}"
    );
}

#[test]
fn time_never_decreases() {
    let mut run = run_of(MACHINE);
    run.update(0.25, |_| {}).unwrap();
    for seconds in [-0.1, f64::NEG_INFINITY, f64::NAN] {
        run.update(seconds, |_| {}).unwrap();
        assert_eq!((run.seconds(), hips(&run)), (0.25, [0.25, 0.0]));
    }
}

/// Reversed playback begins at the end of its clips and runs to their start.
#[test]
fn backward_state_plays_from_the_end() {
    let definition = r#"{"parameters": {"go": "trigger"}, "initial": "back",
        "states": [
            {"name": "back", "clip": "walk", "playback": "hold", "speed": -2.0},
            {"name": "rest", "clip": "stand"}
        ],
        "transitions": [
            {"from": "rest", "to": "back", "when": [{"parameter": "go"}]},
            {"from": "back", "to": "rest", "after": 1.0}
        ]}"#;
    let mut run = run_of(definition);
    for _ in 0..2 {
        assert_eq!((hips(&run), run.played()), ([2.0, 10.0], 0.0));
        run.update(0.25, |_| {}).unwrap();
        assert_eq!((hips(&run), run.played()), ([1.5, 10.0], 0.25));
        run.update(0.5, |_| {}).unwrap();
        assert_eq!((run.state(), hips(&run)), ("back", [0.5, 10.0]));
        // One cycle takes the two seconds of the clip at twice the speed.
        run.update(0.5, |_| {}).unwrap();
        assert_eq!((run.state(), run.seconds()), ("rest", 0.25));
        run.trigger("go").unwrap();
        run.update(0.0, |_| {}).unwrap();
    }
}

#[test]
fn number_bounds_are_exclusive() {
    let definition = r#"{"parameters": {"speed": 0.0}, "initial": "idle",
        "states": [{"name": "idle", "clip": "stand"}, {"name": "walk", "clip": "walk"}],
        "transitions": [{"from": "idle", "to": "walk",
            "when": [{"parameter": "speed", "above": 1.0, "below": 2.0}]}]}"#;
    for (speed, state) in [(1.0, "idle"), (1.5, "walk"), (2.0, "idle")] {
        let mut run = run_of(definition);
        run.set_number("speed", speed).unwrap();
        run.update(0.1, |_| {}).unwrap();
        assert_eq!(run.state(), state, "{speed}");
    }
}

#[test]
fn fade_reports_events_of_both_states() {
    let mut run = run_of(MACHINE);
    run.trigger("go").unwrap();
    let mut events = Vec::new();
    run.update(4.0, |fired| {
        events.push((
            fired.state.to_owned(),
            fired.event.name.clone(),
            fired.weight,
        ));
    })
    .unwrap();
    let expected = [
        // Half a second into a fade of one second.
        ("idle", "stand half", 0.5),
        ("walk", "walk half", 1.0),
        ("walk", "walk half", 1.0),
    ];
    let expected =
        expected.map(|(state, event, weight)| (state.to_owned(), event.to_owned(), weight));
    assert_eq!(events, expected);
}

#[test]
fn trigger_can_be_cleared() {
    let mut run = run_of(MACHINE);
    run.trigger("go").unwrap();
    run.clear_trigger("go").unwrap();
    run.update(0.5, |_| {}).unwrap();
    assert_eq!(run.state(), "idle");
    run.clear_trigger("og").says("`og` | go, stop");
}

#[test]
fn state_waits_for_clip_and_seconds() {
    let mut run = run_of(MACHINE);
    run.trigger("go").unwrap();
    run.update(1.0, |_| {}).unwrap();
    run.trigger("stop").unwrap();
    run.update(2.375, |_| {}).unwrap();
    assert_eq!(run.state(), "pause");
    run.update(0.25, |_| {}).unwrap();
    assert_eq!(
        (run.state(), run.seconds(), hips(&run)),
        ("idle", 0.125, [0.125, 0.0])
    );
    let invalid = MACHINE.replace("2.5", "-2.5");
    machine(&invalid).says("transitions[2].after_seconds | -2.5");
}

#[test]
fn definition_round_trips_through_json() {
    let definition: StateMachineDefinition = serde_json::from_str(MACHINE).unwrap();
    let text = serde_json::to_string(&definition).unwrap();
    let again: StateMachineDefinition = serde_json::from_str(&text).unwrap();
    assert_eq!(again, definition);
    assert!(machine(&text).is_ok());
}

#[test]
fn non_finite_numbers_are_rejected_with_their_path() {
    let definition: StateMachineDefinition = serde_json::from_str(MACHINE).unwrap();
    type Damage = fn(&mut StateMachineDefinition);
    let damages: [(Damage, &str); 6] = [
        (
            |d| d.transitions[0].seconds = f64::NAN,
            "transitions[0].seconds",
        ),
        (
            |d| d.transitions[2].after = Some(f64::INFINITY),
            "transitions[2].after",
        ),
        (
            |d| d.transitions[2].after_seconds = Some(f64::NAN),
            "transitions[2].after_seconds",
        ),
        (|d| d.states[1].speed = f64::NAN, "states[1].speed"),
        (
            |d| d.transitions[0].when[0].above = Some(f32::NAN),
            "transitions[0].when[0].above",
        ),
        (
            |d| d.transitions[0].when[0].below = Some(f32::INFINITY),
            "transitions[0].when[0].below",
        ),
    ];
    for (damage, path) in damages {
        let mut invalid = definition.clone();
        damage(&mut invalid);
        let error = StateMachine::new(&invalid, &clips()).unwrap_err();
        assert_eq!(error.path, path);
    }
}
