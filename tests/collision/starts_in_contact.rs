//! Promise: an arm that starts in contact leaves it, and reports contact until a pose is free.

use kinopt::arm::Arm;
use kinopt::collision::{Checker, CollisionModel, World};
use support::arms::robot;

#[test]
fn arm_leaves_an_obstacle_it_starts_in() {
    let robot = robot("franka_panda");
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_pairs_sampled(200, 1).unwrap();
    let checker = Checker::covered(bodies);
    let rest = robot.model().neutral();
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let inside = [0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8];
    let outside = [1.8, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8];
    let mut world = World::new();
    let tool = arm.base_from_tool(&inside).unwrap();
    world.add_box("crate", [0.5; 3], tool.translation).unwrap();
    let arm = arm
        .with_checker(&checker.with_world(&world).unwrap(), &rest)
        .unwrap();
    let deep = arm.collisions(&inside).unwrap();
    assert!(
        deep[0].depth() > 0.1 && deep[0].second == "crate",
        "{deep:?}"
    );
    let target = arm.base_from_tool(&outside).unwrap();
    let solution = arm.solve(target, &inside).unwrap();
    assert!(solution.reached, "{}", solution.explain());
    assert!(arm.collisions(&solution.q).unwrap().is_empty());

    // A path that starts in contact reports it at every pose until one is free.
    let path = [tool, target];
    for solution in arm.track(&path, &inside).unwrap().report {
        let touched = arm.collisions(&solution.q).unwrap();
        assert!(!solution.reached || touched.is_empty(), "{touched:?}");
        assert!(solution.reached || !solution.collisions().is_empty());
    }
}
