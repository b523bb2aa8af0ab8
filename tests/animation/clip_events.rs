//! Promise: each event of a clip fires exactly once each time playback passes it.

use kinopt::animation::{Armature, Clip, Playback, Playhead};
use support::random::Random;

/// Clip from 1 s to 3 s, with events at both ends, between them, and outside.
fn clip() -> Clip {
    let armature = Armature::new(Vec::new(), Vec::new()).unwrap();
    let mut builder = Clip::builder("steps", &armature);
    for (time, name) in [
        (1.75, "b"),
        (1.0, "a"),
        (3.0, "d"),
        (2.25, "c"),
        (0.5, "early"),
        (3.5, "late"),
    ] {
        builder.event(time, name).unwrap();
    }
    builder.span(1.0, 3.0).unwrap();
    builder.build()
}

fn names(clip: &Clip, playback: Playback, head: &mut Playhead, seconds: f64) -> String {
    let passage = head.advance(seconds);
    let fired = clip.fired(playback, passage);
    fired.map(|fired| fired.event.name.as_str()).collect()
}

#[test]
fn events_of_steps_match_a_hand_count() {
    let clip = clip();
    let mut head = Playhead::new();
    let mut step = |seconds| names(&clip, Playback::Hold, &mut head, seconds);
    assert_eq!([step(0.0), step(0.75)], ["a", "b"].map(String::from));
    assert_eq!(
        [step(0.0), step(9.0), step(9.0)],
        ["", "cd", ""].map(String::from)
    );

    let mut head = Playhead::new();
    let mut step = |seconds| names(&clip, Playback::Loop, &mut head, seconds);
    assert_eq!(
        [step(1.0), step(1.0), step(4.0)],
        ["ab", "cda", "bcdabcda"].map(String::from)
    );

    let mut head = Playhead::new();
    let mut step = |seconds| names(&clip, Playback::PingPong, &mut head, seconds);
    let steps = [step(1.5), step(1.5), step(3.0)];
    assert_eq!(steps, ["abc", "dc", "babcd"].map(String::from));
}

#[test]
fn backward_playback_reverses_the_events() {
    let clip = clip();
    let mut head = Playhead::starting_at(2.0);
    head.speed = -1.0;
    let mut step = |seconds| names(&clip, Playback::Loop, &mut head, seconds);
    // The start of the next cycle is at this time as well, but is not played.
    assert_eq!(step(1.875), "dcb");
    let ends = step(0.125);
    assert!(ends == "da" || ends == "ad", "{ends}");
}

#[test]
fn short_steps_fire_the_events_of_a_long_one() {
    let clip = clip();
    let mut random = Random::new(71);
    for case in 0..300 {
        let playback = [Playback::Hold, Playback::Loop, Playback::PingPong][case % 3];
        let speed = [1.0, -1.0, 0.37][random.below(3)];
        let start = random.within(-5.0, 5.0);
        let mut small = Playhead::starting_at(start);
        small.speed = speed;
        let mut fired = String::new();
        for _ in 0..200 {
            let step = [0.0, 0.1, 1.0 / 60.0, random.unit(), 2.0][random.below(5)];
            fired += &names(&clip, playback, &mut small, step);
        }
        // The same two times in one step.
        let mut whole = Playhead::starting_at(start);
        let once = whole.advance(0.0);
        let mut long = once;
        long.to = small.elapsed();
        let expected: String = clip
            .fired(playback, long)
            .map(|fired| fired.event.name.as_str())
            .collect();
        assert_eq!(fired, expected, "{playback:?} {speed}");
    }
}

#[test]
fn reversed_playback_fires_events_twice() {
    let clip = clip();
    let mut head = Playhead::starting_at(0.2);
    let forwards = names(&clip, Playback::Hold, &mut head, 1.25);
    head.speed = -1.0;
    let backwards = names(&clip, Playback::Hold, &mut head, 1.25);
    assert_eq!((forwards.as_str(), backwards.as_str()), ("bc", "cb"));
    // A stop exactly at an event does not fire it again in the reverse direction.
    let mut head = Playhead::starting_at(0.0);
    names(&clip, Playback::Loop, &mut head, 2.0);
    head.speed = -1.0;
    assert_eq!(names(&clip, Playback::Loop, &mut head, 0.5), "");
}

#[test]
fn non_finite_time_does_not_advance() {
    let clip = clip();
    let mut head = Playhead::starting_at(0.5);
    assert_eq!(names(&clip, Playback::Loop, &mut head, f64::NAN), "");
    assert_eq!(names(&clip, Playback::Loop, &mut head, f64::INFINITY), "");
    assert_eq!(head.elapsed(), 0.5);
}

#[test]
fn huge_times_fire_a_bounded_number_of_events() {
    let clip = clip();
    for playback in [Playback::Loop, Playback::PingPong] {
        for start_time in [1e300, -1e300] {
            let passage = Playhead::starting_at(start_time).advance(0.0);
            let fired = clip.fired(playback, passage).take(1000).count();
            assert!(fired < 1000, "{playback:?} at {start_time} s");
        }
    }
}
