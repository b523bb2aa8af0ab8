//! Promise: so it is for curves of every kind, through numbers and vectors of every sort, between and outside their keys, as
//! files, and in the words by which keys are refused.
#![allow(clippy::unwrap_used)]

use glam::{DVec2, DVec3, DVec4, Vec2, Vec3, Vec3A, Vec4};
use kinopt::animation::curve::{
    BezierHandle, CubicBezier, CurveValue, Hermite, KeyedCurve, Knots, Real, TensionContinuityBias,
    catmull_rom, catmull_rom_at_knots, repair_keys,
};
use kinopt::animation::{BezierEasing, Easing};
use serde::Serialize;
use serde::de::DeserializeOwned;
use support::random::Random;

use crate::animated::check_single;
use crate::digest::{Digest, Value};

/// What curves run through, as numbers.
trait Drawn: CurveValue<Real: Serialize + DeserializeOwned> + Serialize + DeserializeOwned {
    fn of(random: &mut Random) -> Self;
    fn numbers(self) -> Vec<f64>;
}

macro_rules! drawn {
    ($($vector:ty: $real:ty),*) => {$(
        impl Drawn for $vector {
            fn of(random: &mut Random) -> Self {
                Self::from_array(std::array::from_fn(|_| random.within(-2.0, 2.0) as $real))
            }
            fn numbers(self) -> Vec<f64> {
                self.to_array().map(f64::from).to_vec()
            }
        }
    )*};
}
drawn!(Vec2: f32, Vec3: f32, Vec3A: f32, Vec4: f32, DVec2: f64, DVec3: f64, DVec4: f64);

macro_rules! drawn_number {
    ($($real:ty),*) => {$(
        impl Drawn for $real {
            fn of(random: &mut Random) -> Self {
                random.within(-2.0, 2.0) as $real
            }
            fn numbers(self) -> Vec<f64> {
                vec![f64::from(self)]
            }
        }
    )*};
}
drawn_number!(f32, f64);

/// Handles that leave slowly, upright, and straight on.
fn easings() -> Vec<Easing> {
    let drawn = [
        [[0.42, 0.0], [0.58, 1.0]],
        [[0.9, -0.7], [0.1, 1.6]],
        [[0.0, 1.0], [1.0, 0.0]],
        [[0.0, 0.0], [1.0, 1.0]],
    ];
    let drawn = drawn.map(|[a, b]| Easing::Bezier(BezierEasing::new(a, b).unwrap()));
    Easing::ALL.into_iter().chain(drawn).collect()
}

fn eased() -> Value {
    let mut digest = Digest::new();
    for easing in easings() {
        for k in -1..=21 {
            let t = 0.05 * f64::from(k);
            digest.doubles([easing.at(t), easing.rate(t)]);
            digest.singles([easing.at(t as f32), easing.rate(t as f32)]);
        }
        digest.doubles([f64::NAN, 0.5, 1.0].map(|t| easing.at(t)));
        digest.doubles([f64::NAN, 0.5, 1.0].map(|t| easing.rate(t)));
        digest.json(&easing);
        let text = serde_json::to_string(&easing).unwrap();
        assert_eq!(serde_json::from_str::<Easing>(&text).unwrap(), easing);
    }
    digest.json(&Easing::default());
    for [first, second] in [
        [[-0.1, 0.0], [0.5, 0.5]],
        [[0.1, 0.0], [1.5, 0.5]],
        [[0.1, f32::NAN], [0.5, 0.5]],
        [[0.1, 0.0], [f32::NAN, 0.5]],
    ] {
        digest.refused(BezierEasing::new(first, second));
    }
    digest.refused(serde_json::from_str::<Easing>(
        r#"{"bezier": [[2, 0], [0.5, 1]]}"#,
    ));
    digest.value()
}

/// Keys that are not evenly spaced.
fn times<R: Real>(count: usize) -> Vec<R> {
    let all = [-0.5, 0.25, 0.5, 1.5, 1.75, 3.0];
    all[..count].iter().map(|&t| R::from_f64(t)).collect()
}

/// Every way between these keys.
fn curves<V: Drawn>(random: &mut Random, count: usize) -> Vec<KeyedCurve<V>> {
    let values: Vec<V> = (0..count).map(|_| V::of(random)).collect();
    let rates = (0..count).map(|_| [V::of(random), V::of(random)]);
    let (rates, at) = (rates.collect(), || times::<V::Real>(count));
    let easings = easings().into_iter().rev().take(count).collect();
    let handle = |time: f64, value: V| BezierHandle {
        time: V::Real::from_f64(time),
        value,
    };
    let shares = [
        [0.0, 0.75],
        [-0.3, 0.25],
        [-0.25, 0.0],
        [-0.9, 0.1],
        [-0.1, 1.25],
        [0.0, 9.0],
    ];
    let handles = shares[..count].iter();
    let handles = handles.map(|sides| sides.map(|time| handle(time, V::of(random))));
    let handles = handles.collect();
    let mut control = || TensionContinuityBias {
        tension: random.within(-1.0, 1.0) as f32,
        continuity: random.within(-1.0, 1.0) as f32,
        bias: random.within(-1.0, 1.0) as f32,
    };
    let controls: Vec<_> = (0..count).map(|_| control()).collect();
    let through = |knots| KeyedCurve::through(values.clone(), knots).unwrap();
    vec![
        KeyedCurve::step(at(), values.clone()).unwrap(),
        KeyedCurve::linear(at(), values.clone()).unwrap(),
        KeyedCurve::eased(at(), values.clone(), easings).unwrap(),
        KeyedCurve::bezier(at(), values.clone(), handles).unwrap(),
        KeyedCurve::cubic(at(), values.clone(), rates).unwrap(),
        KeyedCurve::catmull_rom(at(), values.clone()).unwrap(),
        KeyedCurve::kochanek_bartels(at(), values.clone(), &controls).unwrap(),
        through(Knots::Uniform),
        through(Knots::Centripetal),
        through(Knots::Chordal),
    ]
}

fn keyed<V: Drawn>(digest: &mut Digest, random: &mut Random) {
    for count in [1, 2, 6] {
        for curve in curves::<V>(random, count) {
            digest.json(&curve);
            let text = serde_json::to_string(&curve).unwrap();
            let again: KeyedCurve<V> = serde_json::from_str(&text).unwrap();
            let keys: Vec<f64> = curve.times().iter().map(|t| t.as_f64()).collect();
            let between = keys.windows(2).map(|k| 0.7 * k[0] + 0.3 * k[1]);
            let outside = [keys[0] - 1.0, keys[count - 1] + 1.0, f64::NAN];
            for time in between.chain(keys.iter().copied()).chain(outside) {
                let time = V::Real::from_f64(time);
                digest.doubles(again.at(time).numbers());
                digest.doubles(again.rate(time).numbers());
            }
            digest.doubles(curve.values().iter().flat_map(|v| v.numbers()));
        }
    }
}

fn segments<V: Drawn>(digest: &mut Digest, random: &mut Random) {
    for k in 0..4 {
        let points: [V; 4] = std::array::from_fn(|_| V::of(random));
        let u = V::Real::from_f64(0.1 + 0.25 * f64::from(k));
        let bezier = CubicBezier::new(points);
        digest.doubles(bezier.position(u).numbers());
        digest.doubles(bezier.tangent(u).numbers());
        for half in bezier.split(u) {
            digest.doubles(half.points.into_iter().flat_map(V::numbers));
        }
        let [start, leaving, end, arriving] = points;
        let hermite = Hermite {
            start,
            leaving,
            end,
            arriving,
        };
        digest.doubles(hermite.position(u).numbers());
        digest.doubles(hermite.tangent(u).numbers());
        digest.doubles(catmull_rom(points, u).numbers());
        let [a, b, c, d] = points;
        for points in [points, [a, a, c, d], [a, b, c, c], [a, b, b, d], [a; 4]] {
            for knots in [Knots::Uniform, Knots::Centripetal, Knots::Chordal] {
                let at = knots.of(&points);
                digest.doubles(at.map(|knot| knot.as_f64()));
                digest.doubles(catmull_rom_at_knots(points, at, u).numbers());
            }
        }
    }
}

fn refusals() -> Value {
    let (mut digest, nan) = (Digest::new(), f64::NAN);
    let two = || vec![1.0, 2.0];
    let handle = |time, value| BezierHandle { time, value };
    let flat = [handle(0.0, 0.0); 2];
    for curve in [
        KeyedCurve::step(vec![], vec![]),
        KeyedCurve::linear(two(), vec![1.0]),
        KeyedCurve::linear(vec![1.0, nan], two()),
        KeyedCurve::step(vec![2.0, 2.0], two()),
        KeyedCurve::step(vec![1.0, 3.0, 2.5], vec![0.0; 3]),
        KeyedCurve::linear(two(), vec![1.0, f64::INFINITY]),
        KeyedCurve::eased(two(), two(), vec![Easing::Linear]),
        KeyedCurve::cubic(two(), two(), vec![[0.0; 2]; 3]),
        KeyedCurve::cubic(two(), two(), vec![[0.0; 2], [0.0, nan]]),
        KeyedCurve::bezier(two(), two(), vec![flat]),
        KeyedCurve::bezier(two(), two(), vec![flat, [handle(nan, 0.0); 2]]),
        KeyedCurve::bezier(two(), two(), vec![[handle(0.0, nan); 2], flat]),
        KeyedCurve::bezier(two(), two(), vec![[flat[0], handle(-0.5, 0.0)], flat]),
        KeyedCurve::bezier(two(), two(), vec![[flat[0], handle(1.5, 0.0)], flat]),
        KeyedCurve::bezier(two(), two(), vec![flat, [handle(0.25, 0.0), flat[1]]]),
        KeyedCurve::bezier(two(), two(), vec![flat, [handle(-1.25, 0.0), flat[1]]]),
        KeyedCurve::kochanek_bartels(two(), two(), &[TensionContinuityBias::default()]),
        KeyedCurve::catmull_rom(two(), vec![0.0; 3]),
        KeyedCurve::through(vec![], Knots::Uniform),
        KeyedCurve::through(vec![0.0, nan], Knots::Uniform),
        KeyedCurve::through(vec![0.0, 1.0, 1.0], Knots::Chordal),
        KeyedCurve::through(vec![0.0, 0.0, 1.0], Knots::Centripetal),
    ] {
        digest.refused(curve);
    }
    let text = r#"{"times":[1,1],"values":[0,1],"between":"Linear"}"#;
    digest.refused(serde_json::from_str::<KeyedCurve<f64>>(text));
    let same = KeyedCurve::through(vec![3.0, 3.0, 1.0], Knots::Uniform).unwrap();
    digest.doubles([0.0, 0.5, 1.5].map(|t| same.at(t)));
    digest.value()
}

fn repairs() -> Value {
    let (mut digest, nan) = (Digest::new(), f32::NAN);
    for keys in [
        vec![],
        vec![(0.0, 1), (1.0, 2)],
        vec![(1.0, 1), (0.0, 2), (1.0, 3), (nan, 4), (2.0, -1), (1.0, 5)],
        vec![(0.0, 1), (0.0, 2)],
        vec![(0.5, -1), (f32::INFINITY, 2)],
    ] {
        let mut own = keys;
        let repair = repair_keys(&mut own, |&value| value >= 0);
        digest.debug((repair, repair.is_clean(), own));
    }
    digest.value()
}

#[test]
fn of_curves() {
    let (mut keys, mut parts, mut random) = (Digest::new(), Digest::new(), Random::new(91));
    macro_rules! each {
        ($($value:ty),*) => {$(
            keyed::<$value>(&mut keys, &mut random);
            segments::<$value>(&mut parts, &mut random);
        )*};
    }
    each!(f32, f64, Vec2, Vec3, Vec3A, Vec4, DVec2, DVec3, DVec4);
    let rates = TensionContinuityBias::default().rates(1.0, 3.0, 0.5);
    parts.doubles(rates);
    check_single(&[
        ("curves through keys", keys.value()),
        ("curves between two points", parts.value()),
        ("easing", eased()),
        ("curves: what is refused", refusals()),
        ("curves: what is repaired", repairs()),
    ]);
}
