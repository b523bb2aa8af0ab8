//! Promise: easings start at 0, end at 1, pass the middle where their formulas say, and a drawn
//! easing is solved for its time.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod support;

use kinopt::animation::{BezierEasing, Easing};
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
fn the_sources_formulas() {
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
fn out_is_in_turned_round() {
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
fn a_drawn_easing_passes_the_points_of_its_curve() {
    let mut random = Random::new(21);
    for case in 0..300 {
        let mut unit = || random.unit() as f32;
        let [first, second] = match case {
            0 => [[1.0, 0.0], [0.0, 1.0]],
            1 => [[0.0, 0.0], [1.0, 1.0]],
            2 => [[0.0, 1.0], [0.0, 1.0]],
            _ => [[unit(), 3.0 * unit() - 1.0], [unit(), 3.0 * unit() - 1.0]],
        };
        let easing = BezierEasing::new(first, second).unwrap();
        assert_eq!([easing.at(0.0), easing.at(1.0)], [0.0, 1.0]);
        for k in 1..40 {
            let u = f64::from(k) / 40.0;
            let along = |axis: usize| {
                let (b, c) = (f64::from(first[axis]), f64::from(second[axis]));
                3.0 * (1.0 - u).powi(2) * u * b + 3.0 * (1.0 - u) * u * u * c + u.powi(3)
            };
            // Rounding the time to single precision moves the value by the slope times it.
            let slope_in_time = 3.0 * (1.0 - u).powi(2) * f64::from(first[0])
                + 6.0 * (1.0 - u) * u * f64::from(second[0] - first[0])
                + 3.0 * u * u * f64::from(1.0 - second[0]);
            if slope_in_time > 1e-2 {
                let got = f64::from(easing.at(along(0) as f32));
                assert!((got - along(1)).abs() < 1e-4, "{case} {u}: {got}");
            }
        }
    }
}

#[test]
fn handles_that_run_backwards_are_refused() {
    for handle in [
        [-0.1, 0.0],
        [1.1, 0.0],
        [f32::NAN, 0.0],
        [0.5, f32::INFINITY],
    ] {
        let error = BezierEasing::new(handle, [1.0, 1.0]).unwrap_err();
        assert!(error.to_string().contains("within [0, 1]"), "{error}");
        assert!(BezierEasing::new([0.0, 0.0], handle).is_err());
    }
}
