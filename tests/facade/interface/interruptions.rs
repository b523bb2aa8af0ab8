//! Promise: a computation that is interrupted ends early; one that is not interrupted has the usual result.

use std::cell::Cell;

use kinopt::arm::Arm;
use kinopt::collision::{CollisionModel, Resolution, SphereModel};
use kinopt::interruption::interruptible;
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;

thread_local! {
    static CALLS: Cell<u32> = const { Cell::new(0) };
}

/// Interrupts after 100 calls.
fn interrupts() -> bool {
    CALLS.set(CALLS.get() + 1);
    CALLS.get() > 100
}

#[test]
fn endless_computations_end_when_interrupted() {
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    let model = CollisionModel::of(&robot).unwrap();
    let builder = Arm::builder(&robot, "base", "flange").with_atlas(false);
    let arm = builder.with_attempts(u32::MAX).build().unwrap();
    let start = vec![0.1; 7];
    let mut unreachable = arm.base_from_tool(&start).unwrap();
    unreachable.translation += Vector3::new(5.0, 0.0, 0.0);
    let solution = interruptible(interrupts, || arm.solve(unreachable, &start)).unwrap();
    assert!(!solution.reached);
    CALLS.set(0);
    let sampled = interruptible(interrupts, || model.clone().with_pairs_sampled(u64::MAX, 1));
    assert!(sampled.is_ok());
    CALLS.set(0);
    // Its spheres are incomplete and discarded.
    let _ = interruptible(interrupts, || {
        SphereModel::of(&model, Resolution::PerLink(100_000_000))
    });
    assert!(CALLS.get() > 100);
}

#[test]
fn uninterrupted_computation_is_unchanged() {
    let robot = Robot::read("../models/franka_panda.urdf").unwrap();
    let arm = Arm::builder(&robot, "base", "flange").build().unwrap();
    let target = arm.base_from_tool(&[0.3; 7]).unwrap();
    let solve = || arm.solve(target, &[0.0; 7]).unwrap().q;
    assert_eq!(interruptible(|| false, solve), solve());
}
