//! Promise: easings start at 0, end at 1, and have the value of their formula in the middle. A Bézier easing is solved
//! for its time.

use kinopt::animation::{BezierEasing, Easing};
use support::fault_tables::ExpectedError;
use support::random::Random;

#[test]
fn ends_and_middles() {
    let middles = [0.5, 0.25, 0.75, 0.5, 0.125, 0.875, 0.5];
    for (easing, middle) in Easing::ALL.into_iter().zip(middles) {
        assert_eq!(easing.at(0.0), 0.0, "{easing:?}");
        assert_eq!(easing.at(1.0), 1.0, "{easing:?}");
        assert_eq!(easing.at(0.5), middle, "{easing:?}");
        assert_eq!([easing.at(-3.0), easing.at(f32::NAN)], [0.0; 2]);
        assert_eq!(easing.at(7.0), 1.0);
        let steps: Vec<f32> = (0..=100).map(|k| easing.at(k as f32 / 100.0)).collect();
        assert!(steps.is_sorted(), "{easing:?}");
    }
}

#[test]
fn easings_equal_the_documented_formulas() {
    for k in 0..=64 {
        let t = k as f32 / 64.0;
        assert_eq!(Easing::QuadraticIn.at(t), t * t);
        assert_eq!(Easing::QuadraticOut.at(t), t * (2.0 - t));
        let expected = if t < 0.5 {
            4.0 * t * t * t
        } else {
            1.0 - (-2.0 * t + 2.0).powi(3) / 2.0
        };
        assert!((Easing::CubicInOut.at(t) - expected).abs() < 1e-7);
    }
}

#[test]
fn ease_out_mirrors_ease_in() {
    let pairs = [
        (Easing::QuadraticIn, Easing::QuadraticOut),
        (Easing::CubicIn, Easing::CubicOut),
        (Easing::QuadraticInOut, Easing::QuadraticInOut),
        (Easing::CubicInOut, Easing::CubicInOut),
        (Easing::Linear, Easing::Linear),
    ];
    for (easing_in, easing_out) in pairs {
        for k in 0..=50 {
            let t = k as f32 / 50.0;
            assert!((easing_in.at(t) - (1.0 - easing_out.at(1.0 - t))).abs() < 1e-6);
        }
    }
}

#[test]
fn bezier_easing_passes_points_of_its_curve() {
    let mut random = Random::new(21);
    for case in 0..300 {
        let mut unit = || random.unit() as f32;
        let [first, second] = match case {
            0 => [[1.0, 0.0], [0.0, 1.0]],
            1 => [[0.0, 0.0], [1.0, 1.0]],
            2 => [[0.0, 1.0], [0.0, 1.0]],
            _ => [[unit(), 3.0 * unit() - 1.0], [unit(), 3.0 * unit() - 1.0]],
        };
        let easing = Easing::from(BezierEasing::new(first, second).unwrap());
        assert_eq!([easing.at(0.0), easing.at(1.0)], [0.0, 1.0]);
        for k in 1..40 {
            let u = f64::from(k) / 40.0;
            let along = |axis: usize| {
                let (b, c) = (f64::from(first[axis]), f64::from(second[axis]));
                3.0 * (1.0 - u).powi(2) * u * b + 3.0 * (1.0 - u) * u * u * c + u.powi(3)
            };
            // The rounding of time to single precision changes the value by the slope times it.
            let slope_in_time = 3.0 * (1.0 - u).powi(2) * f64::from(first[0])
                + 6.0 * (1.0 - u) * u * f64::from(second[0] - first[0])
                + 3.0 * u * u * f64::from(1.0 - second[0]);
            if slope_in_time > 1e-2 {
                let actual = f64::from(easing.at(along(0) as f32));
                assert!((actual - along(1)).abs() < 1e-4, "{case} {u}: {actual}");
            }
        }
    }
}

/// CSS's `ease`, `ease-in`, `ease-out` and `ease-in-out`, bisected in decimal arithmetic of 40 digits.
#[test]
fn bezier_easings_match_css() {
    let table = [
        (
            [[0.25, 0.1], [0.25, 1.0]],
            [0.408_510_591_355, 0.802_403_387_585, 0.960_458_978_349],
        ),
        (
            [[0.42, 0.0], [1.0, 1.0]],
            [0.093_464_650_719, 0.315_356_812_573, 0.621_861_869_175],
        ),
        (
            [[0.0, 0.0], [0.58, 1.0]],
            [0.378_138_130_825, 0.684_643_187_427, 0.906_535_349_281],
        ),
        (
            [[0.42, 0.0], [0.58, 1.0]],
            [0.129_161_931_047, 0.500_000_000_000, 0.870_838_068_953],
        ),
    ];
    for (handles, values) in table {
        let [first, second] = handles.map(|handle| handle.map(|x| x as f32));
        let easing = Easing::Bezier(BezierEasing::new(first, second).unwrap());
        for (k, value) in (1..).zip(values) {
            let actual = easing.at(0.25 * f64::from(k));
            // Handles are stored in single precision.
            assert!(
                (actual - value).abs() < 1e-7,
                "{handles:?}: {actual}, not {value}"
            );
        }
    }
}

#[test]
fn rate_is_the_derivative() {
    let drawn = [
        [[0.42, 0.0], [0.58, 1.0]],
        [[0.0, 0.0], [1.0, 1.0]],
        [[0.2, -0.5], [0.9, 1.5]],
    ]
    .map(|[first, second]| BezierEasing::new(first, second).unwrap().into());
    for easing in Easing::ALL.into_iter().chain(drawn) {
        for k in 1..50 {
            let (t, h) = (f64::from(k) / 50.0, 1e-5);
            let slope = (easing.at(t + h) - easing.at(t - h)) / (2.0 * h);
            // The second derivative of in-out easings jumps in the middle.
            assert!((easing.rate(t) - slope).abs() < 1e-4, "{easing:?} at {t}");
        }
    }
    // One-sided at the ends: a Bézier easing starts along its first handle.
    let easing = Easing::from(BezierEasing::new([0.5, 0.25], [0.5, 1.0]).unwrap());
    let [leaving, arriving] = [0.0, 1.0].map(|t: f64| easing.rate(t));
    assert!((leaving - 0.5).abs() < 1e-4 && arriving.abs() < 1e-4);
    let upright = Easing::from(BezierEasing::new([0.0, 1.0], [1.0, 1.0]).unwrap());
    assert!(upright.rate(0.0_f64) > 1e5 && upright.rate(0.0_f64).is_finite());
}

#[test]
fn bezier_easing_is_two_handles_in_json() {
    let text = r#"{"bezier":[[0.25,0.5],[0.75,1.0]]}"#;
    let easing: Easing = serde_json::from_str(text).unwrap();
    let drawn = BezierEasing::new([0.25, 0.5], [0.75, 1.0]).unwrap();
    assert_eq!(drawn.handles(), [[0.25, 0.5], [0.75, 1.0]]);
    assert_eq!(easing, drawn.into());
    assert_eq!(serde_json::to_string(&easing).unwrap(), text);
    let backwards = r#"{"bezier": [[-0.25, 0.5], [0.75, 1.0]]}"#;
    serde_json::from_str::<Easing>(backwards).says("-0.25");
}

#[test]
fn handles_running_backwards_are_rejected() {
    for handle in [
        [-0.1, 0.0],
        [1.1, 0.0],
        [f32::NAN, 0.0],
        [0.5, f32::INFINITY],
    ] {
        BezierEasing::new(handle, [1.0, 1.0]).says("within [0, 1]");
        assert!(BezierEasing::new([0.0, 0.0], handle).is_err());
    }
}

/// With both handles on the ends the curve is a straight line whose parameter has rate zero there.
#[test]
fn handles_on_the_ends_give_constant_speed() {
    let line = Easing::from(BezierEasing::new([0.0, 0.0], [1.0, 1.0]).unwrap());
    for time in [0.0_f64, 1e-3, 0.3, 1.0] {
        assert!((line.at(time) - time).abs() < 1e-9, "{time}");
        assert!((line.rate(time) - 1.0).abs() < 1e-6, "{time}");
    }
}
