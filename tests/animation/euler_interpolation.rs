//! Promise: the angles of bones follow the requested interpolation between keys: linear, Catmull-Rom or
//! Kochanek-Bartels. A rig's file selects it.

use glam::DVec3;
use kinopt::animation::curve::TensionContinuityBias;
use kinopt::animation::{ClipError, EulerClip, EulerInterpolation, EulerKey, EulerTrack, Playback};
use kinopt::io::rig::Rig;
use support::bones::humanoid;
use support::random::Random;
use support::small_rig::SmallRig;

fn track(keys: &[(f64, [f64; 3])]) -> EulerTrack {
    let rig = SmallRig::with_json(support::small_rig::JSON)
        .parse()
        .unwrap();
    let keys = keys.iter();
    EulerTrack {
        bone: rig.skeleton.bone_at(0).unwrap(),
        keys: keys
            .map(|&(time, angles)| EulerKey { time, angles })
            .collect(),
    }
}

fn clip(keys: &[(f64, [f64; 3])], between: &EulerInterpolation) -> EulerClip {
    let clip = EulerClip::new(vec![track(keys)]).unwrap();
    clip.interpolated(|_| between.clone()).unwrap()
}

fn at(clip: &EulerClip, time: f64) -> [f64; 3] {
    let mut q = [f64::NAN; 3];
    clip.sample(time, Playback::Hold, &mut q).unwrap();
    q
}

fn controls(tension: f32, continuity: f32, bias: f32) -> TensionContinuityBias {
    TensionContinuityBias {
        tension,
        continuity,
        bias,
    }
}

/// One angle at 0, 1, 3 and 2, at intervals of one second.
const EVEN: [(f64, [f64; 3]); 4] = [
    (0.0, [0.0, 0.0, 0.0]),
    (1.0, [1.0, 0.0, -1.0]),
    (2.0, [3.0, 0.0, -3.0]),
    (3.0, [2.0, 0.0, -2.0]),
];

fn uneven(random: &mut Random) -> Vec<(f64, [f64; 3])> {
    let mut time = -2.0;
    let keys = (0..6).map(|_| {
        time += random.within(0.02, 3.0);
        (time, random.vector(3.0).into())
    });
    keys.collect()
}

#[test]
fn linear_interpolation_has_kinks_at_keys() {
    let clip = clip(&EVEN, &EulerInterpolation::Linear);
    for (time, expected) in [
        (0.25, 0.25),
        (1.5, 2.0),
        (1.75, 2.5),
        (2.5, 2.5),
        (9.0, 2.0),
    ] {
        assert_eq!(at(&clip, time), [expected, 0.0, -expected]);
    }
    let h = 1e-3;
    let speed = |from: f64| (at(&clip, from + h)[0] - at(&clip, from)[0]) / h;
    assert!((speed(1.0 - h) - 1.0).abs() < 1e-9 && (speed(1.0) - 2.0).abs() < 1e-9);
}

#[test]
fn kochanek_bartels_segment_matches_hand_values() {
    // At key 1 t = c = ½, b = −½. The outgoing tangent is
    //     (1−t)(1+b)(1+c)/2 · 1 + (1−t)(1−b)(1−c)/2 · 2 = 0.1875 + 0.375,
    // and the incoming tangent of key 2, without controls, is ½·2 − ½·1. In the middle of the segment:
    //     ½·1 + ½·3 + ⅛ (0.5625 − 0.5).
    let mut passed = vec![TensionContinuityBias::default(); 4];
    passed[1] = controls(0.5, 0.5, -0.5);
    let clip = clip(&EVEN, &EulerInterpolation::KochanekBartels(passed));
    assert_eq!(at(&clip, 1.5), [2.007_812_5, 0.0, -2.007_812_5]);
    // The incoming tangent is (1−t)(1+b)(1−c)/2 · 1 + (1−t)(1−b)(1+c)/2 · 2 = 0.0625 + 1.125. The outgoing tangent of
    // key 0 is the one-sided 1: ½·0 + ½·1 + ⅛ (1 − 1.1875).
    assert_eq!(at(&clip, 0.5)[0], 0.476_562_5);
}

#[test]
fn kochanek_bartels_contains_the_other_splines() {
    let mut random = Random::new(1);
    for _ in 0..20 {
        let keys = uneven(&mut random);
        let source = track(&keys);
        let alike = |c| EulerInterpolation::kochanek_bartels(&source, c);
        let smooth = clip(&keys, &EulerInterpolation::CatmullRom);
        let zeros = clip(&keys, &alike(controls(0.0, 0.0, 0.0)));
        assert_eq!(smooth, EulerClip::new(vec![source.clone()]).unwrap());
        for part in 0..=200 {
            let time = keys[0].0 + (keys[5].0 - keys[0].0) * f64::from(part) / 200.0;
            for (a, b) in at(&smooth, time).iter().zip(at(&zeros, time)) {
                assert!((a - b).abs() < 1e-12 * (1.0 + a.abs()), "{a} {b} at {time}");
            }
        }
        // With a tension of 1 the curve stops at every key, for any continuity and bias.
        let stopping = clip(&keys, &alike(controls(1.0, 0.4, -0.7)));
        for pair in keys.windows(2) {
            let middle = at(&stopping, 0.5 * (pair[0].0 + pair[1].0));
            let ends = pair[0].1.iter().zip(pair[1].1);
            for (middle, (a, b)) in middle.iter().zip(ends) {
                assert!((middle - 0.5 * (a + b)).abs() < 1e-12);
            }
        }
    }
    // With a continuity of −1 the curve is straight between evenly spaced keys.
    let corners = EulerInterpolation::kochanek_bartels(&track(&EVEN), controls(0.0, -1.0, 0.0));
    let (corners, straight) = (
        clip(&EVEN, &corners),
        clip(&EVEN, &EulerInterpolation::Linear),
    );
    for part in 0..=30 {
        let time = 0.1 * f64::from(part);
        for (a, b) in at(&corners, time).iter().zip(at(&straight, time)) {
            assert!((a - b).abs() < 1e-14);
        }
    }
}

#[test]
fn curves_pass_all_keys_and_match_vector_curves() {
    let mut random = Random::new(2);
    for _ in 0..20 {
        let keys = uneven(&mut random);
        let mut unit = || random.within(-1.0, 1.0) as f32;
        let any = (0..6).map(|_| controls(unit(), unit(), unit())).collect();
        for between in [
            EulerInterpolation::Linear,
            EulerInterpolation::CatmullRom,
            EulerInterpolation::KochanekBartels(any),
        ] {
            let clip = clip(&keys, &between);
            let (times, values) = keys.iter().map(|&(t, v)| (t, DVec3::from(v))).unzip();
            let curve = between.curve(times, values).unwrap();
            for &(time, angles) in &keys {
                assert_eq!(at(&clip, time), angles);
            }
            for part in 0..=100 {
                let time = keys[0].0 + (keys[5].0 - keys[0].0) * f64::from(part) / 100.0;
                let (ours, theirs) = (DVec3::from(at(&clip, time)), curve.at(time));
                let deviation = (ours - theirs).length();
                assert!(
                    deviation < 1e-12 * (1.0 + theirs.length()),
                    "{between:?}: {deviation:e}"
                );
            }
        }
    }
}

#[test]
fn mismatched_controls_are_named() {
    let clip = || EulerClip::new(vec![track(&EVEN)]).unwrap();
    let with = |controls| {
        let between = EulerInterpolation::KochanekBartels(controls);
        clip().interpolated(|_| between.clone())
    };
    let (bone, given, keys) = (0, 3, 4);
    assert_eq!(
        with(vec![controls(0.0, 0.0, 0.0); 3]),
        Err(ClipError::ControlCount { bone, given, keys })
    );
    let mut odd = vec![controls(0.0, 0.0, 0.0); 4];
    odd[2].bias = f32::NAN;
    let key = 2;
    assert_eq!(with(odd), Err(ClipError::NonFiniteControls { bone, key }));
    let other = track(&EVEN).bone;
    let default = EulerInterpolation::default();
    assert_eq!(EulerClip::default().interpolation(other), &default);
}

/// The small rig with other text in place of its keyframes.
fn with_track(keyframes: &str) -> Result<Rig, String> {
    let (before, rest) = support::small_rig::JSON
        .split_once("\"fk_animation\": ")
        .unwrap();
    let (_, after) = rest.split_once(",\n\"bones\"").unwrap();
    let json = format!("{before}\"fk_animation\": [{keyframes}],\n\"bones\"{after}");
    let rig = SmallRig::with_json(&json).parse();
    rig.map_err(|error| error.to_string())
}

#[test]
fn interpolation_round_trips_through_files() {
    let keys = r#""keys": [{"t": 0, "xzx": [0, 0, 0]}, {"t": 1, "xzx": [0, 90, 0]}"#;
    let tcb = r#""keys": [{"t": 0, "xzx": [0, 0, 0], "tcb": [0.1, -0.7, 1]}, {"t": 1, "xzx": [0, 90, 0]}"#;
    let passed = vec![controls(0.1, -0.7, 1.0), TensionContinuityBias::default()];
    for (text, expected) in [
        (format!("{keys}]"), EulerInterpolation::CatmullRom),
        (
            format!("\"interpolation\": \"catmull-rom\", {keys}]"),
            EulerInterpolation::CatmullRom,
        ),
        (
            format!("\"interpolation\": \"linear\", {keys}]"),
            EulerInterpolation::Linear,
        ),
        (
            format!("\"interpolation\": \"kochanek-bartels\", {tcb}]"),
            EulerInterpolation::KochanekBartels(passed),
        ),
    ] {
        let rig = with_track(&format!("{{\"bone_id\": 1, {text}}}")).unwrap();
        let bone = rig.skeleton.bone_at(1).unwrap();
        assert_eq!(rig.clip.interpolation(bone), &expected);
        let written = rig.to_json("small.ply", "small.dmat");
        let again = SmallRig::with_json(&written).parse().unwrap();
        assert_eq!(again.clip, rig.clip);
        assert_eq!(
            written.contains("interpolation"),
            expected != EulerInterpolation::CatmullRom
        );
    }
}

#[test]
fn invalid_interpolations_are_named_with_path() {
    let key = |tcb: &str| format!("[{{\"t\": 0, \"xzx\": [0, 0, 0], \"tcb\": {tcb}}}]");
    for (interpolation, tcb, words) in [
        (
            "smooth",
            "[0, 0, 0]",
            [".interpolation", "`smooth`", "linear"],
        ),
        (
            "linear",
            "[0, 0, 0]",
            ["keys[0].tcb", "kochanek-bartels", "linear"],
        ),
        (
            "kochanek-bartels",
            "[0, 0]",
            ["keys[0].tcb", "2 numbers", "3"],
        ),
        (
            "kochanek-bartels",
            "[0, 1e300, 0]",
            ["keys[0].tcb", "range", ""],
        ),
        ("kochanek-bartels", "null", ["keys[0].tcb", "null", ""]),
    ] {
        let keys = key(tcb);
        let track =
            format!("{{\"bone_id\": 1, \"interpolation\": \"{interpolation}\", \"keys\": {keys}}}");
        let error = with_track(&track).unwrap_err();
        for word in words.iter().chain(&["small.json", "fk_animation[0]"]) {
            assert!(error.contains(word), "no {word} in {error}");
        }
    }
}

/// A clip lasts from the first key of any bone to the last key of any bone.
#[test]
fn clip_spans_the_keys_of_all_bones() {
    let rig = humanoid();
    let track = |bone: usize, times: [f64; 2]| EulerTrack {
        bone: rig.skeleton.bone_at(bone).unwrap(),
        keys: times
            .map(|time| EulerKey {
                time,
                angles: [0.0; 3],
            })
            .to_vec(),
    };
    let spans = [[1.0, 2.0], [-0.5, 1.5], [0.5, 3.0]];
    for first in 0..3 {
        let bones = (0..3).map(|bone| track(bone, spans[(first + bone) % 3]));
        let clip = EulerClip::new(bones.collect()).unwrap();
        assert_eq!(clip.time_span(), Some([-0.5, 3.0]));
    }
    assert_eq!(EulerClip::new(Vec::new()).unwrap().time_span(), None);
}
