//! Promise: a parameter map gives every coordinate its specified value: free, locked within limits, or coupled. Bounds
//! of a variable are those of all coordinates that depend on it.

use kinopt::Problem;
use kinopt::kinematics::ForwardKinematics;
use kinopt::model::{Limits, ParameterMap, Source};
use kinopt::spatial::rotation_log;
use kinopt::task::Posture;
use support::fault_tables::ExpectedError;
use support::figures::Figure;
use support::random::Random;
use support::{placement, planar_arm};

#[test]
fn locked_values_are_clamped_by_a_small_excess() {
    let model = planar_arm(&[1.0; 4], Some((-1.0, 2.0)));
    let joints = model.moving_joints();
    let map = ParameterMap::builder(&model).with_only(&[joints[2]], &[-1.0009, 0.5, 9.0, 0.0]);
    let map = map.build().unwrap();
    let mut q = [f64::NAN; 4];
    map.expand(&[0.7], &mut q).unwrap();
    assert_eq!(q, [-1.0, 0.5, 0.7, 0.0]);
    let locked = ParameterMap::builder(&model).with_locked(joints[1], 2.0009);
    assert_eq!(locked.build().unwrap().sources()[1], Source::Constant(2.0));
    let held = ParameterMap::builder(&model).with_only(&[joints[2]], &[-1.002, 0.5, 9.0, 0.0]);
    for builder in [
        held,
        ParameterMap::builder(&model).with_locked(joints[1], 2.002),
    ] {
        builder.build().says("cannot be locked");
    }
}

#[test]
fn bounds_include_coupled_joints() {
    let model = planar_arm(&[1.0; 4], Some((-1.0, 2.0)));
    let joints = model.moving_joints();
    let build = |ratio: f64, offset: f64, narrow: Option<Limits>| {
        let map = ParameterMap::builder(&model).with_coupled(joints[3], joints[1], ratio, offset);
        let map = match narrow {
            Some(limits) => map.with_narrowed(joints[3], limits),
            None => map,
        };
        let map = map.build().unwrap();
        assert_eq!(map.leaders(), [0, 1, 2]);
        (map.lower()[1], map.upper()[1])
    };
    // −1 ≤ 2 x + 0.5 ≤ 2 and −1 ≤ −2 x + 0.5 ≤ 2.
    assert_eq!(build(2.0, 0.5, None), (-0.75, 0.75));
    assert_eq!(build(-2.0, 0.5, None), (-0.75, 0.75));
    assert_eq!(build(-2.0, 1.0, None), (-0.5, 1.0));
    assert_eq!(build(2.0, 0.5, Some(Limits::new(0.0, 1.0))), (-0.25, 0.25));
    assert_eq!(build(-0.5, 0.0, Some(Limits::new(-0.25, 9.0))), (-1.0, 0.5));
}

#[test]
fn reduced_variables_are_within_bounds() {
    let model = planar_arm(&[1.0; 3], Some((-1.0, 2.0)));
    let map = ParameterMap::identity(&model);
    let mut x = [0.0; 3];
    map.reduce(&[9.0, -9.0, 0.5], &mut x).unwrap();
    assert_eq!(x, [2.0, -1.0, 0.5]);
}

/// With any joints locked, balls and bases included, frames are placed as by the whole configuration.
#[test]
fn locked_joints_keep_frame_placements() {
    let random = &mut Random::new(61);
    for seed in 0..20 {
        let figure = Figure::new(seed, 7);
        let model = &figure.model;
        let q = model.random_configuration(seed);
        let mut free: Vec<_> = model.joint_ids().collect();
        free.retain(|_| random.within(0.0, 1.0) < 0.4);
        let map = ParameterMap::builder(model).with_only(&free, &q).build();
        let map = map.unwrap();
        let mut x = vec![0.0; map.variables()];
        map.reduce(&q, &mut x).unwrap();
        let kinematics = ForwardKinematics::under(model, &map, &figure.frames);
        let mut kinematics = kinematics.unwrap();
        let placed = kinematics.place(&x).unwrap();
        for (actual, expected) in placed.iter().zip(figure.frames_at(&q)) {
            let expected = placement(&expected);
            assert!((actual.translation - expected.translation).norm() < 1e-10);
            let turned = actual.rotation.transpose() * expected.rotation;
            assert!(rotation_log(&turned).norm() < 1e-10, "seed {seed}");
        }
    }
}

/// Narrowing never widens: neither a joint's limits nor earlier narrowed ones.
#[test]
fn narrowing_intersects_all_limits() {
    let model = planar_arm(&[1.0; 2], Some((-1.0, 2.0)));
    let joint = model.moving_joints()[1];
    let narrowed = |all: &[(f64, f64)]| {
        let map = all
            .iter()
            .fold(ParameterMap::builder(&model), |map, limits| {
                map.with_narrowed(joint, Limits::new(limits.0, limits.1))
            });
        let map = map.build().unwrap();
        (map.lower()[1], map.upper()[1])
    };
    assert_eq!(narrowed(&[(-5.0, 5.0)]), (-1.0, 2.0));
    assert_eq!(narrowed(&[(-0.5, 5.0)]), (-0.5, 2.0));
    assert_eq!(narrowed(&[(-0.5, 1.0), (-0.8, 0.2)]), (-0.5, 0.2));
}

/// A problem's bounds on a mimic joint narrow its source joint and never widen it.
#[test]
fn mimic_bounds_never_widen_the_source_joint() {
    let model = planar_arm(&[1.0; 2], Some((-1.0, 2.0)));
    let joints = model.moving_joints();
    let map = ParameterMap::builder(&model);
    let map = map.with_narrowed(joints[0], Limits::new(-0.3, 0.4));
    let map = map.with_coupled(joints[1], joints[0], 2.0, 0.0);
    let map = map.build().unwrap();
    for (bound, expected) in [
        (Limits::new(-0.9, 1.5), (-0.3, 0.4)),
        (Limits::new(-0.4, 1.5), (-0.2, 0.4)),
        (Limits::new(-0.9, 0.2), (-0.3, 0.1)),
    ] {
        let mut tasks = Problem::builder(&model);
        tasks.parameters(map.clone());
        tasks.bound(joints[1], bound);
        tasks.add(Posture::new(&model, &[0.0; 2]));
        let problem = tasks.build().unwrap();
        assert_eq!(
            (problem.lower()[0], problem.upper()[0]),
            expected,
            "{bound:?}"
        );
    }
}
