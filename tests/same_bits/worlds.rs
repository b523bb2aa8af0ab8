//! Promise: so it is among obstacles: distances between shapes, answers that touch nothing and what stands in the way of others,
//! paths.
#![allow(clippy::unwrap_used)]

use kinopt::Arm;
use kinopt::collision::{
    Checker, CollisionModel, Resolution, Shape, SphereModel, World, separation,
};
use kinopt::motion::path::{CartesianPath, PathSolution, PathSolver, QuaternionOrder};
use kinopt::spatial::{Placement, Vector3};
use support::arms::robot;
use support::random::Random;
use support::trees::configuration_of;

use crate::arms::turned;
use crate::digest::{Digest, Value, check};

pub(crate) fn vector(random: &mut Random, size: f64) -> Vector3<f64> {
    Vector3::from([(); 3].map(|()| random.within(-size, size)))
}

fn shapes(random: &mut Random) -> Vec<Shape> {
    let mut size = || random.within(0.1, 0.8);
    let cuboid = Shape::cuboid([size(), size(), size()]).unwrap();
    let round = [
        Shape::sphere(size()).unwrap(),
        Shape::capsule(size(), size()).unwrap(),
        Shape::cylinder(size(), size()).unwrap(),
    ];
    let corners: Vec<_> = (0..20).map(|_| vector(random, 0.5)).collect();
    let hull = Shape::convex(&corners).unwrap();
    let faces = vec![[0, 1, 2], [0, 2, 3], [0, 3, 1], [1, 3, 2]];
    let mesh = Shape::mesh(corners[..4].to_vec(), faces).unwrap();
    let cloud = Shape::points(corners, 0.02).unwrap();
    let heights = (0..12).map(|_| random.within(-0.2, 0.2)).collect();
    let field = Shape::height_field(heights, 4, [0.3, 0.2]).unwrap();
    let mut all = vec![cuboid, hull, mesh, cloud, field];
    all.extend(round);
    all
}

fn distances() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(3));
    for _ in 0..12 {
        let all = shapes(&mut random);
        for first in &all {
            for second in &all {
                let mut place =
                    || Placement::new(turned(|| random.unit()), vector(&mut random, 0.8));
                let found = separation(first, &place(), second, &place());
                digest.doubles([found.distance]);
                digest.doubles(found.normal.to_array());
                digest.doubles(found.on_first.to_array());
                digest.doubles(found.on_second.to_array());
            }
        }
    }
    digest.value()
}

const RARE: [(&str, &str); 6] = [
    ("base", "link4"),
    ("base", "finger_left"),
    ("base", "finger_right"),
    ("link1", "link7"),
    ("link1", "finger_left"),
    ("link2", "link7"),
];

fn checker(world: &World) -> Checker {
    let bodies = CollisionModel::of(&robot("franka_panda")).unwrap();
    let mut bodies = bodies.with_pairs_sampled(200, 1).unwrap();
    // They can touch, but do in none of those samples: which pairs are found is not what is digested.
    for (first, second) in RARE {
        bodies = bodies.with_ignored(first, second).unwrap();
    }
    Checker::new(bodies).with_world(world).unwrap()
}

fn spheres() -> Value {
    let mut digest = Digest::new();
    let bodies = CollisionModel::of(&robot("franka_panda")).unwrap();
    let cover = SphereModel::of(&bodies, Resolution::MaxProtrusion(0.01)).unwrap();
    for sphere in cover.groups().iter().flat_map(|group| &group.spheres) {
        digest.doubles(sphere.centre.to_array());
        digest.doubles([sphere.radius]);
    }
    digest.doubles([cover.max_protrusion()]);
    digest.value()
}

/// The arm among the obstacles of a file of `models/`.
fn among(file: &str) -> Arm {
    let world = World::read(format!("../models/worlds/{file}.json")).unwrap();
    let robot = robot("franka_panda");
    let arm = Arm::new(&robot, "base", "flange").unwrap();
    let rest = vec![0.0; robot.model().configuration_len()];
    arm.with_checker(&checker(&world), &rest).unwrap()
}

fn answers() -> Value {
    let (mut digest, mut random) = (Digest::new(), Random::new(4));
    let model = robot("franka_panda");
    for file in ["table", "window"] {
        let arm = among(file);
        for _ in 0..60 {
            let [there, start] =
                [(); 2].map(|()| configuration_of(model.model(), &mut random)[..7].to_vec());
            let target = arm.base_from_tool(&there).unwrap();
            let solution = arm.solve(target, &start).unwrap();
            digest.solution(&solution);
            for pair in solution.collisions() {
                digest.bytes(&pair.first);
                digest.bytes(&pair.second);
                digest.doubles([pair.distance]);
            }
        }
    }
    digest.value()
}

fn add_path(digest: &mut Digest, found: &PathSolution) {
    digest.doubles(found.q.iter().copied());
    digest.doubles([found.length]);
    let deviation = found.largest_deviation;
    digest.doubles([deviation.metres, deviation.radians]);
    for told in &found.reconfigurations {
        digest.word(told.index as u64);
        digest.doubles([told.distance]);
    }
    for missed in &found.missed {
        digest.word(missed.index as u64);
        digest.doubles([missed.position_error, missed.orientation_error]);
    }
    for blocked in &found.blocked {
        digest.word(blocked.index as u64);
        digest.bytes(&blocked.by.second);
    }
}

fn paths() -> Value {
    let mut digest = Digest::new();
    let file = "../models/paths/pipe_seam.csv";
    let (seam, _) = CartesianPath::read(file, QuaternionOrder::WFirst).unwrap();
    let robot = robot("franka_panda");
    let alone = Arm::new(&robot, "base", "tool").unwrap();
    add_path(&mut digest, &PathSolver::new(&alone).solve(&seam).unwrap());
    for file in ["table", "window"] {
        let arm = among(file);
        let middle = [0.0, -0.3, 0.0, -2.0, 0.0, 1.9, 0.8];
        let begin = arm.base_from_tool(&middle).unwrap();
        let point = |k: u32| {
            let along = Vector3::new(0.0, 0.01 * f64::from(k) - 0.2, 0.004 * f64::from(k));
            Placement::new(begin.rotation, begin.translation + along)
        };
        let path = CartesianPath::new((0..=40).map(point).collect::<Vec<_>>()).unwrap();
        add_path(&mut digest, &PathSolver::new(&arm).solve(&path).unwrap());
        let weighed =
            PathSolver::new(&arm).with_joint_weights(&[3.0, 2.0, 1.0, 1.0, 0.5, 0.5, 0.2]);
        add_path(&mut digest, &weighed.solve(&path).unwrap());
    }
    digest.value()
}

#[test]
fn of_distances() {
    check(&[("distances between shapes", distances())]);
}

#[test]
fn of_spheres_that_cover() {
    check(&[("spheres that cover an arm", spheres())]);
}

#[test]
fn of_arms_among_obstacles() {
    check(&[("arms among obstacles, counted", answers())]);
}

#[test]
fn of_paths() {
    check(&[("paths, alone and among obstacles", paths())]);
}
