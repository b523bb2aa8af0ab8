//! Promise: a model's length scale is that of its moving parts, independent of its placement and its surroundings.
//! Limits that mean "none" do not increase it.

use kinopt::Model;
use kinopt::model::Limits;
use kinopt::spatial::{Placement, Vector3};

const ALONG_X: Vector3<f64> = Vector3::UNITS[0];

fn shift(x: f64) -> Placement<f64> {
    Placement::translation(Vector3::new(x, 0.0, 0.0))
}

#[test]
fn only_moving_parts_count() {
    let mut builder = Model::builder("arm on a pedestal");
    builder.frame("door", None, shift(40.0));
    let pedestal = builder.fixed("pedestal", None, shift(10.0));
    let plate = builder.fixed("plate", Some(pedestal), shift(5.0));
    builder.frame("socket", Some(plate), shift(30.0));
    let locked = Limits::new(0.1, 0.1);
    let seat = builder.revolute("seat", Some(plate), shift(20.0), ALONG_X, locked);
    let limits = Limits::new(-1.0, 1.0);
    let shoulder = builder.revolute("shoulder", Some(seat), shift(3.0), ALONG_X, limits);
    let elbow = builder.revolute("elbow", Some(shoulder), shift(0.5), ALONG_X, limits);
    let wrist = builder.fixed("wrist", Some(elbow), shift(0.25));
    builder.frame("tool", Some(wrist), shift(0.125));
    assert_eq!(builder.build().unwrap().reach(), 0.875);
}

#[test]
fn immobile_model_has_zero_reach() {
    let mut builder = Model::builder("table");
    let top = builder.fixed("top", None, shift(1.0));
    builder.frame("edge", Some(top), shift(1.0));
    assert_eq!(builder.build().unwrap().reach(), 0.0);
}

#[test]
fn huge_limits_do_not_increase_the_reach() {
    let model = |limit: f64| {
        let mut builder = Model::builder("slide and turn");
        let limits = Limits::new(-limit, limit);
        let slide = builder.prismatic("slide", None, shift(0.0), ALONG_X, limits);
        let turn = builder.revolute("turn", Some(slide), shift(0.5), ALONG_X, limits);
        builder.frame("tip", Some(turn), shift(0.5));
        builder.build().unwrap()
    };
    assert_eq!(model(2.0).reach(), 1.0);
    for huge in [1e16, f64::MAX, f64::INFINITY] {
        let model = model(huge);
        assert_eq!(model.reach(), 1.0);
        for seed in 0..100 {
            let q = model.random_configuration(seed);
            assert!(
                q[0].abs() <= 1.0 && q[1].abs() <= std::f64::consts::PI,
                "{q:?}"
            );
        }
    }
    // Two turns in either direction are real limits.
    let wide = model(4.0 * std::f64::consts::PI);
    let angles = (0..100).map(|seed| wide.random_configuration(seed)[1].abs());
    assert!(angles.fold(0.0, f64::max) > 3.0 * std::f64::consts::PI);
}

/// Mobile base on three prismatic joints of range `limit`, with an arm of 1 m that rotates and slides.
fn mobile(limit: f64, unit: f64) -> Model {
    let mut builder = Model::builder("mobile");
    let limits = Limits::new(-limit * unit, limit * unit);
    let mut base = None;
    for (name, axis) in ["x", "y", "z"].into_iter().zip(Vector3::UNITS) {
        base = Some(builder.prismatic(name, base, shift(0.0), axis, limits));
    }
    let turn = Limits::new(-1.0, 1.0);
    let arm = builder.revolute("arm", base, shift(0.0), ALONG_X, turn);
    let slide = Limits::new(0.0, 0.25 * unit);
    let slide = builder.prismatic("slide", Some(arm), shift(0.5 * unit), ALONG_X, slide);
    builder.frame("tip", Some(slide), shift(0.5 * unit));
    builder.build().unwrap()
}

#[test]
fn base_range_does_not_count() {
    // A radian weighs a quarter of the reach: with the base's range, 750 m instead of 31 cm.
    for limit in [0.0, 0.5, 7.0, 1e3, 1e8, f64::INFINITY] {
        assert_eq!(mobile(limit, 1.0).reach(), 1.25, "{limit}");
        // In any unit, also where the base's range looks like "none".
        assert_eq!(mobile(limit, 1024.0).reach(), 1.25 * 1024.0, "{limit}");
    }
}

#[test]
fn rotated_prismatic_range_is_capped() {
    let telescope = |limit: f64| {
        let mut builder = Model::builder("telescope");
        let turn = builder.revolute("turn", None, shift(0.0), ALONG_X, Limits::new(-1.0, 1.0));
        let limits = Limits::new(0.0, limit);
        let slide = builder.prismatic("slide", Some(turn), shift(1.0), ALONG_X, limits);
        builder.frame("tip", Some(slide), shift(1.0));
        builder.build().unwrap().reach()
    };
    assert_eq!(telescope(0.5), 2.5);
    assert_eq!(telescope(2.0), 4.0);
    assert_eq!(telescope(1e3), 4.0);
}

#[test]
fn without_rotations_prismatic_ranges_count() {
    let mut builder = Model::builder("gantry");
    let limits = Limits::new(-1.0, 3.0);
    let x = builder.prismatic("x", None, shift(0.0), ALONG_X, limits);
    builder.frame("tip", Some(x), shift(0.0));
    assert_eq!(builder.build().unwrap().reach(), 3.0);
}
