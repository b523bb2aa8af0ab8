//! Promise: a hand follows a curve within a time span by its rig's own keys, and nothing else changes.
//!
//! Limits hold between keys as well. No small change of these keys within the limits has a lower cost.

use kinopt::animation::curve::KeyedCurve;
use kinopt::animation::{EulerClip, EulerKey, EulerTrack, Playback};
use kinopt::glam::DVec3;
use kinopt::io::rig::Rig;
use kinopt::motion::clip_ik::{ClipIkError, KeyframeIk, Reach};
use kinopt::skeleton::{BoneId, Skeleton};
use support::bones::humanoid;
use support::random::Random;

const SPAN: [f64; 2] = [1.2, 3.0];
const HAND: &str = "right_hand";

/// Keys every 0.2 s for all bones of the right arm, sampled from the rig's own keys.
fn dense(rig: &Rig) -> EulerClip {
    let bones = [
        "right_clavicle",
        "right_upper_arm",
        "right_forearm",
        "right_hand",
    ];
    let tracks = bones.iter().map(|name| {
        let bone = rig.skeleton.bone(name).unwrap();
        let keys = (0..=15).map(|k| {
            let time = 0.2 * f64::from(k);
            let q = angles(&rig.skeleton, &rig.clip, time);
            let angles = [0, 1, 2].map(|angle| q[3 * bone.index() + angle]);
            EulerKey { time, angles }
        });
        let keys = keys.collect();
        EulerTrack { bone, keys }
    });
    EulerClip::new(tracks.collect()).unwrap()
}

fn angles(skeleton: &Skeleton, clip: &EulerClip, time: f64) -> Vec<f64> {
    let mut q = vec![0.0; skeleton.angles()];
    clip.sample(time, Playback::Hold, &mut q).unwrap();
    q
}

/// By forward kinematics of the bones: the tip is at x = length of the posed bone.
fn tip(skeleton: &Skeleton, clip: &EulerClip, bone: BoneId, time: f64) -> DVec3 {
    let placed = skeleton.pose(&angles(skeleton, clip, time)).unwrap();
    DVec3::from(placed.tip(skeleton, bone).unwrap().to_array())
}

/// A loop of 10 cm about the hand's position at half time.
fn curve(skeleton: &Skeleton, clip: &EulerClip, hand: BoneId) -> KeyedCurve<DVec3> {
    let middle = tip(skeleton, clip, hand, 2.1);
    let times: Vec<f64> = (0..=18).map(|k| SPAN[0] + 0.1 * f64::from(k)).collect();
    let points = times.iter().map(|time| {
        let (sin, cos) = (3.0 * (time - SPAN[0])).sin_cos();
        middle + DVec3::new(0.06 * sin, 0.05 * cos, 0.05 * sin)
    });
    let points = points.collect();
    KeyedCurve::catmull_rom(times, points).unwrap()
}

fn all_times() -> impl Iterator<Item = f64> {
    (0..=3000).map(|k| f64::from(k) / 1000.0)
}

/// 60 sample times per second by default.
#[test]
fn default_is_sixty_samples_per_second() {
    let rig = humanoid();
    let (skeleton, clip) = (&rig.skeleton, dense(&rig));
    let hand = skeleton.bone(HAND).unwrap();
    let curve = curve(skeleton, &clip, hand);
    let reach = || Reach::along(hand, curve.clone()).with_span(SPAN[0]..=SPAN[1]);
    let ik = || KeyframeIk::new(skeleton).with_reach(reach());
    let usual = ik().solve(&clip).unwrap().clip;
    let [sixty, thirty] = [60.0, 30.0].map(|rate| {
        let ik = ik().with_moments_per_second(rate);
        ik.solve(&clip).unwrap().clip
    });
    assert_eq!(usual, sixty);
    assert_ne!(usual, thirty);
}

#[test]
fn hand_follows_by_keys_within_the_span_alone() {
    let rig = humanoid();
    let (skeleton, clip) = (&rig.skeleton, dense(&rig));
    let hand = skeleton.bone(HAND).unwrap();
    let curve = curve(skeleton, &clip, hand);
    let reach = Reach::along(hand, curve.clone())
        .with_span(SPAN[0]..=SPAN[1])
        .with_fade(0.2);
    let edited = KeyframeIk::new(skeleton)
        .with_reach(reach)
        .solve(&clip)
        .unwrap();
    // The hand follows, between keys as well; it did not before.
    let deviation_of = |clip: &EulerClip| {
        let times = all_times().filter(|time| (1.5..=2.7).contains(time));
        let deviation = times.map(|time| tip(skeleton, clip, hand, time).distance(curve.at(time)));
        deviation.fold(0.0, f64::max)
    };
    let (before, after) = (deviation_of(&clip), deviation_of(&edited.clip));
    assert!(before > 0.05 && after < 0.02, "{before} {after}");
    assert!(
        (edited.report.led[0].miss - after).abs() < 0.02,
        "{:?} {after}",
        edited.report.led
    );
    // Keys outside the span are exactly unchanged, and so are times, bones and angles that nothing moves.
    let mut changed = 0;
    assert_eq!(edited.clip.tracks().len(), clip.tracks().len());
    for (new, old) in edited.clip.tracks().iter().zip(clip.tracks()) {
        assert_eq!((new.bone, new.keys.len()), (old.bone, old.keys.len()));
        for (new, old) in new.keys.iter().zip(&old.keys) {
            assert_eq!(new.time, old.time);
            if (SPAN[0]..=SPAN[1]).contains(&old.time) {
                changed += usize::from(new != old);
            } else {
                assert_eq!(new, old);
            }
        }
    }
    assert_eq!(changed, edited.keys_changed);
    // Therefore nothing moves up to two keys before the span.
    for time in all_times().filter(|time| *time <= SPAN[0] - 0.4) {
        assert_eq!(
            angles(skeleton, &edited.clip, time),
            angles(skeleton, &clip, time)
        );
    }
}

#[test]
fn limits_hold_between_keys() {
    let rig = humanoid();
    let (skeleton, clip) = (&rig.skeleton, dense(&rig));
    let hand = skeleton.bone(HAND).unwrap();
    // Behind the back and far away: shoulder and elbow reach their limits.
    for target in [[-0.6, -0.1, 1.3], [0.1, 0.6, 1.5], [0.0, -0.2, 0.4]] {
        let reach = Reach::to(hand, target)
            .unwrap()
            .with_span(SPAN[0]..=SPAN[1]);
        let edited = KeyframeIk::new(skeleton)
            .with_reach(reach)
            .solve(&clip)
            .unwrap();
        let mut touched = false;
        for time in all_times() {
            let [new, old] = [&edited.clip, &clip].map(|clip| angles(skeleton, clip, time));
            for (k, (new, old)) in new.iter().zip(&old).enumerate() {
                let limits = skeleton.bones()[k / 3].limits[k % 3];
                // If the clip itself exceeds a limit, it is exceeded no further.
                let (lower, upper) = (limits.lower.min(*old), limits.upper.max(*old));
                assert!(
                    lower - 1e-9 <= *new && *new <= upper + 1e-9,
                    "{target:?}, {time} s: {k}"
                );
                touched |= new != old && ((new - lower).abs() < 0.05 || (upper - new).abs() < 0.05);
            }
        }
        assert!(touched, "{target:?} asks for no limit");
    }
}

#[test]
fn no_small_change_of_keys_lowers_the_cost() {
    let rig = humanoid();
    let (skeleton, clip) = (&rig.skeleton, dense(&rig));
    let hand = skeleton.bone(HAND).unwrap();
    let curve = curve(skeleton, &clip, hand);
    let reach = || {
        Reach::along(hand, curve.clone())
            .with_span(SPAN[0]..=SPAN[1])
            .with_fade(0.0)
    };
    let edited = KeyframeIk::new(skeleton)
        .with_reach(reach())
        .solve(&clip)
        .unwrap();
    // Evaluated again: the sum of squares over 60 sample times per second, plus 0.001 of the rig's size for a radian of
    // a key.
    let cost = |of: &EulerClip| {
        let moments = (0..=108).map(|k| SPAN[0] + (SPAN[1] - SPAN[0]) * f64::from(k) / 108.0);
        let deviation =
            moments.map(|time| tip(skeleton, of, hand, time).distance_squared(curve.at(time)));
        let deviation: f64 = deviation.sum();
        let pairs = of.tracks().iter().zip(clip.tracks());
        let keys = pairs.flat_map(|(new, old)| new.keys.iter().zip(&old.keys));
        let moved =
            keys.flat_map(|(new, old)| [0, 1, 2].map(|k| (new.angles[k] - old.angles[k]).powi(2)));
        deviation + (1e-3 * skeleton.size()).powi(2) * moved.sum::<f64>()
    };
    let solved_cost = cost(&edited.clip);
    assert!(solved_cost < 0.05 * cost(&clip));
    let mut random = Random::new(5);
    let mut tried = 0;
    for _ in 0..300 {
        let mut tracks = edited.clip.tracks().to_vec();
        let track = random.below(tracks.len());
        let bone = tracks[track].bone.index();
        let key = 7 + random.below(8);
        let angle = random.below(3);
        let limits = skeleton.bones()[bone].limits[angle];
        let changed = &mut tracks[track].keys[key].angles[angle];
        let new = *changed + random.within(-0.02, 0.02);
        // Well within the limits, so that neither key nor spline reaches one.
        if !(limits.lower + 0.1..=limits.upper - 0.1).contains(&new) {
            continue;
        }
        *changed = new;
        tried += 1;
        let other = cost(&EulerClip::new(tracks).unwrap());
        assert!(
            other > solved_cost - 1e-6,
            "key {key} of bone {bone}: {other} {solved_cost}"
        );
    }
    assert!(tried > 50, "{tried}");
}

#[test]
fn invalid_keyframe_ik_is_named() {
    let rig = humanoid();
    let clip = dense(&rig);
    let hand = rig.skeleton.bone(HAND).unwrap();
    let reach = || Reach::to(hand, [0.3, -0.3, 1.2]).unwrap();
    let ik = || KeyframeIk::new(&rig.skeleton);
    let says = |ik: KeyframeIk<'_>| ik.solve(&clip).unwrap_err().to_string();
    assert_eq!(ik().solve(&clip).unwrap_err(), ClipIkError::Nothing);
    assert!(says(ik().with_reach(reach()).with_reach(reach())).contains("two targets"));
    assert!(says(ik().with_reach(reach().with_span(7.0..=8.0))).contains("from 7 s"));
    let short = || reach().with_span(1.05..=1.15);
    assert!(says(ik().with_reach(short())).contains("no key"));
    assert!(
        says(ik().with_reach(reach()).with_moments_per_second(f64::NAN))
            .contains("moments_per_second")
    );
    assert!(says(ik().with_reach(reach()).with_moments_per_second(1e12)).contains("million"));
    let foot = rig.skeleton.bone("left_foot").unwrap();
    assert!(
        says(ik().with_reach(reach()).with_root(foot))
            .contains("is not below the root `left_foot`")
    );
    let still = Reach::to(foot, [0.0, 0.1, 0.1]).unwrap();
    assert!(says(ik().with_reach(still)).contains("no key"));
    let none = EulerClip::default();
    assert_eq!(
        ik().with_reach(reach()).solve(&none).unwrap_err(),
        ClipIkError::NoKeys
    );
}

const BENT_BONE: &str = "right_forearm";

/// The dense keys with a constant bend of the forearm, except where `at` gives another value.
fn bent(rig: &Rig, still: f64, at: impl Fn(usize) -> Option<f64>) -> EulerClip {
    let forearm = rig.skeleton.bone(BENT_BONE).unwrap();
    let mut tracks = dense(rig).tracks().to_vec();
    for track in tracks.iter_mut().filter(|track| track.bone == forearm) {
        for (k, key) in track.keys.iter_mut().enumerate() {
            key.angles[1] = at(k).unwrap_or(still);
        }
    }
    EulerClip::new(tracks).unwrap()
}

fn bends(rig: &Rig, clip: &EulerClip) -> Vec<f64> {
    let forearm = rig.skeleton.bone(BENT_BONE).unwrap();
    let track = clip.tracks().iter().find(|track| track.bone == forearm);
    let keys = &track.unwrap().keys;
    keys.iter().map(|key| key.angles[1]).collect()
}

/// Largest distance between the hands of two clips.
fn hand_distance(rig: &Rig, one: &EulerClip, other: &EulerClip, span: [f64; 2]) -> f64 {
    let hand = rig.skeleton.bone(HAND).unwrap();
    let times = (0..=200).map(|k| span[0] + (span[1] - span[0]) * f64::from(k) / 200.0);
    let deviations = times.map(|time| {
        let [one, other] = [one, other].map(|clip| tip(&rig.skeleton, clip, hand, time));
        one.distance(other)
    });
    deviations.fold(0.0, f64::max)
}

/// A reach along the hand's curve in a clip.
fn hand_curve(rig: &Rig, clip: &EulerClip, span: [f64; 2]) -> Reach {
    let hand = rig.skeleton.bone(HAND).unwrap();
    let times: Vec<f64> = (0..=600)
        .map(|k| span[0] + (span[1] - span[0]) * f64::from(k) / 600.0)
        .collect();
    let points = times
        .iter()
        .map(|time| tip(&rig.skeleton, clip, hand, *time))
        .collect();
    Reach::along(hand, KeyedCurve::catmull_rom(times, points).unwrap())
        .with_span(span[0]..=span[1])
        .with_fade(0.0)
}

#[test]
fn track_beyond_its_limit_is_moved_within_it() {
    let rig = humanoid();
    let skeleton = &rig.skeleton;
    let forearm = skeleton.bone(BENT_BONE).unwrap();
    let limits = skeleton.bones()[forearm.index()].limits[1];
    let beyond = bent(&rig, limits.upper + 0.2, |_| None);
    // The hand's curve with the elbow well within its limits.
    let reachable_clip = bent(&rig, limits.upper - 0.4, |_| None);
    let all = [0.0, 3.0];
    assert!(hand_distance(&rig, &beyond, &reachable_clip, all) > 0.1);
    let solve = |span| {
        let ik = KeyframeIk::new(skeleton).with_reach(hand_curve(&rig, &reachable_clip, span));
        ik.solve(&beyond).unwrap()
    };
    // All keys are solved for: no limit is exceeded.
    let edited = solve(all);
    assert!(
        edited.report.beyond.is_empty(),
        "{:?}",
        edited.report.beyond
    );
    for time in all_times() {
        let bend = angles(skeleton, &edited.clip, time)[3 * forearm.index() + 1];
        assert!(bend <= limits.upper + 1e-9, "{bend} at {time} s");
    }
    let deviation = hand_distance(&rig, &edited.clip, &reachable_clip, all);
    assert!(
        deviation < 0.01 && edited.report.led[0].miss < 0.01,
        "{deviation} {:?}",
        edited.report.led
    );

    // Keys outside the span are kept, and reported where they keep the elbow beyond its limit.
    let edited = solve(SPAN);
    for (k, (new, old)) in bends(&rig, &edited.clip)
        .iter()
        .zip(bends(&rig, &beyond))
        .enumerate()
    {
        if k < 6 {
            assert_eq!(*new, old);
        } else {
            assert!(*new <= limits.upper, "key {k}: {new}");
        }
    }
    for time in all_times().filter(|time| *time >= SPAN[0]) {
        let bend = angles(skeleton, &edited.clip, time)[3 * forearm.index() + 1];
        assert!(bend <= limits.upper + 1e-9, "{bend} at {time} s");
    }
    let [reported] = &edited.report.beyond[..] else {
        panic!("{:?}", edited.report.beyond)
    };
    assert_eq!((reported.bone, reported.angle), (forearm, 1));
    assert!(reported.at < SPAN[0], "{reported:?}");
    let worst =
        all_times().map(|time| angles(skeleton, &edited.clip, time)[3 * forearm.index() + 1]);
    let worst = worst.fold(0.0, f64::max) - limits.upper;
    assert!(
        (reported.by - worst).abs() < 0.01 && reported.by >= worst - 1e-9,
        "{reported:?} {worst}"
    );
    let deviation = hand_distance(&rig, &edited.clip, &reachable_clip, SPAN);
    assert!(
        deviation < 0.02 && edited.report.led[0].miss < 0.02,
        "{deviation} {:?}",
        edited.report.led
    );
}

#[test]
fn key_beyond_its_limit_is_clamped_without_others() {
    let rig = humanoid();
    let skeleton = &rig.skeleton;
    let forearm = skeleton.bone(BENT_BONE).unwrap();
    let limits = skeleton.bones()[forearm.index()].limits[1];
    for (over, key) in [(0.05, 9), (0.3, 10), (0.05, 15)] {
        let only = |bend: f64| {
            bent(&rig, limits.upper - 0.3, move |k| {
                (k == key).then_some(bend)
            })
        };
        let (beyond, reachable_clip) = (only(limits.upper + over), only(limits.upper));
        let ik = KeyframeIk::new(skeleton).with_reach(hand_curve(&rig, &reachable_clip, SPAN));
        let edited = ik.solve(&beyond).unwrap();
        assert!(
            edited.report.beyond.is_empty(),
            "{:?}",
            edited.report.beyond
        );
        let new = bends(&rig, &edited.clip);
        assert!(
            new[key] <= limits.upper && new[key] > limits.upper - 2e-3,
            "{over}: {new:?}"
        );
        for (new, old) in edited.clip.tracks().iter().zip(beyond.tracks()) {
            for (k, (new, old)) in new.keys.iter().zip(&old.keys).enumerate() {
                for angle in 0..3 {
                    if (k, angle) != (key, 1) {
                        let moved = (new.angles[angle] - old.angles[angle]).abs();
                        assert!(moved < 5e-3, "{over}: key {k} by {moved}");
                    }
                }
            }
        }
        assert!(edited.report.led[0].miss < 2e-3, "{:?}", edited.report.led);
    }
}

#[test]
fn single_key_track_keeps_its_limit() {
    let rig = humanoid();
    let skeleton = &rig.skeleton;
    let [forearm, hand] = [BENT_BONE, HAND].map(|name| skeleton.bone(name).unwrap());
    let limits = skeleton.bones()[forearm.index()].limits[1];
    let mut tracks = dense(&rig).tracks().to_vec();
    for track in tracks.iter_mut().filter(|track| track.bone == forearm) {
        track.keys.truncate(1);
        track.keys[0].time = 2.0;
    }
    let clip = EulerClip::new(tracks.clone()).unwrap();
    for track in tracks.iter_mut().filter(|track| track.bone == forearm) {
        track.keys[0].angles[1] = limits.lower - 0.5;
    }
    let beyond = EulerClip::new(tracks).unwrap();
    // The hand's position with an elbow bent backwards, which shoulder and clavicle cannot achieve.
    let target = tip(skeleton, &beyond, hand, 2.1);
    let reach = Reach::to(hand, target.to_array())
        .unwrap()
        .with_span(SPAN[0]..=SPAN[1])
        .with_fade(0.0);
    let root = skeleton.bone("right_upper_arm").unwrap();
    let ik = KeyframeIk::new(skeleton).with_root(root).with_reach(reach);
    let edited = ik.solve(&clip).unwrap();
    let bend = angles(skeleton, &edited.clip, 0.0)[3 * forearm.index() + 1];
    assert!(limits.lower <= bend && bend < limits.lower + 0.1, "{bend}");
    let times = (0..=108).map(|k| SPAN[0] + (SPAN[1] - SPAN[0]) * f64::from(k) / 108.0);
    let deviation = times.map(|time| tip(skeleton, &edited.clip, hand, time).distance(target));
    let deviation = deviation.fold(0.0, f64::max);
    assert!(
        (edited.report.led[0].miss - deviation).abs() < 1e-9,
        "{:?} {deviation}",
        edited.report.led
    );
}

#[test]
fn locked_angle_keeps_its_value_in_the_clip() {
    let rig = humanoid();
    let skeleton = &rig.skeleton;
    let [forearm, hand] = [BENT_BONE, HAND].map(|name| skeleton.bone(name).unwrap());
    assert!(skeleton.bones()[forearm.index()].limits[2].is_locked());
    let mut tracks = dense(&rig).tracks().to_vec();
    for track in tracks.iter_mut().filter(|track| track.bone == forearm) {
        for key in &mut track.keys {
            key.angles[2] = 0.4;
        }
    }
    let clip = EulerClip::new(tracks).unwrap();
    let curve = curve(skeleton, &clip, hand);
    let reach = Reach::along(hand, curve.clone())
        .with_span(SPAN[0]..=SPAN[1])
        .with_fade(0.0);
    let edited = KeyframeIk::new(skeleton)
        .with_reach(reach)
        .solve(&clip)
        .unwrap();
    let times = (0..=108).map(|k| SPAN[0] + (SPAN[1] - SPAN[0]) * f64::from(k) / 108.0);
    let deviation =
        times.map(|time| tip(skeleton, &edited.clip, hand, time).distance(curve.at(time)));
    let deviation = deviation.fold(0.0, f64::max);
    let reported = edited.report.led[0].miss;
    assert!(
        deviation < 0.02 && (reported - deviation).abs() < 1e-9,
        "{reported} {deviation}"
    );
}

/// A last key that is clamped to its limit is taken into account: the other keys compensate.
#[test]
fn clamped_last_key_is_compensated_by_others() {
    let rig = humanoid();
    let skeleton = &rig.skeleton;
    let forearm = skeleton.bone(BENT_BONE).unwrap();
    let limits = skeleton.bones()[forearm.index()].limits[1];
    let clip = bent(&rig, limits.lower + 0.3, |_| None);
    // The elbow would have to bend backwards at the end, where no bone above it helps.
    let beyond = bent(&rig, limits.lower + 0.3, |k| {
        (k == 15).then_some(limits.lower - 0.5)
    });
    let root = skeleton.bone("right_upper_arm").unwrap();
    let ik = KeyframeIk::new(skeleton).with_root(root);
    let edited = ik
        .with_reach(hand_curve(&rig, &beyond, SPAN))
        .solve(&clip)
        .unwrap();
    assert!(bends(&rig, &edited.clip)[15] >= limits.lower);
    let cost = |of: &EulerClip| {
        let hand = skeleton.bone(HAND).unwrap();
        let moments = (0..=108).map(|k| SPAN[0] + (SPAN[1] - SPAN[0]) * f64::from(k) / 108.0);
        let deviations = moments.map(|time| {
            let [actual, expected] = [of, &beyond].map(|clip| tip(skeleton, clip, hand, time));
            actual.distance_squared(expected)
        });
        deviations.sum::<f64>()
    };
    let solved_cost = cost(&edited.clip);
    for (key, by) in [(13, 0.01), (13, -0.01), (14, 0.01), (14, -0.01)] {
        let mut tracks = edited.clip.tracks().to_vec();
        for track in tracks.iter_mut().filter(|track| track.bone == forearm) {
            track.keys[key].angles[1] += by;
        }
        let other = cost(&EulerClip::new(tracks).unwrap());
        assert!(
            other > solved_cost - 1e-6,
            "key {key} by {by}: {other} {solved_cost}"
        );
    }
}
