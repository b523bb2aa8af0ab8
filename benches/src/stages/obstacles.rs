//! Collision checks of a Panda in worlds of several sizes: by its spheres, eight configurations at once, and by its
//! shapes.

use std::error::Error;
use std::hint::black_box;

use kinopt::arm::Arm;
use kinopt::collision::{Checker, World};
use kinopt::robot::Robot;
use kinopt::spatial::Vector3;

use super::{Run, Stage};
use crate::Sequence;

/// Number of configurations of a run.
const CONFIGURATIONS: usize = 512;
/// Smallest distance of obstacles from the base, metres.
const MIN_DISTANCE: f64 = 0.35;

pub(super) fn stages() -> Vec<Stage> {
    let stage = |name, build| Stage {
        name,
        elements: CONFIGURATIONS as u64,
        unit: "check",
        build,
    };
    vec![
        stage(
            "spheres of a Panda, itself alone",
            || spheres(&World::new()),
        ),
        stage("spheres of a Panda, 30 primitives", || {
            spheres(&shell_of_primitives(30)?)
        }),
        stage("spheres of a Panda, 100 primitives", || {
            spheres(&shell_of_primitives(100)?)
        }),
        stage("spheres of a Panda, 1000 primitives", || {
            spheres(&shell_of_primitives(1000)?)
        }),
        stage("spheres of a Panda, 10 000 primitives", || {
            spheres(&shell_of_primitives(10_000)?)
        }),
        stage("spheres of a Panda, 10 000 points", || {
            spheres(&cloud_of_points(10_000)?)
        }),
        stage("spheres of a Panda, 100 000 points", || {
            spheres(&cloud_of_points(100_000)?)
        }),
        stage("spheres of a Panda, 1 000 000 points", || {
            spheres(&cloud_of_points(1_000_000)?)
        }),
        stage("shapes of a Panda, 30 primitives", || {
            shapes(&shell_of_primitives(30)?)
        }),
        stage("shapes of a Panda, 10 000 primitives", || {
            shapes(&shell_of_primitives(10_000)?)
        }),
    ]
}

/// A Panda that avoids collisions with a world.
///
/// # Errors
///
/// Returns an error if the shipped robot cannot be read.
pub fn panda_among(world: &World) -> Result<(Arm, Checker), Box<dyn Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../models/franka_panda.urdf");
    let robot = Robot::read(file)?;
    let checker = Checker::of(&robot)?.with_world(world)?;
    let arm = Arm::builder(&robot, "base", "flange").build()?;
    let arm = arm.with_checker(&checker, &robot.model().neutral())?;
    Ok((arm, checker))
}

/// The Panda with sampled configurations, two thirds of which are collision-free.
fn panda(world: &World) -> Result<(Arm, Checker, Vec<f64>), Box<dyn Error>> {
    let (arm, checker) = panda_among(world)?;
    let mut random = Sequence::new(0.25);
    let (mut q, mut sampled) = (Vec::new(), Vec::new());
    let mut in_contact = 0;
    while q.len() < CONFIGURATIONS * arm.joint_count() {
        sampled.clear();
        sampled.extend(
            arm.limits()
                .map(|joint| joint.lower + (joint.upper - joint.lower) * random.unit()),
        );
        let is_free = arm.collisions(&sampled)?.is_empty();
        // In a crowded world few configurations are free.
        if is_free || in_contact < CONFIGURATIONS / 3 {
            in_contact += usize::from(!is_free);
            q.extend_from_slice(&sampled);
        }
    }
    Ok((arm, checker, q))
}

/// Boxes, cylinders and balls in a shell around the base, with a total volume that hardly depends on their number.
///
/// # Errors
///
/// None.
pub fn shell_of_primitives(count: usize) -> Result<World, Box<dyn Error>> {
    let mut random = Sequence::new(0.75);
    let size = 0.4 / (count as f64).cbrt();
    let mut world = World::new();
    for index in 0..count {
        let position = position_around_base(&mut random);
        let name = format!("thing {index}");
        let size = size * (0.5 + random.unit());
        match index % 3 {
            0 => world.add_box(&name, [size, size, 0.5 * size], position)?,
            1 => world.add_cylinder(&name, 0.3 * size, size, position)?,
            _ => world.add_sphere(&name, 0.5 * size, position)?,
        };
    }
    Ok(world)
}

/// A point cloud of a camera: points on a table and on a wall.
///
/// # Errors
///
/// None.
pub fn cloud_of_points(count: usize) -> Result<World, Box<dyn Error>> {
    let mut random = Sequence::new(0.75);
    let points = (0..count).map(|index| {
        let (u, v) = (random.unit(), random.unit());
        match index % 2 {
            0 => Vector3::new(0.4 + 0.6 * u, 1.6 * v - 0.8, 0.2),
            _ => Vector3::new(0.9, 1.6 * u - 0.8, 0.2 + v),
        }
    });
    let mut world = World::new();
    let cloud = kinopt::collision::Shape::points(points.collect(), 0.005)?;
    world.add("cloud", cloud, Vector3::zero())?;
    Ok(world)
}

/// A position within the reach of the arm, outside its base.
fn position_around_base(random: &mut Sequence) -> Vector3<f64> {
    loop {
        let [x, y] = [(); 2].map(|()| 2.0 * random.unit() - 1.0);
        let position = Vector3::new(x, y, 1.2 * random.unit() - 0.2);
        if (MIN_DISTANCE..1.0).contains(&x.hypot(y)) {
            return position;
        }
    }
}

fn spheres(world: &World) -> Result<Run, Box<dyn Error>> {
    let (arm, _, q) = panda(world)?;
    let mut collision_free = vec![false; CONFIGURATIONS];
    Ok(Box::new(move || {
        let _checked_once = arm.clear_by_spheres(&q, &mut collision_free);
        black_box(&collision_free);
    }))
}

fn shapes(world: &World) -> Result<Run, Box<dyn Error>> {
    let (arm, checker, q) = panda(world)?;
    let mut workspace = checker.workspace();
    let mut robot_q = checker.model().model().neutral();
    Ok(Box::new(move || {
        for q in q.chunks(arm.joint_count()) {
            let _right_length = arm.configuration(q, &mut robot_q);
            let _finite = black_box(checker.is_free(&mut workspace, &robot_q));
        }
    }))
}
