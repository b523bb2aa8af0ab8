//! Promise: a model's length scale is that of what moves, wherever it stands and whatever stands
//! beside it, and limits that only mean "none" do not stretch it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use kinopt::Model;
use kinopt::model::Limits;
use kinopt::spatial::{Placement, Vector3};

const ALONG_X: Vector3<f64> = Vector3::UNITS[0];

fn shift(x: f64) -> Placement<f64> {
    Placement::translation(Vector3::new(x, 0.0, 0.0))
}

#[test]
fn only_what_moves_counts() {
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
fn nothing_moves_nothing_reaches() {
    let mut builder = Model::builder("table");
    let top = builder.fixed("top", None, shift(1.0));
    builder.frame("edge", Some(top), shift(1.0));
    assert_eq!(builder.build().unwrap().reach(), 0.0);
}

#[test]
fn limits_that_mean_none_neither_stretch_nor_scatter() {
    let model = |limit: f64| {
        let mut builder = Model::builder("slide and turn");
        let limits = Limits::new(-limit, limit);
        let slide = builder.prismatic("slide", None, shift(0.0), ALONG_X, limits);
        let turn = builder.revolute("turn", Some(slide), shift(0.5), ALONG_X, limits);
        builder.frame("tip", Some(turn), shift(0.5));
        builder.build().unwrap()
    };
    assert_eq!(model(2.0).reach(), 3.0);
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
    // Two turns either way are limits that are meant.
    let wide = model(4.0 * std::f64::consts::PI);
    let far = (0..100).map(|seed| wide.random_configuration(seed)[1].abs());
    assert!(far.fold(0.0, f64::max) > 3.0 * std::f64::consts::PI);
}
