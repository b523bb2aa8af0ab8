//! Promise: if few random configurations lead to closed loops, more are sampled until one does.

use kinopt::ik::LoopClosure;
use kinopt::model::{Limits, Loop, Model, ParameterMap};
use kinopt::spatial::{Placement, Vector3};

use crate::loops::mechanisms::along_x;

/// Angle at which all revolute joints close, radians. Starts nearer to the opposite limit do not get there.
const CLOSED_ANGLE: f64 = 3.0;
const LIMITS: Limits = Limits {
    lower: -3.1,
    upper: 3.1,
};

/// Revolute joints of 1 m, each pinned at its end. Every second start fails for one joint, so one in sixty-four closes
/// all.
fn hinges() -> Model {
    let mut builder = Model::builder("six hinges");
    let z = Vector3::UNITS[2];
    let stop = Vector3::new(CLOSED_ANGLE.cos(), CLOSED_ANGLE.sin(), 0.0);
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
fn unclosable_sample_is_replaced() {
    let model = hinges();
    let closure = LoopClosure::new(ParameterMap::builder(&model), model.moving_joints()).unwrap();
    let mut closed = 0;
    for seed in 0..8 {
        let Ok(q) = closure.random_configuration(seed) else {
            continue;
        };
        assert!(
            q.iter().all(|angle| (angle - CLOSED_ANGLE).abs() < 1e-8),
            "{q:?}"
        );
        closed += 1;
    }
    assert!(closed >= 6, "{closed} of 8");
}
