//! Promise: a computation that is told to stop ends early, and one that is not is as without.
#![allow(clippy::unwrap_used)]

use std::cell::Cell;

use kinopt::arm::Arm;
use kinopt::collision::{CollisionModel, Resolution, SphereModel};
use kinopt::interruption::interruptible;
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;

thread_local! {
    static CALLS: Cell<u32> = const { Cell::new(0) };
}

/// After so many calls.
fn stopped() -> bool {
    CALLS.set(CALLS.get() + 1);
    CALLS.get() > 100
}

#[test]
fn endless_computations_end_when_stopped() {
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    let model = CollisionModel::of(&robot).unwrap();
    let builder = Arm::builder(&robot, "base", "flange").with_atlas(false);
    let arm = builder.with_attempts(u32::MAX).build().unwrap();
    let start = vec![0.1; 7];
    let mut far = arm.base_from_tool(&start).unwrap();
    far.translation += Vector3::new(5.0, 0.0, 0.0);
    let solution = interruptible(stopped, || arm.solve(far, &start)).unwrap();
    assert!(!solution.reached);
    CALLS.set(0);
    let sampled = interruptible(stopped, || model.clone().with_pairs_sampled(u64::MAX, 1));
    assert!(sampled.is_ok());
    CALLS.set(0);
    // Its spheres are incomplete, and no use.
    let _ = interruptible(stopped, || {
        SphereModel::of(&model, Resolution::PerLink(100_000_000))
    });
    assert!(CALLS.get() > 100);
}

#[test]
fn computation_that_is_not_stopped_is_the_same() {
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    let arm = Arm::builder(&robot, "base", "flange").build().unwrap();
    let target = arm.base_from_tool(&[0.3; 7]).unwrap();
    let solve = || arm.solve(target, &[0.0; 7]).unwrap().q;
    assert_eq!(interruptible(|| false, solve), solve());
}
