//! Promise: between keys a curve follows its easing or its Bézier handles, alone and in a clip.

use glam::{DVec3, Quat, Vec3A};
use kinopt::animation::curve::{BezierHandle, KeyError, KeyedCurve};
use kinopt::animation::rotation::RotationCurve;
use kinopt::animation::{
    Armature, ArmatureBone, BezierEasing, Channel, Clip, Cursor, Easing, LocalTransform, Playback,
};
use support::random::Random;

fn handle(time: f64, value: f64) -> BezierHandle<f64> {
    BezierHandle { time, value }
}

/// Start, peak and end of a jump as set by an animator: constant speed between keys.
#[test]
fn linear_keys_of_a_jump_have_constant_speed() {
    let keys = [[0.0, 0.0, 0.0], [0.0, 3.0, 0.0], [5.0, 0.0, 0.0]].map(DVec3::from_array);
    let curve = KeyedCurve::linear(vec![0.0, 1.0, 2.0], keys.to_vec()).unwrap();
    for (time, expected) in [
        (0.0, [0.0, 0.0, 0.0]),
        (0.5, [0.0, 1.5, 0.0]),
        (1.0, [0.0, 3.0, 0.0]),
        (1.5, [2.5, 1.5, 0.0]),
        (2.0, [5.0, 0.0, 0.0]),
    ] {
        assert_eq!(curve.at(time), DVec3::from_array(expected), "{time} s");
    }
    // With easings, it passes the same positions at other times.
    let easings = vec![Easing::QuadraticOut, Easing::QuadraticIn, Easing::Linear];
    let eased = KeyedCurve::eased(vec![0.0, 1.0, 2.0], keys.to_vec(), easings).unwrap();
    assert_eq!(eased.at(0.5), DVec3::new(0.0, 2.25, 0.0));
    assert_eq!(eased.at(1.5), DVec3::new(1.25, 2.25, 0.0));
    // Its velocity at the peak is zero, where the linear curve has a kink.
    assert_eq!(eased.rate(1.0), DVec3::ZERO);
    assert!(eased.rate(1.0 - 1e-9).length() < 1e-7);
    assert_eq!(curve.rate(1.0), DVec3::new(5.0, -3.0, 0.0));
}

#[test]
fn each_segment_uses_its_easing() {
    let mut random = Random::new(101);
    let drawn = BezierEasing::new([0.3, -0.4], [0.7, 1.6]).unwrap();
    let mut easings = Easing::ALL.to_vec();
    easings.extend([drawn.into(), Easing::Linear]);
    let times: Vec<f64> = (0..9).map(|k| f64::from(k * k) * 0.3 - 1.0).collect();
    let values: Vec<f64> = times.iter().map(|_| random.within(-3.0, 3.0)).collect();
    let curve = KeyedCurve::eased(times.clone(), values.clone(), easings.clone()).unwrap();
    for key in 0..8 {
        let length = times[key + 1] - times[key];
        assert_eq!(curve.at(times[key]), values[key]);
        for u in [0.1, 0.4, 0.5, 0.8, 0.99] {
            let share: f64 = easings[key].at(u);
            let expected = values[key] + (values[key + 1] - values[key]) * share;
            let actual = curve.at(times[key] + u * length);
            assert!((actual - expected).abs() < 1e-9, "{:?} {u}", easings[key]);
        }
    }
}

/// Handles at thirds of the time leave time linear, and the values are a plain cubic with known Bernstein coefficients.
#[test]
fn handles_at_thirds_give_plain_cubics() {
    let curve = |values: [f64; 2]| {
        let third = 2.0 / 3.0;
        let handles = vec![
            [handle(0.0, 0.0), handle(third, values[0])],
            [handle(-third, values[1] - 1.0), handle(0.0, 0.0)],
        ];
        KeyedCurve::bezier(vec![5.0, 7.0], vec![0.0, 1.0], handles).unwrap()
    };
    type Polynomial = fn(f64) -> f64;
    let table: [([f64; 2], Polynomial); 4] = [
        ([1.0 / 3.0, 2.0 / 3.0], |t| t),
        ([0.0, 1.0 / 3.0], |t| t * t),
        ([0.0, 0.0], |t| t * t * t),
        ([0.0, 1.0], |t| 3.0 * t * t - 2.0 * t * t * t),
    ];
    for (values, expected) in table {
        let curve = curve(values);
        for k in 0..=20 {
            let t = f64::from(k) / 20.0;
            assert!((curve.at(5.0 + 2.0 * t) - expected(t)).abs() < 1e-11);
        }
    }
}

#[test]
fn bezier_curve_passes_points_of_its_segments() {
    let mut random = Random::new(102);
    for _ in 0..100 {
        let times = vec![0.0, 0.4, 2.0, 2.5];
        let values: Vec<DVec3> = (0..4).map(|_| point(&mut random)).collect();
        let interval = |key: usize| times.get(key + 1).map_or(1.0, |next| next - times[key]);
        let before = |key: usize| key.checked_sub(1).map_or(1.0, interval);
        let mut handles = Vec::new();
        for key in 0..4 {
            let [back, ahead] =
                [before(key), interval(key)].map(|interval| interval * random.unit());
            let [arriving, leaving] = [-back, ahead].map(|time| BezierHandle {
                time,
                value: point(&mut random),
            });
            handles.push([arriving, leaving]);
        }
        let curve = KeyedCurve::bezier(times.clone(), values.clone(), handles.clone()).unwrap();
        for key in 0..3 {
            let (leaving, arriving) = (handles[key][1], handles[key + 1][0]);
            for u in [0.05, 0.3, 0.5, 0.7, 0.95_f64] {
                let v = 1.0 - u;
                let basis = [v * v * v, 3.0 * v * v * u, 3.0 * v * u * u, u * u * u];
                let [a, b] = [times[key], times[key + 1]];
                let time: f64 = [a, a + leaving.time, b + arriving.time, b]
                    .iter()
                    .zip(basis)
                    .map(|(t, share)| t * share)
                    .sum();
                let [a, b] = [values[key], values[key + 1]];
                let value: DVec3 = [a, a + leaving.value, b + arriving.value, b]
                    .into_iter()
                    .zip(basis)
                    .map(|(p, share)| p * share)
                    .sum();
                // Steep curves move far within the rounding error of a time.
                let steep = 1.0 + curve.rate(time).length();
                assert!((curve.at(time) - value).length() < 1e-9 * steep);
                let h = 1e-6;
                let slope = (curve.at(time + h) - curve.at(time - h)) / (2.0 * h);
                if steep < 10.0 {
                    assert!((curve.rate(time) - slope).length() < 1e-3);
                }
            }
        }
    }
}

fn point(random: &mut Random) -> DVec3 {
    <[f64; 3]>::from(random.vector(1.0)).into()
}

/// With handles collinear through a key, the curve has one rate there from both sides.
#[test]
fn collinear_handles_give_one_rate() {
    let handles = vec![
        [handle(0.0, 0.0), handle(0.2, 0.7)],
        [handle(-0.3, -0.45), handle(0.5, 0.75)],
        [handle(-1.0, 0.0), handle(0.0, 0.0)],
    ];
    let curve = KeyedCurve::bezier(vec![0.0, 1.0, 3.0], vec![1.0, -1.0, 2.0], handles).unwrap();
    for time in [1.0 - 1e-9, 1.0] {
        assert!(
            (curve.rate(time) - 1.5).abs() < 1e-4,
            "{}",
            curve.rate(time)
        );
    }
    assert!(curve.rate(3.0 - 1e-9).abs() < 1e-4);
}

#[test]
fn clip_plays_eased_and_bezier_curves() {
    let bone = ArmatureBone {
        name: "door".into(),
        parent: None,
        rest: LocalTransform::IDENTITY,
    };
    let armature = Armature::new(vec![bone], vec!["creak".into()]).unwrap();
    let door = armature.bone("door").unwrap();
    let times = || vec![0.0, 2.0];
    let easings = || vec![Easing::CubicInOut, Easing::Linear];
    let moved = vec![Vec3A::ZERO, Vec3A::X];
    let moved = KeyedCurve::eased(times(), moved, easings()).unwrap();
    let turned = vec![Quat::IDENTITY, Quat::from_rotation_y(1.6)];
    let turned = RotationCurve::eased(times(), turned, easings()).unwrap();
    let handle = |time, value| BezierHandle { time, value };
    let creak = vec![
        [handle(0.0, 0.0), handle(2.0 / 3.0, 0.0)],
        [handle(-2.0 / 3.0, -1.0), handle(0.0, 0.0)],
    ];
    let creak = KeyedCurve::bezier(times(), vec![0.0, 1.0], creak).unwrap();
    let mut builder = Clip::builder("opens", &armature);
    builder.channel(door, Channel::Translation(moved)).unwrap();
    builder.channel(door, Channel::Rotation(turned)).unwrap();
    builder.morph_weight(0, creak).unwrap();
    let clip = builder.build();
    let (mut pose, mut cursor) = (armature.rest().clone(), Cursor::new());
    for (time, share) in [
        (0.0, 0.0),
        (0.5, 0.0625),
        (1.0, 0.5),
        (1.5, 0.9375),
        (2.0, 1.0),
    ] {
        clip.sample(time, Playback::Hold, &mut cursor, &mut pose)
            .unwrap();
        assert!((pose.translations()[0].x - share).abs() < 1e-6);
        let expected = Quat::from_rotation_y(1.6 * share);
        assert!(pose.rotations()[0].abs_diff_eq(expected, 1e-6), "{time} s");
        let cubed = (time as f32 / 2.0).powi(3);
        assert!((pose.morph_weights()[0] - cubed).abs() < 1e-6);
    }
}

#[test]
fn invalid_curves_are_rejected_by_name() {
    let two = |handles: [[BezierHandle<f64>; 2]; 2]| {
        KeyedCurve::bezier(vec![0.0, 2.0], vec![0.0, 1.0], handles.to_vec())
    };
    let still = handle(0.0, 0.0);
    // Values outside of the keys have no effect.
    assert!(two([[handle(5.0, 1.0), still], [still, handle(-5.0, 1.0)]]).is_ok());
    assert!(two([[still, handle(2.0, 9.0)], [handle(-2.0, 9.0), still]]).is_ok());
    for (leaving, arriving, side, key) in [
        (handle(-0.1, 0.0), still, "leaving", 0),
        (handle(2.1, 0.0), still, "leaving", 0),
        (still, handle(0.1, 0.0), "arriving", 1),
        (still, handle(-2.1, 0.0), "arriving", 1),
    ] {
        let error = two([[still, leaving], [arriving, still]]).unwrap_err();
        assert!(
            matches!(error, KeyError::HandleTime { key: k, side: s, interval: 2.0, .. } if (k, s) == (key, side)),
            "{error}"
        );
    }
    let error = two([[still; 2], [handle(0.0, f64::NAN), still]]).unwrap_err();
    let what = "handle";
    assert_eq!(error, KeyError::NonFiniteValue { key: 1, what });
    let error = KeyedCurve::bezier(vec![0.0, 1.0], vec![0.0, 1.0], vec![]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "0 pairs of handles for 2 keys; there must be one for each key"
    );
    let error = KeyedCurve::eased(vec![0.0, 1.0], vec![0.0, 1.0], vec![Easing::Linear]);
    assert_eq!(
        error.unwrap_err().to_string(),
        "1 easings for 2 keys; there must be one for each key"
    );
    let error = RotationCurve::eased(vec![0.0], vec![Quat::IDENTITY], vec![]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "0 easings for 1 keys; there must be one for each key"
    );
    let empty = RotationCurve::slerp(vec![], vec![]).unwrap_err();
    assert_eq!(empty, KeyError::Empty);
    let empty: Result<KeyedCurve<f64>, _> = KeyedCurve::eased(vec![], vec![], vec![]);
    assert_eq!(empty, Err(KeyError::Empty));
}
