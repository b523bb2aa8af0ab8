//! Arms with collision checkers, and worlds around them.

use kinopt::arm::{Arm, Search};
use kinopt::collision::{Checker, CollisionModel, Resolution, Shape, SphereModel, World};
use kinopt::spatial::{Placement, Vector3, rotation_exp};

use crate::arms::robot;
use crate::random::Random;

/// An arm with its checker.
pub struct CheckedArm {
    pub arm: Arm,
    pub checker: Checker,
    pub q_model: Vec<f64>,
}

pub fn panda(search: Search) -> CheckedArm {
    checked_arm("franka_panda", search)
}

pub fn checked_arm(name: &str, search: Search) -> CheckedArm {
    let robot = robot(name);
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_pairs_sampled(200, 1).unwrap();
    let spheres = SphereModel::of(&bodies, Resolution::MaxProtrusion(0.03)).unwrap();
    let arm = Arm::builder(&robot, "base", "flange").with_search(search);
    CheckedArm {
        q_model: vec![0.0; robot.model().configuration_len()],
        arm: arm.build().unwrap(),
        checker: Checker::new(bodies).with_spheres(spheres),
    }
}

impl CheckedArm {
    pub fn with_world(self, world: &World, margin: f64) -> Self {
        let checker = self.checker.with_world(world).unwrap();
        let checker = checker.with_margin(margin).unwrap();
        Self {
            arm: self.arm.with_checker(&checker, &self.q_model).unwrap(),
            checker,
            ..self
        }
    }

    /// Random collision-free configuration.
    pub fn collision_free_configuration(&self, random: &mut Random) -> Vec<f64> {
        loop {
            let q = random.configuration(&self.arm);
            if self.arm.collisions(&q).unwrap().is_empty() {
                return q;
            }
        }
    }
}

/// Boxes, cylinders, capsules, spheres, a hull and a floor around the arm.
pub fn cluttered(random: &mut Random) -> World {
    let mut world = World::new();
    for index in 0..8 {
        let [a, b, c] = [(); 3].map(|()| random.within(0.05, 0.25));
        let corner = |k: u32| {
            let side = |bit, length: f64| if k & bit == 0 { -length } else { length };
            Vector3::new(side(1, a), side(2, b), side(4, c)) * 0.5
        };
        let shape = match index % 5 {
            0 => Shape::cuboid([a, b, c]),
            1 => Shape::cylinder(a, b),
            2 => Shape::capsule(0.5 * a, b),
            3 => Shape::sphere(a),
            _ => Shape::convex(&(0..8).map(corner).collect::<Vec<_>>()),
        };
        let around = random.within(-3.1, 3.1);
        let distance = random.within(0.35, 0.8);
        let position = Vector3::new(
            distance * around.cos(),
            distance * around.sin(),
            random.within(0.1, 1.0),
        );
        let turn = [(); 3].map(|()| random.within(-2.0, 2.0));
        let at = Placement::new(rotation_exp(turn.into()), position);
        world
            .add(&format!("thing {index}"), shape.unwrap(), at)
            .unwrap();
    }
    let below = Vector3::new(0.0, 0.0, -0.1);
    world
        .add("floor", Shape::half_space(), Placement::translation(below))
        .unwrap();
    world
}

/// Boxes around an arm.
pub fn add_boxes(world: &mut World, random: &mut Random) {
    for index in 0..6 {
        let around = random.within(-3.1, 3.1);
        let (distance, high) = (random.within(0.4, 0.8), random.within(0.1, 1.0));
        let position = Vector3::new(distance * around.cos(), distance * around.sin(), high);
        let added = world.add_box(&format!("box {index}"), [0.15; 3], position);
        added.unwrap();
    }
}

/// The Panda with a world and collision shapes alone, without spheres.
pub fn panda_in(world: &World) -> Arm {
    let robot = robot("franka_panda");
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_pairs_sampled(200, 1).unwrap();
    let checker = Checker::new(bodies).with_world(world).unwrap();
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let rest = vec![0.0; robot.model().configuration_len()];
    arm.with_checker(&checker, &rest).unwrap()
}
