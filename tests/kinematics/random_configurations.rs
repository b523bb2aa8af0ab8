//! Promise: a random configuration is within the limits and depends on its seed only.

use kinopt::model::{Limits, Model};
use kinopt::spatial::{Placement, Vector3};

fn model() -> Model {
    let mut builder = Model::builder("all kinds");
    let [x, _, z] = Vector3::UNITS;
    let still = Placement::identity();
    let turns = [
        Limits::new(-0.25, 0.75),
        Limits::new(7.0, f64::INFINITY),
        Limits::new(f64::NEG_INFINITY, -9.0),
        Limits::new(-1e308, 1e308),
        Limits::new(0.3, 0.3),
    ];
    let mut last = None;
    for (index, limits) in turns.into_iter().enumerate() {
        last = Some(builder.revolute(format!("turn {index}"), last, still, z, limits));
    }
    last = Some(builder.continuous("around", last, still, z));
    last = Some(builder.prismatic(
        "slide",
        last,
        Placement::translation(x),
        x,
        Limits::UNBOUNDED,
    ));
    builder.prismatic("short", last, still, x, Limits::new(-0.5, 0.0));
    builder.build().unwrap()
}

#[test]
fn samples_are_finite_and_within_limits() {
    let model = model();
    for seed in 0..2000 {
        let q = model.random_configuration(seed);
        assert_eq!(q.len(), model.degrees_of_freedom());
        for (value, limits) in q.iter().zip(model.limits()) {
            assert!(
                value.is_finite() && limits.contains(*value),
                "{value} in {limits:?}"
            );
        }
        // Missing limits are replaced by half a turn, or the reach, from the neutral value.
        let pi = std::f64::consts::PI;
        assert!(q[1] <= 7.0 + pi && q[2] >= -9.0 - pi && q[5].abs() <= pi);
        assert!(q[6].abs() <= model.reach());
    }
}

/// Also if no limit of a joint is near zero: the range is about its neutral value.
#[test]
fn one_sided_ranges_are_sampled_near_their_end() {
    let model = model();
    let drawn = (0..500).map(|seed| model.random_configuration(seed));
    let drawn: Vec<Vec<f64>> = drawn.collect();
    for (coordinate, [lower, upper]) in [(1, [7.0, 8.5]), (2, [-10.5, -9.0])] {
        let within = |q: &&Vec<f64>| (lower..=upper).contains(&q[coordinate]);
        let count = drawn.iter().filter(within).count();
        // About half of the samples over half a turn are within 1.5 rad.
        assert!((150..350).contains(&count), "{count} of joint {coordinate}");
    }
}

#[test]
fn whole_range_is_sampled_evenly() {
    let model = model();
    let mut tenths = [0; 10];
    for seed in 0..2000 {
        let q = model.random_configuration(seed);
        tenths[((q[0] + 0.25) * 10.0) as usize] += 1;
    }
    // 200 each on average, with a standard deviation of 13.
    assert!(
        tenths.iter().all(|&n| (130..270).contains(&n)),
        "{tenths:?}"
    );
}

#[test]
fn seed_determines_the_configuration() {
    let model = model();
    assert_eq!(model.random_configuration(3), model.random_configuration(3));
    assert_ne!(model.random_configuration(3), model.random_configuration(4));
}

/// A ball joint with a total angle limit is sampled up to that angle.
#[test]
fn samples_respect_total_angles() {
    use kinopt::model::BallLimits;
    let mut builder = Model::builder("ball");
    let (z, still) = (Vector3::UNITS[2], Placement::identity());
    let limits = BallLimits::cone(1.0, Limits::new(-1.0, 0.5)).with_angle(0.6);
    builder.ball("shoulder", None, still, z, Some(limits));
    let model = builder.build().unwrap();
    let mut farthest = 0.0_f64;
    for seed in 0..300 {
        let q = model.random_configuration(seed);
        assert!(model.is_within_limits(&q), "seed {seed}: {q:?}");
        let angle = 2.0 * q[0].abs().min(1.0).acos();
        assert!(angle <= 0.6 + 1e-9, "seed {seed}: {angle}");
        farthest = farthest.max(angle);
    }
    assert!(farthest > 0.5, "{farthest}");
}

/// A ball joint is within its limits if its swing, its twist and its total angle are. The test composes rotations from
/// these parts.
#[test]
fn ball_limits_match_their_parts() {
    use kinopt::model::{BallLimits, Model};
    use kinopt::spatial::{Quaternion, rotation_exp};
    use std::f64::consts::PI;
    use support::random::Random;
    let mut random = Random::new(31);
    let mut reported = [0; 2];
    for case in 0..600 {
        let [x, y, z] = Vector3::UNITS;
        let (axis, first, second) = [(x, y, z), (y, z, x), (z, x, y)][case % 3];
        let swing = match case % 4 {
            0 => [PI; 2],
            _ => [(); 2].map(|()| random.within(0.3, 2.5)),
        };
        let (lower, upper) = (random.within(-2.5, 0.0), random.within(0.0, 2.5));
        let twist = match case % 5 {
            0 => Limits::UNBOUNDED,
            1 => Limits::new(lower, PI),
            2 => Limits::new(-PI, upper),
            3 => Limits::new(f64::NEG_INFINITY, upper),
            _ => Limits::new(lower, upper),
        };
        let mut limits = BallLimits::elliptic(first, swing, twist);
        let angle = (case % 7 == 0).then(|| random.within(1.0, 2.5));
        if let Some(angle) = angle {
            limits = limits.with_angle(angle);
        }
        let mut builder = Model::builder("ball");
        builder.ball("ball", None, Placement::identity(), axis, Some(limits));
        let model = builder.build().unwrap();
        for _ in 0..8 {
            let [a, b] = [(); 2].map(|()| random.within(-2.2, 2.2));
            let turned = random.within(-3.1, 3.1);
            let made = rotation_exp(first * a + second * b) * rotation_exp(axis * turned);
            let Quaternion { w, v } = Quaternion::from_matrix(&made);
            let inside = (a / swing[0]).hypot(b / swing[1]) <= 1.0
                && twist.contains(turned)
                && angle.is_none_or(|upper| 2.0 * w.abs().min(1.0).acos() <= upper);
            // A swing beyond half a turn equals another one.
            if a.hypot(b) < 3.1 {
                let q = [w, v.x, v.y, v.z];
                assert_eq!(model.is_within_limits(&q), inside, "{limits:?} {q:?}");
                reported[usize::from(inside)] += 1;
            }
        }
        for seed in 0..4 {
            let q = model.random_configuration(case as u64 + seed);
            assert!(model.is_within_limits(&q), "{limits:?} {q:?}");
        }
    }
    assert!(reported.iter().all(|count| *count > 500), "{reported:?}");
}

/// A free joint is identified by its first translation. The intersection of two limits is what both allow.
#[test]
fn free_joints_and_common_limits() {
    let mut builder = Model::builder("two bodies");
    let still = Placement::identity();
    let bounds = [Limits::UNBOUNDED; 3];
    let hinge = builder.revolute(
        "hinge",
        None,
        still,
        Vector3::UNITS[0],
        Limits::new(-1.0, 1.0),
    );
    builder.free("a", None, still, bounds);
    builder.free("b", Some(hinge), still, bounds);
    let model = builder.build().unwrap();
    let named = model.free_joints().iter();
    let named: Vec<_> = named
        .map(|id| model.joints()[id.index()].name.as_str())
        .collect();
    assert_eq!(named, ["a/x", "b/x"]);
    let [a, b] = [Limits::new(-1.0, 0.5), Limits::new(-0.25, f64::INFINITY)];
    for common in [a.intersection(&b), b.intersection(&a)] {
        assert_eq!(common, Limits::new(-0.25, 0.5));
    }
}

/// Each translation of a free or planar joint has its own bounds, in order.
#[test]
fn translation_bounds_are_in_axis_order() {
    let mut builder = Model::builder("rooms");
    let still = Placement::identity();
    let [a, b, c] = [0.1, 0.2, 0.3].map(|end| Limits::new(-end, 2.0 * end));
    let body = builder.free("body", None, still, [a, b, c]);
    builder.planar("foot", Some(body), still, Vector3::UNITS[2], [b, a], c);
    let model = builder.build().unwrap();
    let limits: Vec<_> = model.limits().collect();
    assert_eq!(limits[..3], [a, b, c]);
    assert_eq!(limits[7..], [b, a, c]);
}

/// Only ball joints have cones.
#[test]
fn cone_on_a_revolute_joint_is_rejected() {
    use kinopt::model::{BallLimits, Joint, JointKind, ModelError};
    for kind in [
        JointKind::Revolute,
        JointKind::Prismatic,
        JointKind::Continuous,
    ] {
        let mut builder = Model::builder("hinge");
        let limits = Limits::new(-1.0, 1.0);
        let mut joint = Joint::new(
            "a",
            None,
            Placement::identity(),
            kind,
            Vector3::UNITS[0],
            limits,
        );
        let cone = BallLimits::cone(0.5, limits);
        joint.ball = Some(cone);
        builder.joint(joint);
        let refused = builder.build().unwrap_err();
        assert!(
            matches!(refused, ModelError::BadBallLimits { .. }),
            "{refused}"
        );
    }
}
