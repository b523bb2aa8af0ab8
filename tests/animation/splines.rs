//! Promise: splines pass through their points, join without a kink, and equal the classic splines where those are
//! defined.

use glam::DVec3;
use kinopt::animation::curve::{
    CubicBezier, KeyError, KeyRepair, KeyedCurve, Knots, TensionContinuityBias, catmull_rom,
    catmull_rom_at_knots, lerp, repair_keys,
};
use support::fault_tables::ExpectedError;
use support::random::Random;

fn points<const N: usize>(random: &mut Random) -> [DVec3; N] {
    std::array::from_fn(|_| DVec3::from(<[f64; 3]>::from(random.vector(1.0))))
}

/// Barry and Goldman's pyramid as in their paper.
fn pyramid(p: [DVec3; 4], t: [f64; 4], u: f64) -> DVec3 {
    let at = t[1] + u * (t[2] - t[1]);
    let between = |a: DVec3, b: DVec3, from: f64, to: f64| {
        a * ((to - at) / (to - from)) + b * ((at - from) / (to - from))
    };
    let a: Vec<DVec3> = (0..3)
        .map(|i| between(p[i], p[i + 1], t[i], t[i + 1]))
        .collect();
    let b: Vec<DVec3> = (0..2)
        .map(|i| between(a[i], a[i + 1], t[i], t[i + 2]))
        .collect();
    between(b[0], b[1], t[1], t[2])
}

#[test]
fn any_knots_equal_the_pyramid_algorithm() {
    let mut random = Random::new(32);
    for _ in 0..100 {
        let p: [DVec3; 4] = points(&mut random);
        for knots in [Knots::Uniform, Knots::Centripetal, Knots::Chordal] {
            let t = knots.of(&p);
            for u in [0.0, 0.1, 0.5, 0.9, 1.0] {
                let deviation = (catmull_rom_at_knots(p, t, u) - pyramid(p, t, u)).length();
                assert!(deviation < 1e-12, "{knots:?} {deviation}");
                if knots == Knots::Uniform {
                    assert!((catmull_rom(p, u) - pyramid(p, t, u)).length() < 1e-14);
                }
            }
        }
    }
}

#[test]
fn path_through_points_equals_its_segments() {
    let mut random = Random::new(37);
    for knots in [Knots::Uniform, Knots::Centripetal, Knots::Chordal] {
        let p: [DVec3; 9] = points(&mut random);
        let t = knots.of(&p);
        let path = KeyedCurve::through(p.to_vec(), knots).unwrap();
        for (ours, expected) in path.times().iter().zip(t) {
            assert!((ours - expected).abs() < 1e-14);
        }
        for i in 1..7 {
            let points = [p[i - 1], p[i], p[i + 1], p[i + 2]];
            let at = [t[i - 1], t[i], t[i + 1], t[i + 2]];
            for u in [0.0, 0.2, 0.5, 0.9] {
                let expected = catmull_rom_at_knots(points, at, u);
                let actual = path.at(lerp(t[i], t[i + 1], u));
                assert!((actual - expected).length() < 1e-12, "{knots:?} {i} {u}");
            }
        }
        // The first segment uses the mirror image of its end at its start as its neighbour.
        let mirrored = [p[0] * 2.0 - p[1], p[0], p[1], p[2]];
        let at = [-t[1], 0.0, t[1], t[2]];
        for u in [0.1, 0.5, 0.8] {
            let expected = catmull_rom_at_knots(mirrored, at, u);
            assert!((path.at(u * t[1]) - expected).length() < 1e-12);
        }
        assert_eq!([path.at(-1.0), path.at(t[8] + 1.0)], [p[0], p[8]]);
    }
    let twice = vec![DVec3::X, DVec3::Y, DVec3::Y, DVec3::Z];
    assert!(KeyedCurve::through(twice.clone(), Knots::Uniform).is_ok());
    let error = KeyedCurve::through(twice, Knots::Centripetal).unwrap_err();
    assert_eq!(error, KeyError::SamePlace { point: 2 });
    let none = KeyedCurve::through(Vec::<DVec3>::new(), Knots::Chordal);
    assert_eq!(none, Err(KeyError::Empty));
    let one = KeyedCurve::through(vec![DVec3::X], Knots::Chordal).unwrap();
    assert_eq!(one.at(4.0), DVec3::X);
    // The error names the point, not the invalid knots.
    for knots in [Knots::Uniform, Knots::Chordal] {
        let error = KeyedCurve::through(vec![DVec3::NAN, DVec3::X], knots).unwrap_err();
        let what = "point";
        assert_eq!(error, KeyError::NonFiniteValue { key: 0, what });
    }
}

#[test]
fn centripetal_segment_does_not_overshoot() {
    // Two near points between two distant ones: the uniform spline loops there.
    let p = [(-10.0, 5.0), (0.0, 0.0), (0.1, 0.0), (10.0, 5.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
    let lowest = |knots: Knots| {
        let t = knots.of(&p);
        let along = (0..=100).map(|k| catmull_rom_at_knots(p, t, f64::from(k) / 100.0));
        let x: Vec<f64> = along.map(|point| point.x).collect();
        x.windows(2)
            .map(|w| w[1] - w[0])
            .fold(f64::INFINITY, f64::min)
    };
    let [uniform, centripetal] = [lowest(Knots::Uniform), lowest(Knots::Centripetal)];
    assert!(
        uniform < 0.0 && centripetal >= 0.0,
        "{uniform} {centripetal}"
    );
    let same = [p[0], p[1], p[1], p[3]];
    assert_eq!(
        catmull_rom_at_knots(same, Knots::Centripetal.of(&same), 0.5),
        p[1]
    );
    let doubled = [p[1], p[1], p[2], p[2]];
    let middle = catmull_rom_at_knots(doubled, Knots::Centripetal.of(&doubled), 0.5);
    assert!((middle - (p[1] + p[2]) * 0.5).length() < 1e-15);
}

#[test]
fn split_bezier_is_the_same_curve() {
    let mut random = Random::new(33);
    for _ in 0..50 {
        let curve = CubicBezier::new(points(&mut random));
        let at = random.unit();
        let [before, after] = curve.split(at);
        for u in [0.0, 0.3, 0.6, 1.0] {
            assert!((before.position(u) - curve.position(at * u)).length() < 1e-14);
            assert!((after.position(u) - curve.position(lerp(at, 1.0, u))).length() < 1e-14);
        }
        let [p0, p1, p2, p3] = curve.points;
        assert_eq!([curve.position(0.0), curve.position(1.0)], [p0, p3]);
        assert!((curve.tangent(0.0) - (p1 - p0) * 3.0).length() < 1e-15);
        assert!((curve.tangent(1.0) - (p3 - p2) * 3.0).length() < 1e-15);
    }
}

/// No point of a Bézier curve is further in any direction than the furthest of its control points.
#[test]
fn bezier_stays_within_its_hull() {
    let mut random = Random::new(36);
    for _ in 0..50 {
        let curve = CubicBezier::new(points(&mut random));
        for _ in 0..40 {
            let [out] = points::<1>(&mut random);
            let along_outward = |p: DVec3| p.dot(out);
            let furthest = curve
                .points
                .map(along_outward)
                .into_iter()
                .fold(f64::MIN, f64::max);
            for u in 0..=20 {
                assert!(along_outward(curve.position(f64::from(u) / 20.0)) <= furthest + 1e-14);
            }
        }
    }
}

fn keys(random: &mut Random) -> (Vec<f64>, Vec<DVec3>) {
    let mut time = -1.0;
    let times = (0..7).map(|_| {
        time += random.within(0.05, 2.0);
        time
    });
    (times.collect(), points::<7>(random).to_vec())
}

#[test]
fn keyed_curves_pass_keys_and_hold_the_ends() {
    let mut random = Random::new(34);
    let (times, values) = keys(&mut random);
    let (t, v) = (times.clone(), values.clone());
    let tcb = [TensionContinuityBias {
        tension: 0.3,
        continuity: -0.2,
        bias: 0.5,
    }; 7];
    let tangents = values.iter().map(|v| [*v, -*v]).collect();
    let curves = [
        KeyedCurve::step(t.clone(), v.clone()),
        KeyedCurve::linear(t.clone(), v.clone()),
        KeyedCurve::cubic(t.clone(), v.clone(), tangents),
        KeyedCurve::catmull_rom(t.clone(), v.clone()),
        KeyedCurve::kochanek_bartels(t, v, &tcb),
    ];
    for curve in curves.map(Result::unwrap) {
        for (&time, &value) in times.iter().zip(&values) {
            assert_eq!(curve.at(time), value);
        }
        assert_eq!([curve.at(-1e9), curve.at(1e9)], [values[0], values[6]]);
        assert_eq!(curve.at(f64::NAN), values[0]);
        assert_eq!([curve.rate(-1e9), curve.rate(times[6])], [DVec3::ZERO; 2]);
        // The rate is the derivative.
        for pair in times.windows(2) {
            let at = lerp(pair[0], pair[1], 0.37);
            let h = 1e-6;
            let slope = (curve.at(at + h) - curve.at(at - h)) / (2.0 * h);
            assert!((curve.rate(at) - slope).length() < 1e-6 * (1.0 + slope.length()));
        }
    }
    let step = KeyedCurve::step(times.clone(), values.clone()).unwrap();
    assert_eq!(step.at(times[3] - 1e-9), values[2]);
}

#[test]
fn tension_continuity_and_bias_have_effect() {
    let mut random = Random::new(35);
    let (times, values) = keys(&mut random);
    let with = |tcb: TensionContinuityBias| {
        KeyedCurve::kochanek_bartels(times.clone(), values.clone(), &[tcb; 7]).unwrap()
    };
    let plain = TensionContinuityBias::default();
    let rates = |curve: &KeyedCurve<DVec3>, key: usize| {
        let before = curve.rate(times[key] - 1e-9);
        [before, curve.rate(times[key])]
    };
    let slope = |key: usize| (values[key + 1] - values[key]) / (times[key + 1] - times[key]);
    for key in 1..6 {
        let [arriving, leaving] = rates(&with(plain), key);
        let expected = (values[key + 1] - values[key - 1]) / (times[key + 1] - times[key - 1]);
        assert!((arriving - expected).length() < 1e-6 && (leaving - expected).length() < 1e-12);
        let [_, stopped] = rates(
            &with(TensionContinuityBias {
                tension: 1.0,
                ..plain
            }),
            key,
        );
        assert!(stopped.length() < 1e-12);
        let [_, doubled] = rates(
            &with(TensionContinuityBias {
                tension: -1.0,
                ..plain
            }),
            key,
        );
        assert!((doubled - expected * 2.0).length() < 1e-12);
        // With full bias, only one side counts; with a broken continuity each side is straight.
        let [_, post] = rates(&with(TensionContinuityBias { bias: 1.0, ..plain }), key);
        assert!(post.cross(slope(key - 1)).length() < 1e-12 && post.dot(slope(key - 1)) > 0.0);
        let corner = rates(
            &with(TensionContinuityBias {
                continuity: -1.0,
                ..plain
            }),
            key,
        );
        assert!(corner[0].cross(slope(key - 1)).length() < 1e-6);
        assert!(corner[1].cross(slope(key)).length() < 1e-12);
    }
}

#[test]
fn invalid_keys_are_named_or_repaired() {
    type Scalar = Result<KeyedCurve<f32>, KeyError>;
    let curve = |times: &[f32], values: &[f32]| -> Scalar {
        KeyedCurve::linear(times.to_vec(), values.to_vec())
    };
    assert_eq!(curve(&[], &[]), Err(KeyError::Empty));
    let nan = curve(&[0.0, f32::NAN], &[1.0, 2.0]).unwrap_err();
    assert!(
        matches!(nan, KeyError::NonFiniteTime { key: 1, .. }),
        "{nan}"
    );
    let unsorted = curve(&[0.0, 2.0, 1.0], &[0.0; 3]).unwrap_err();
    assert_eq!(
        unsorted,
        KeyError::NotIncreasing {
            key: 2,
            time: 1.0,
            previous: 2.0
        }
    );
    curve(&[0.0, 0.0], &[0.0; 2]).says("key 1");
    let value = curve(&[0.0], &[f32::INFINITY]).unwrap_err();
    assert!(matches!(
        value,
        KeyError::NonFiniteValue {
            key: 0,
            what: "value"
        }
    ));
    curve(&[0.0, 1.0, 2.0], &[0.0, f32::NAN, f32::NAN]).says("key 1");
    let count = curve(&[0.0], &[1.0, 2.0]).unwrap_err();
    assert_eq!(
        count.to_string(),
        "2 values for 1 keys; there must be one for each key"
    );
    let tangents = KeyedCurve::cubic(vec![0.0], vec![1.0], vec![[f32::NAN; 2]]).unwrap_err();
    assert!(matches!(
        tangents,
        KeyError::NonFiniteValue {
            what: "tangent",
            ..
        }
    ));

    let mut keys = vec![
        (2.0, 1.0),
        (f32::NAN, 2.0),
        (0.0, 3.0),
        (2.0, 4.0),
        (1.0, f32::NAN),
    ];
    let repair = repair_keys(&mut keys, |value: &f32| value.is_finite());
    assert_eq!(keys, [(0.0, 3.0), (2.0, 4.0)]);
    let expected = KeyRepair {
        not_finite: 2,
        sorted: true,
        duplicates: 1,
    };
    assert_eq!(repair, expected);
    assert!(repair_keys(&mut keys, |_| true).is_clean());
}

/// Knot intervals are the distances of their points to the power of 0, a half, and 1.
#[test]
fn knots_are_powers_of_distances() {
    let points = [DVec3::ZERO, 4.0 * DVec3::X, 4.0 * DVec3::X + 9.0 * DVec3::Y];
    assert_eq!(Knots::Uniform.of(&points), [0.0, 1.0, 2.0]);
    assert_eq!(Knots::Chordal.of(&points), [0.0, 4.0, 13.0]);
    let centripetal = Knots::Centripetal.of(&points);
    let deviation_of = |(knot, expected): (&f64, f64)| (knot - expected).abs();
    let deviation_of = centripetal.iter().zip([0.0, 2.0, 5.0]).map(deviation_of);
    assert!(deviation_of.fold(0.0, f64::max) < 1e-14, "{centripetal:?}");
}
