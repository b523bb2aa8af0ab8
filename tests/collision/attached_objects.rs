//! Promise: an attached object may touch the links that hold it and no others: the hand and its fingers, not the wrist.

use kinopt::Arm;
use kinopt::collision::{Checker, World};
use kinopt::kinematics::ForwardKinematics;
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;
use support::arms::robot;

fn holding(robot: &Robot, size: [f64; 3], frame: &str, at: Vector3<f64>) -> Checker {
    let mut world = World::new();
    world.add_box("held", size, Vector3::zero()).unwrap();
    world.attach("held", frame, at).unwrap();
    Checker::of(robot).unwrap().with_world(&world).unwrap()
}

/// A plate in the Panda's hand, and the wrist bent into it. The depth is Coal's (`coal::distance` of the box and the
/// capsules of link6).
#[test]
fn attached_plate_collides_with_the_wrist() {
    let robot = robot("franka_panda");
    let at = Vector3::new(0.0, 0.0, 0.1);
    let checker = holding(&robot, [0.5, 0.02, 0.6], "hand", at);
    let q = [
        0.3651636,
        0.27552705,
        0.77590591,
        -0.85592539,
        -1.04143207,
        1.07709859,
        -0.26467577,
        0.0,
        0.0,
    ];
    let found = checker.collisions(&q).unwrap();
    let wrist = found.iter().find(|pair| pair.first == "link6");
    let depth = wrist.map(|pair| pair.depth()).unwrap();
    assert!((depth - 0.060).abs() < 5e-4, "{found:?}");
    let others = found
        .iter()
        .filter(|pair| ["hand", "finger_left", "finger_right"].contains(&&*pair.first));
    assert_eq!(others.count(), 0, "{found:?}");
}

/// A small box between the Panda's fingers, deep in all of them, attached to any of them.
#[test]
fn object_between_fingers_touches_no_holder() {
    let robot = robot("franka_panda");
    let rest = robot.model().neutral();
    let places = [
        ("hand", Vector3::new(0.0, 0.0, 0.09)),
        ("tool", Vector3::zero()),
        ("finger_left", Vector3::new(0.0, 0.0, 0.03)),
    ];
    for (frame, at) in places {
        let checker = holding(&robot, [0.04, 0.04, 0.06], frame, at);
        let arm = Arm::new(&robot, "base", "tool").unwrap();
        let arm = arm.with_checker(&checker, &rest).unwrap();
        let q = [0.0, -0.4, 0.0, -2.0, 0.0, 1.6, 0.8];
        let found = arm.collisions(&q).unwrap();
        // If one finger holds it, the other is an ordinary link.
        let found: Vec<_> = found
            .iter()
            .filter(|pair| frame != "finger_left" || pair.first != "finger_right")
            .collect();
        assert!(found.is_empty(), "{frame}: {found:?}");
    }
}

#[test]
fn attached_object_moves_with_its_link() {
    let robot = robot("franka_panda");
    let at = Vector3::new(0.0, 0.0, 0.3);
    let q = [0.3, 0.2, 0.5, -1.1, -0.4, 1.7, -0.2, 0.0, 0.0];
    let mut kinematics = ForwardKinematics::new(robot.model());
    let hand = robot.model().frame("hand").unwrap().index();
    let position = kinematics.place(&q).unwrap()[hand].apply(at);
    let mut world = World::new();
    world.add_sphere("cup", 0.03, Vector3::zero()).unwrap();
    world.attach("cup", "hand", at).unwrap();
    world.add_sphere("there", 0.01, position).unwrap();
    let checker = Checker::of(&robot).unwrap().with_world(&world).unwrap();
    let found = checker.collisions(&q).unwrap();
    let cup = found
        .iter()
        .find(|pair| [&pair.first, &pair.second].into_iter().any(|n| n == "cup"));
    assert!((cup.unwrap().distance + 0.04).abs() < 1e-12, "{found:?}");
}
