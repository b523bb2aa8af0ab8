//! Promise: where few random configurations lead to one whose loops are closed, others are drawn until one does.
#![allow(clippy::unwrap_used)]

use kinopt::ik::LoopClosure;
use kinopt::model::{Limits, Loop, Model, ParameterMap};
use kinopt::spatial::{Placement, Vector3};

use crate::mechanisms::along_x;

/// Where all hinges close, radians: beyond the far end of their limits for each that begins nearer to that.
const CLOSED: f64 = 3.0;
const LIMITS: Limits = Limits {
    lower: -3.1,
    upper: 3.1,
};

/// Hinges of a metre, each held at its end. One in two starts leads a hinge there and the other into its limit, so that all of them
/// go there together from one in sixty-four.
fn hinges() -> Model {
    let mut builder = Model::builder("six hinges");
    let z = Vector3::UNITS[2];
    let stop = Vector3::new(CLOSED.cos(), CLOSED.sin(), 0.0);
    for k in 0..6 {
        let hinge = builder.revolute(format!("hinge {k}"), None, along_x(0.0), z, LIMITS);
        let ends = [
            builder.frame(format!("end {k}"), Some(hinge), along_x(1.0)),
            builder.frame(format!("stop {k}"), None, Placement::translation(stop)),
        ];
        builder.close(Loop::connect(format!("loop {k}"), ends));
    }
    builder.build().unwrap()
}

#[test]
fn one_that_cannot_be_closed_is_followed_by_another() {
    let model = hinges();
    let closure = LoopClosure::new(ParameterMap::builder(&model), model.moving_joints()).unwrap();
    let mut closed = 0;
    for seed in 0..8 {
        let Ok(q) = closure.random_configuration(seed) else {
            continue;
        };
        assert!(q.iter().all(|angle| (angle - CLOSED).abs() < 1e-8), "{q:?}");
        closed += 1;
    }
    assert!(closed >= 6, "{closed} of 8");
}
