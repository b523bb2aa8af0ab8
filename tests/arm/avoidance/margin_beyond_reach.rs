//! Promise: the margin also applies exactly to obstacles beyond the end of the stretched arm.

use std::f64::consts::FRAC_PI_2;

use kinopt::arm::Arm;
use kinopt::collision::{Checker, CollisionModel, Shape, SphereModel, World};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3, rotation_exp};

/// Planar arm of two links of 1 m with a sphere at its tip, on a displaced base.
const ROD: &str = r#"<robot name="rod"><link name="floor"/><link name="base"/><link name="upper"/>
    <joint name="stand" type="fixed"><parent link="floor"/><child link="base"/><origin xyz="0.7 -1.1 0.4"/></joint>
    <link name="tip"><collision><origin xyz="1 0 0"/><geometry><sphere radius="0.1"/></geometry></collision></link>
    <joint name="shoulder" type="continuous"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/></joint>
    <joint name="elbow" type="continuous"><parent link="upper"/><child link="tip"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/></joint>
    </robot>"#;

/// Obstacles of each kind just beyond the stretched arm, checked one by one and through a tree, present initially or
/// added later.
#[test]
fn obstacles_beyond_reach_keep_the_margin() {
    let robot = Robot::parse(ROD, "rod.urdf").unwrap();
    let bodies = CollisionModel::of(&robot).unwrap();
    let spheres = SphereModel::of_spheres(&bodies).unwrap();
    let plain = Checker::new(bodies).with_spheres(spheres);
    let arm = Arm::builder(&robot, "base", "tip").with_atlas(false);
    let arm = arm.build().unwrap();
    let base = Vector3::new(0.7, -1.1, 0.4);
    let face = |y: f64, z: f64| Vector3::new(0.0, 0.2 * (y - 4.0), 0.2 * (z - 4.0));
    let wall = (0..81).map(|k| face(f64::from(k % 9), f64::from(k / 9)));
    let shapes = [
        (Shape::sphere(0.3), 0.0, 0.3),
        (Shape::cuboid([0.4, 1.0, 1.0]), 0.0, 0.2),
        (Shape::capsule(0.2, 0.5), 0.0, 0.2),
        (Shape::capsule(0.2, 0.5), FRAC_PI_2, 0.45),
        (Shape::cylinder(0.3, 0.5), 0.0, 0.3),
        (Shape::cylinder(0.3, 0.5), FRAC_PI_2, 0.25),
        (Shape::points(wall.collect(), 0.1), 0.0, 0.1),
    ];
    for (shape, laid, half) in shapes {
        let lying = rotation_exp(Vector3::new(0.0, laid, 0.0));
        let shape = shape.unwrap();
        for (margin, gap) in [(0.05, 0.049), (0.05, 0.051), (0.3, 0.29), (0.3, 0.31)] {
            let checker = plain.clone().with_margin(margin).unwrap();
            let empty = arm.clone().with_checker(&checker, &[0.0; 2]).unwrap();
            for turned in [0.0, 1.1, -2.0] {
                let turn = rotation_exp(Vector3::new(0.0, 0.0, turned));
                let away = Vector3::new(2.1 + gap + half, 0.0, 0.0);
                let mut world = World::new();
                let at = Placement::new(turn * lying, base + turn * away);
                world.add("thing", shape.clone(), at).unwrap();
                let checker = checker.clone().with_world(&world).unwrap();
                let rebuilt = arm.clone().with_checker(&checker, &[0.0; 2]).unwrap();
                let brought = empty.with_world(&world, None).unwrap();
                for arm in [rebuilt, brought] {
                    let mut clear = [false];
                    arm.clear_by_spheres(&[turned, 0.0], &mut clear).unwrap();
                    let touched = arm.collisions(&[turned, 0.0]).unwrap();
                    let reported = (clear[0], touched.is_empty());
                    assert_eq!(reported, (gap > margin, gap > margin), "{shape:?} {gap}");
                }
            }
        }
    }
}
