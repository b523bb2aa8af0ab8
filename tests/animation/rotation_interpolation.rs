//! Promise: rotations are interpolated along the shortest arc at constant angular speed, also if the two are nearly
//! equal or opposite. Curves through rotations have no kink.

use glam::{Quat, Vec3, Vec4};
use kinopt::animation::rotation::{
    RotationCurve, RotationHermite, mean_rates, nlerp, slerp, slerp_vectors, squad, squad_control,
};
use support::random::{Random, cases};

fn rotation(random: &mut Random) -> Quat {
    let mut part = || random.within(-1.0, 1.0) as f32;
    Quat::from_xyzw(part(), part(), part(), part() + 1e-3).normalize()
}

/// Angle between two rotations, radians, by the sine of the half angle.
fn apart(a: Quat, b: Quat) -> f32 {
    let (a, b) = (a.as_dquat().normalize(), b.as_dquat().normalize());
    (2.0 * (a.conjugate() * b).xyz().length().min(1.0).asin()) as f32
}

#[test]
fn slerp_has_constant_speed_and_nlerp_has_not() {
    let mut random = Random::new(1);
    for _ in 0..200 {
        let (from, to) = (rotation(&mut random), rotation(&mut random));
        let whole = apart(from, to);
        let at = |step: i32| slerp(from, to, step as f32 / 16.0);
        for step in 0..16 {
            let turned = apart(at(step), at(step + 1));
            assert!((turned - whole / 16.0).abs() < 2e-6, "{turned} of {whole}");
        }
    }
    let wide = Quat::from_axis_angle(Vec3::X, 3.0);
    let quarter = apart(Quat::IDENTITY, nlerp(Quat::IDENTITY, wide, 0.25));
    assert!((quarter - 0.75).abs() > 0.05, "{quarter}");
}

#[test]
fn shorter_arc_is_taken() {
    let mut random = Random::new(2);
    for _ in 0..200 {
        let (from, to) = (rotation(&mut random), rotation(&mut random));
        for between in [slerp, nlerp] {
            let middle = between(from, to, 0.5);
            assert!(apart(middle, between(from, -to, 0.5)) < 1e-6);
            assert!(apart(from, middle) <= std::f32::consts::FRAC_PI_2 + 1e-5);
            assert!((middle.length() - 1.0).abs() < 1e-6);
        }
    }
}

#[test]
fn nearly_equal_and_opposite_rotations_are_safe() {
    let mut random = Random::new(3);
    for _ in 0..100 {
        let from = rotation(&mut random);
        let axis = rotation(&mut random).xyz().normalize();
        for angle in [
            0.0, 1e-30, 1e-7, 1e-4, 0.01, 0.06, 0.0632, 0.0634, 0.1, 3.13,
        ] {
            let to = from * Quat::from_axis_angle(axis, angle);
            for (t, sign) in [(0.0, 1.0), (0.3, -1.0), (0.5, 1.0), (1.0, -1.0)] {
                let actual = slerp(from, to * sign, t);
                assert!(actual.is_finite() && (actual.length() - 1.0).abs() < 1e-6);
                assert!(
                    (apart(from, actual) - t * angle).abs() < 4e-6,
                    "{angle} {t}"
                );
            }
        }
        // A rotation and its negative are the same one.
        assert!(apart(slerp(from, -from, 0.5), from) < 1e-6);
    }
}

#[test]
fn directions_rotate_in_their_plane_evenly() {
    let mut random = Random::new(4);
    for _ in 0..200 {
        let from = rotation(&mut random).xyz().normalize();
        let to = rotation(&mut random).xyz().normalize();
        let angle = from.angle_between(to);
        for t in [0.0, 0.2, 0.5, 0.9, 1.0] {
            let actual = slerp_vectors(from, to, t);
            assert!((actual.length() - 1.0).abs() < 1e-5);
            assert!((from.angle_between(actual) - t * angle).abs() < 1e-3);
            assert!(actual.dot(from.cross(to)).abs() < 1e-5);
        }
        let opposite = slerp_vectors(from, -from, 0.5);
        assert!(opposite.dot(from).abs() < 1e-5 && (opposite.length() - 1.0).abs() < 1e-5);
        assert!((slerp_vectors(from, from, 0.5) - from).length() < 1e-6);
    }
}

/// Angular velocity before and after t = 0 of two curves that join there.
fn kink(before: impl Fn(f32) -> Quat, after: impl Fn(f32) -> Quat) -> f32 {
    let step = 1e-3;
    let rate = |a: Quat, b: Quat| {
        let turn = a.as_dquat().normalize().conjugate() * b.as_dquat().normalize();
        (turn.xyz() * (2.0 * turn.w.signum() / f64::from(step))).as_vec3()
    };
    let arriving = rate(before(1.0 - step), before(1.0));
    let leaving = rate(after(0.0), after(step));
    (arriving - leaving).length() / arriving.length().max(1.0)
}

/// Also if keys are nearly half a turn apart and the curve deviates far.
#[test]
fn squad_is_continuous() {
    let mut random = Random::new(15);
    for _ in cases(300, 60) {
        let keys: Vec<Quat> = (0..6).map(|_| rotation(&mut random)).collect();
        let times = (0..6_u8).map(f32::from).collect();
        let curve = RotationCurve::squad(times, keys).unwrap();
        let steps = |each: u16| {
            let at = move |k: u16| 2.0 + f32::from(k) / f32::from(each);
            let curve = &curve;
            let steps = (0..each).map(move |k| apart(curve.at(at(k)), curve.at(at(k + 1))));
            steps.fold(0.0, f32::max)
        };
        // A tenth of the step rotates by about a tenth; a jump would keep its size.
        let [coarse, fine] = [steps(400), steps(4000)];
        assert!(fine < 0.3 * coarse, "{fine} after {coarse}");
    }
}

#[test]
fn squad_has_no_kink_at_even_times() {
    let mut random = Random::new(5);
    for _ in 0..50 {
        let mut keys = vec![rotation(&mut random)];
        for _ in 0..4 {
            let turn = Quat::from_scaled_axis(rotation(&mut random).xyz() * 1.2);
            keys.push(keys[keys.len() - 1] * turn);
        }
        let control = |i: usize| squad_control(keys[i - 1], keys[i], keys[i + 1]);
        let segment = |i: usize| {
            let (keys, controls) = ([keys[i], keys[i + 1]], [control(i), control(i + 1)]);
            move |t| squad(keys[0], controls, keys[1], t)
        };
        let (first, second) = (segment(1), segment(2));
        assert!(apart(first(0.0), keys[1]) < 1e-5 && apart(first(1.0), keys[2]) < 1e-5);
        let kinked = kink(
            |t| slerp(keys[1], keys[2], t),
            |t| slerp(keys[2], keys[3], t),
        );
        let smooth = kink(first, second);
        assert!(smooth < 0.02, "{smooth} against {kinked} of slerp");
    }
}

#[test]
fn rotation_hermite_has_no_kink_at_uneven_times() {
    let mut random = Random::new(6);
    for _ in 0..50 {
        let times = [0.0, 0.3, 1.4, 1.7, 3.0_f32];
        let mut keys = vec![rotation(&mut random)];
        for pair in times.windows(2) {
            let turn = rotation(&mut random).xyz() * (pair[1] - pair[0]).sqrt();
            keys.push(keys[keys.len() - 1] * Quat::from_scaled_axis(turn));
        }
        let rates = mean_rates(&times, &keys);
        let segment = |i: usize| {
            let length = times[i + 1] - times[i];
            let rate = |k: usize| rates[k] * length;
            (
                length,
                RotationHermite::new(keys[i], rate(i), keys[i + 1], rate(i + 1)),
            )
        };
        for key in 1..4 {
            let ((before, first), (after, second)) = (segment(key - 1), segment(key));
            assert!(apart(first.at(1.0), keys[key]) < 1e-5);
            assert!(apart(second.at(0.0), keys[key]) < 1e-5);
            let per_second = |length: f32, from: Quat, to: Quat, u: f32| {
                let turn = from.as_dquat().conjugate() * to.as_dquat();
                (turn.xyz() * 2.0 * turn.w.signum()).as_vec3() / (u * length)
            };
            let u = 2e-3;
            let arriving = per_second(before, first.at(1.0 - u), first.at(1.0), u);
            let leaving = per_second(after, second.at(0.0), second.at(u), u);
            for rate in [arriving, leaving] {
                let deviation = (rate - rates[key]).length() / rates[key].length().max(1.0);
                assert!(deviation < 0.03, "{deviation}");
            }
        }
    }
}

/// Tangents are scaled with their quaternions, also if these are normalised.
#[test]
fn cubic_normalises_long_quaternions() {
    let keys = [0.0, 0.9, 0.3].map(Quat::from_rotation_y);
    let rates = [0.4, -1.0, 0.7].map(|x| [Vec4::new(x, 0.3, -x, 0.1), Vec4::new(0.2, x, 0.5, -x)]);
    let times = vec![0.0, 0.7, 1.5];
    let plain = RotationCurve::cubic(times.clone(), keys.to_vec(), rates.to_vec()).unwrap();
    let scales = [3.0, 0.2, 50.0];
    let long = keys.iter().zip(scales).map(|(q, scale)| *q * scale);
    let long_rates = rates
        .iter()
        .zip(scales)
        .map(|(pair, scale)| pair.map(|rate| rate * scale));
    let scaled = RotationCurve::cubic(times, long.collect(), long_rates.collect()).unwrap();
    for step in 0..=30 {
        let time = 0.05 * step as f32;
        assert!(
            plain.at(time).abs_diff_eq(scaled.at(time), 1e-5),
            "{time} s"
        );
    }
}

/// Rotations about one axis are angles: 170° from key to key, bent by controls at 0° and 200°. The second control is
/// more than a quarter turn of the sphere from the first key, and belongs to the other key.
#[test]
fn squad_control_keeps_its_keys_hemisphere() {
    let about_z = |degrees: f32| Quat::from_rotation_z(degrees.to_radians());
    let controls = [about_z(0.0), about_z(200.0)];
    for (t, expected) in [(0.25_f32, 45.3125), (0.5, 92.5), (0.75, 135.9375)] {
        let [chord, bow] = [170.0 * t, 200.0 * t];
        assert!((chord + 2.0 * t * (1.0 - t) * (bow - chord) - expected).abs() < 1e-3);
        for second in [controls[1], -controls[1]] {
            let q = squad(about_z(0.0), [controls[0], second], about_z(170.0), t);
            assert!(apart(q, about_z(expected)) < 1e-5, "{t}: {q}");
        }
    }
}

/// A cubic starts with a key's outgoing tangent and ends with the next key's incoming tangent.
#[test]
fn cubic_rotation_uses_its_tangents() {
    let keys = [0.2, 0.9].map(Quat::from_rotation_y);
    let nonsense = Vec4::splat(1e3);
    let [leaving, arriving] = [
        Vec4::new(0.3, -0.2, 0.5, 0.1),
        Vec4::new(-0.4, 0.6, 0.2, -0.3),
    ];
    let rates = vec![[nonsense, leaving], [arriving, nonsense]];
    let curve = RotationCurve::cubic(vec![1.0, 3.0], keys.to_vec(), rates).unwrap();
    for u in [0.25_f32, 0.5, 0.8] {
        let rest = 1.0 - u;
        // Two seconds from key to key.
        let sum = Vec4::from(keys[0]) * (rest * rest * (1.0 + 2.0 * u))
            + leaving * (2.0 * u * rest * rest)
            + Vec4::from(keys[1]) * (u * u * (3.0 - 2.0 * u))
            - arriving * (2.0 * u * u * rest);
        let expected = Quat::from_vec4(sum.normalize());
        let actual = curve.at(1.0 + 2.0 * u);
        assert!(
            actual.abs_diff_eq(expected, 1e-5),
            "{u}: {actual} {expected}"
        );
    }
}

/// A steady rotation has its own rate at every key, at any times, and for either sign of a key.
#[test]
fn mean_rates_of_a_steady_rotation_are_its_rate() {
    let rate = Vec3::new(0.3, -0.5, 0.4);
    let times = [0.0, 0.2, 1.7, 1.9, 4.0];
    let sides = [1.0, -1.0, -1.0, 1.0, -1.0];
    let at = |(time, side): (&f32, f32)| Quat::from_scaled_axis(rate * *time) * side;
    let rotations: Vec<Quat> = times.iter().zip(sides).map(at).collect();
    for (key, actual) in mean_rates(&times, &rotations).iter().enumerate() {
        assert!((*actual - rate).length() < 1e-5, "key {key}: {actual}");
    }
}

/// A rotation at constant speed keeps it with unevenly spaced keys: rates are per second, not per key.
#[test]
fn steady_rotation_stays_even_at_uneven_keys() {
    let times = vec![0.0_f32, 0.05, 0.8, 0.9, 2.3];
    let axis = Vec3::new(2.0, -1.0, 2.0) / 3.0;
    let turned = |time: f32| Quat::from_axis_angle(axis, 0.3 + 1.2 * time);
    let keys: Vec<Quat> = times.iter().map(|&time| turned(time)).collect();
    let smooth = RotationCurve::smooth(times, keys).unwrap();
    for step in 0..=46 {
        let time = 0.05 * step as f32;
        let deviation = apart(smooth.at(time), turned(time));
        assert!(deviation < 1e-5, "{time} s: off by {deviation}");
    }
}

/// A rotation and its negative are one: the signs of keys do not change the curve.
#[test]
fn key_signs_do_not_change_the_curve() {
    let [start, end] = [
        Quat::from_rotation_x(0.4),
        Quat::from_rotation_y(1.3) * Quat::from_rotation_x(0.2),
    ];
    let rates = [Vec3::new(0.4, -0.3, 1.0), Vec3::new(-0.2, 0.5, 0.3)];
    let curve = |start: Quat, end: Quat| RotationHermite::new(start, rates[0], end, rates[1]);
    let times = [0.0, 0.4, 1.0];
    let first = [start, end, start * end];
    let means = mean_rates(&times, &first);
    for signs in 0..4 {
        let sign = |k: usize, q: Quat| if signs >> k & 1 == 1 { -q } else { q };
        let (a, b) = (sign(0, start), sign(1, end));
        for step in 0..=8 {
            let u = step as f32 / 8.0;
            assert!(apart(curve(a, b).at(u), curve(start, end).at(u)) < 1e-5);
            for blend in [nlerp, slerp] {
                assert!(apart(blend(a, b, u), blend(start, end, u)) < 1e-5);
            }
        }
        let turned = [a, b, first[2]];
        for (mean_rate, mean) in mean_rates(&times, &turned).iter().zip(&means) {
            assert!((*mean_rate - *mean).length() < 1e-5);
        }
    }
}
