//! Processor time of a change of a world with one moved obstacle, and of the following checks.
//!
//! `changing_worlds`: a Panda among boxes, a mesh and a point cloud. First one of them is moved repeatedly, then a
//! different one each time.
#![allow(clippy::print_stdout)]

use std::error::Error;
use std::hint::black_box;

use kinopt::Arm;
use kinopt::collision::{Checker, World};
use kinopt::robot::Robot;
use kinopt::spatial::{Placement, Vector3};
use kinopt_benches::{Sequence, ThreadTime};

/// Number of changes of each world.
const CHANGES: usize = 400;
/// Number of configurations that are checked after it.
const CHECKED_CONFIGURATIONS: usize = 512;

/// A position within 2 m along each axis, outside the mount of the arm.
fn random_placement(random: &mut Sequence) -> Placement<f64> {
    loop {
        let mut coordinate = || 4.0 * random.unit() - 2.0;
        let position = Vector3::new(coordinate(), coordinate(), coordinate());
        if position.norm() > 0.4 {
            return Placement::translation(position);
        }
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let robot = Robot::read("models/franka_panda.urdf")?;
    let checker = Checker::of(&robot)?;
    for count in [100, 1_000, 10_000] {
        let mut random = Sequence::new(0.1);
        let mut world = World::new();
        for index in 0..count {
            world.add_box(&index.to_string(), [0.02; 3], random_placement(&mut random))?;
        }
        measure(&format!("{count} boxes"), &robot, &checker, &world)?;
    }
    let mut world = World::new();
    let (vertices, triangles) = ball(71);
    println!("a mesh of {} triangles", triangles.len());
    world.add_mesh("0", vertices, triangles, Vector3::new(0.6, 0.0, 0.3))?;
    measure("a mesh", &robot, &checker, &world)?;
    let mut random = Sequence::new(0.2);
    let positions = (0..1_000_000)
        .map(|_| random_placement(&mut random).translation)
        .collect();
    let mut world = World::new();
    world.add_points("0", positions, 0.001, Placement::identity())?;
    measure("a million points", &robot, &checker, &world)
}

/// A ball of 2 n (n - 1) triangles, 0.2 m in diameter.
fn ball(n: u32) -> (Vec<Vector3<f64>>, Vec<[u32; 3]>) {
    let vertex = |ring: u32, side: u32| {
        let (down, around) = (
            f64::from(ring) / f64::from(n),
            f64::from(side) / f64::from(n),
        );
        let (down, around) = (std::f64::consts::PI * down, std::f64::consts::TAU * around);
        let across = 0.1 * down.sin();
        Vector3::new(
            across * around.cos(),
            across * around.sin(),
            0.1 * down.cos(),
        )
    };
    let vertices = (0..=n).flat_map(|ring| (0..n).map(move |side| vertex(ring, side)));
    let corner = |ring: u32, side: u32| ring * n + side % n;
    let mut triangles = Vec::new();
    for ring in 0..n {
        for side in 0..n {
            if ring > 0 {
                triangles.push([
                    corner(ring, side),
                    corner(ring + 1, side),
                    corner(ring, side + 1),
                ]);
            }
            if ring + 1 < n {
                triangles.push([
                    corner(ring, side + 1),
                    corner(ring + 1, side),
                    corner(ring + 1, side + 1),
                ]);
            }
        }
    }
    (vertices.collect(), triangles)
}

fn measure(
    label: &str,
    robot: &Robot,
    checker: &Checker,
    world: &World,
) -> Result<(), Box<dyn Error>> {
    let rest = robot.model().neutral();
    let mut world = world.clone();
    let mut checker = checker.clone().with_world(&world)?;
    let mut arm = Arm::new(robot, "base", "flange")?.with_checker(&checker, &rest)?;
    let mut random = Sequence::new(0.3);
    let first_position = world.obstacle("0")?.placement.translation;
    let joints: Vec<f64> = (0..CHECKED_CONFIGURATIONS * 7)
        .map(|_| 3.0 * random.unit() - 1.5)
        .collect();
    let check = |arm: &Arm| -> Result<[f64; 2], Box<dyn Error>> {
        let (mut times, mut collision_free) = ([0.0; 2], [false; 8]);
        for time in &mut times {
            let started = ThreadTime::now();
            for q in joints.chunks_exact(8 * 7) {
                arm.clear_by_spheres(q, &mut collision_free)?;
                black_box(&collision_free);
            }
            *time = started.micros() / CHECKED_CONFIGURATIONS as f64;
        }
        Ok(times)
    };
    let [first, again] = check(&arm)?;
    println!("{label}: a check {again:.2} us ({first:.2} the first time)");
    let choices = [false, world.len() > 1];
    for moves_each in &choices[..1 + usize::from(choices[1])] {
        let mut times = [Vec::new(), Vec::new(), Vec::new()];
        for change in 0..CHANGES {
            let name = match moves_each {
                true => (change * 7919 % world.len()).to_string(),
                false => "0".to_owned(),
            };
            let mut placement = random_placement(&mut random);
            if world.len() == 1 {
                // One or two centimetres.
                placement.translation = first_position + placement.translation * 0.01;
            }
            let started = ThreadTime::now();
            world.move_to(&name, placement)?;
            times[0].push(started.micros());
            let started = ThreadTime::now();
            checker = checker.with_world(&world)?;
            times[1].push(started.micros());
            let started = ThreadTime::now();
            arm = arm.with_world(&world, None)?;
            times[2].push(started.micros());
        }
        let summaries = times.map(|mut times| {
            let mean = times.iter().sum::<f64>() / times.len() as f64;
            times.sort_by(f64::total_cmp);
            format!(
                "{:.1} ({mean:.1}, {:.0})",
                times[times.len() / 2],
                times[times.len() - 1]
            )
        });
        let [first, again] = check(&arm)?;
        println!(
            "{label}, {} moved: median (mean, most) of World::move_to {} us, Checker::with_world {} us, Arm::with_world {} us; \
             a check {again:.2} us ({first:.2} the first time)",
            if *moves_each { "each" } else { "one" },
            summaries[0],
            summaries[1],
            summaries[2]
        );
    }
    Ok(())
}
