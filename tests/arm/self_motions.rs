//! Promise: the self-motions of seven joints keep the tool at its target within the limits, in steps of at most
//! 0.05 rad, and pass every solution that attempts find.

use std::f64::consts::PI;

use kinopt::arm::{Arm, SelfMotion};
use kinopt::collision::{Checker, CollisionModel, World};
use kinopt::model::{Limits, Model};
use kinopt::spatial::{Matrix3, Placement, Vector3};
use support::arms::{robot, within_limits};
use support::checked_arms::add_boxes;
use support::random::{Random, cases};
use support::urdf_matrices::{apart, from_placement};

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    differences.fold(0.0, f64::max)
}

fn assert_motions(arm: &Arm, target: &Placement<f64>, motions: &[SelfMotion]) {
    for motion in motions {
        for q in motion.q.chunks_exact(7) {
            let found = arm.base_from_tool(q).unwrap();
            let (metres, radians) = apart(&from_placement(&found), &from_placement(target));
            assert!(metres < 1e-9 && radians < 1e-9, "{metres:e} {radians:e}");
            assert!(within_limits(arm, q), "{q:?}");
        }
        let pairs = motion
            .q
            .chunks_exact(7)
            .zip(motion.q.chunks_exact(7).skip(1));
        for (a, b) in pairs {
            assert!(largest_difference(a, b) <= 0.05);
        }
    }
}

/// Distance of a configuration from the nearest sample, in the largest joint.
fn distance(motions: &[SelfMotion], q: &[f64]) -> f64 {
    let samples = motions.iter().flat_map(|motion| motion.q.chunks_exact(7));
    let distances = samples.map(|sample| largest_difference(sample, q));
    distances.fold(f64::INFINITY, f64::min)
}

#[test]
fn self_motions_pass_all_found_solutions() {
    for name in ["franka_panda", "kuka_iiwa14"] {
        let robot = robot(name);
        let arm = Arm::builder(&robot, "base", "flange").with_atlas(false);
        let arm = arm
            .with_position_tolerance(1e-10)
            .with_orientation_tolerance(1e-10);
        let arm = arm.build().unwrap();
        let mut random = Random::split_mix(81);
        for _ in cases(20, 3) {
            let q = random.configuration(&arm);
            let target = arm.base_from_tool(&q).unwrap();
            let motions = arm.self_motions(target).unwrap().unwrap();
            assert_motions(&arm, &target, &motions);
            assert!(distance(&motions, &q) < 0.05, "{name} {q:?}");
            for solution in arm.solve_all(target).unwrap().solutions {
                assert!(
                    distance(&motions, &solution.q) < 0.05,
                    "{name} {:?}",
                    solution.q
                );
            }
        }
    }
}

/// An arm whose shoulder, elbow and wrist do not meet in points. Without limits its curves are closed.
#[test]
fn curves_of_an_unlimited_arm_are_closed() {
    let z = Vector3::new(0.0, 0.0, 1.0);
    let mut builder = Model::builder("arm");
    let (mut parent, mut parent_from_joint) = (None, Placement::identity());
    for i in 0..7 {
        let limits = Limits::new(f64::NEG_INFINITY, f64::INFINITY);
        parent = Some(builder.revolute(format!("joint{i}"), parent, parent_from_joint, z, limits));
        let angle = [1.3, -1.2, 1.4, -1.1, 1.2, -1.4, 0.3][i];
        let turn = Matrix3::rotation(
            Vector3::new(1.0, 0.0, 0.0),
            (f64::sin(angle), f64::cos(angle)),
        );
        let offset = Vector3::new(0.05, 0.02, [0.1, 0.3, 0.1, 0.3, 0.1, 0.1, 0.1][i]);
        parent_from_joint = Placement::new(turn, offset);
    }
    builder.frame("base", None, Placement::identity());
    builder.frame("tool", parent, parent_from_joint);
    let model = builder.build().unwrap();
    let arm = Arm::builder(&model, "base", "tool")
        .with_atlas(false)
        .build()
        .unwrap();
    let q = [0.3, 0.9, -0.4, 1.1, 0.2, 0.8, -0.5];
    let target = arm.base_from_tool(&q).unwrap();
    let motions = arm.self_motions(target).unwrap().unwrap();
    assert_motions(&arm, &target, &motions);
    assert!(!motions.is_empty() && motions.iter().all(|motion| motion.closed));
    let turned: Vec<SelfMotion> = motions
        .iter()
        .map(|motion| {
            let near =
                |(value, q): (&f64, &f64)| value - 2.0 * PI * ((value - q) / (2.0 * PI)).round();
            SelfMotion {
                q: motion.q.iter().zip(q.iter().cycle()).map(near).collect(),
                closed: true,
            }
        })
        .collect();
    assert!(distance(&turned, &q) < 0.05);
}

#[test]
fn self_motions_are_collision_free() {
    let robot = robot("franka_panda");
    let bodies = CollisionModel::of(&robot).unwrap();
    let bodies = bodies.with_pairs_sampled(200, 1).unwrap();
    let mut random = Random::new(9);
    let mut world = World::new();
    add_boxes(&mut world, &mut random);
    let checker = Checker::new(bodies).with_world(&world).unwrap();
    let rest = vec![0.0; robot.model().configuration_len()];
    let plain = Arm::builder(&robot, "base", "flange")
        .with_atlas(false)
        .build()
        .unwrap();
    let arm = plain.clone().with_checker(&checker, &rest).unwrap();
    let (mut free, mut all) = (0, 0);
    for _ in cases(10, 4) {
        let target = plain.base_from_tool(&random.configuration(&plain)).unwrap();
        for motion in arm.self_motions(target).unwrap().unwrap() {
            for q in motion.q.chunks_exact(7) {
                assert!(arm.collisions(q).unwrap().is_empty());
                free += 1;
            }
        }
        let motions = plain.self_motions(target).unwrap().unwrap();
        all += motions
            .iter()
            .map(|motion| motion.q.len() / 7)
            .sum::<usize>();
    }
    assert!(free < all, "{free} {all}");
}

#[test]
fn other_arms_have_no_self_motions() {
    let robot = robot("universal_ur5e");
    let arm = Arm::builder(&robot, "base", "flange")
        .with_atlas(false)
        .build()
        .unwrap();
    assert_eq!(arm.self_motions(Placement::identity()).unwrap(), None);
}
