//! Promise: targets hidden by a singular rest pose are reached from rest. Cases: coinciding twist axes of a bone, a
//! twist without effect, and a straight chain.
//!
//! With the default settings some random targets end in local minima of the limits. More agreeing attempts
//! (`with_agreeing`) reach all of them.

use kinopt::ik::Restarts;
use kinopt::model::Limits;
use kinopt::problem::Problem;
use kinopt::skeleton::Bone;
use kinopt::task::{Point, Quantity};
use kinopt::{Skeleton, Solver};
use nalgebra as na;
use support::methods::solvers;
use support::random::Random;
use support::trees::configuration_of;
use support::{placement, planar_arm, planar_tip, rigid};

/// Straight bones of length 1 along x, with the given limits.
fn straight(limits: &[[(f64, f64); 3]]) -> Skeleton {
    let mut bones: Vec<Bone> = Vec::new();
    for (k, limits) in limits.iter().enumerate() {
        let parent = (k > 0).then(|| {
            let so_far = Skeleton::new("so far", bones.clone()).unwrap();
            so_far.bone_at(k - 1).unwrap()
        });
        let tail = na::Vector3::new(k as f64, 0.0, 0.0);
        bones.push(Bone {
            name: format!("bone/{k}"),
            parent,
            length: 1.0,
            model_from_rest: placement(&rigid(na::Rotation3::identity(), tail)),
            limits: limits.map(|(lower, upper)| Limits::new(lower, upper)),
        });
    }
    Skeleton::new("straight", bones).unwrap()
}

/// Position of the last tip by the plain formula: each bone rotates its canonical frame, then steps along x.
fn last_tip(bones: usize, q: &[f64]) -> na::Vector3<f64> {
    let (x, z) = (na::Vector3::x_axis(), na::Vector3::z_axis());
    let mut turned = na::Rotation3::identity();
    let mut at = na::Vector3::zeros();
    for bone in 0..bones {
        let [a, b, c] = [q[3 * bone], q[3 * bone + 1], q[3 * bone + 2]];
        turned = turned
            * na::Rotation3::from_axis_angle(&x, c)
            * na::Rotation3::from_axis_angle(&z, b)
            * na::Rotation3::from_axis_angle(&x, a);
        at += turned * na::Vector3::x();
    }
    at
}

/// Methods with curvature, with enough agreeing attempts to pass a shared local minimum.
fn patient_solvers() -> impl Iterator<Item = Solver> {
    let patient = Restarts::default().with_agreeing(8);
    let some = solvers().into_iter().take(3);
    some.map(move |solver| solver.with_restarts(patient))
}

fn assert_reached(label: &str, solver: &Solver, skeleton: &Skeleton, target: na::Vector3<f64>) {
    let bones = skeleton.bones().len();
    let tip = skeleton.tip(skeleton.bone_at(bones - 1).unwrap());
    let mut builder = Problem::builder(skeleton.model());
    builder.add(Point::new(tip, target));
    builder.tolerance(Quantity::Metres, 1e-8);
    let problem = builder.build().unwrap();
    let solution = solver
        .solve_once(&problem, &skeleton.model().neutral())
        .unwrap();
    let missed = (last_tip(bones, &solution.q) - target).norm();
    assert!(
        missed <= 1.01e-8,
        "{label}: {missed:e}\n{}",
        solution.explain()
    );
    assert!(solution.reached, "{label}");
}

#[test]
fn bend_that_needs_a_twist_first_is_reached() {
    // The bend has one direction, in the xy plane at rest; all targets are off that plane.
    let free = [(-3.1, 3.1), (0.0, 2.5), (-3.1, 3.1)];
    let hinge = [(0.0, 0.0), (0.0, 2.5), (0.0, 0.0)];
    let skeletons = [
        straight(&[free]),
        straight(&[free, hinge]),
        straight(&[free, hinge, free]),
    ];
    for skeleton in &skeletons {
        let bones = skeleton.bones().len();
        for (twist, bend) in [(1.6, 0.9), (-1.5, 1.2), (3.0, 0.7), (-2.8, 0.4)] {
            let mut q = vec![0.0; 3 * bones];
            (q[1], q[2]) = (bend, twist);
            if bones > 1 {
                (q[0], q[4]) = (-0.8, 0.9);
            }
            let target = last_tip(bones, &q);
            for solver in patient_solvers() {
                let label = format!("{bones} bones, twist {twist}, {}", solver.method());
                assert_reached(&label, &solver, skeleton, target);
            }
        }
    }
}

#[test]
fn random_targets_are_reached_from_rest() {
    let free = [(-3.1, 3.1), (0.0, 2.5), (-3.1, 3.1)];
    let hinge = [(0.0, 0.0), (0.0, 2.5), (0.0, 0.0)];
    let skeleton = straight(&[free, hinge, free]);
    let mut random = Random::new(1);
    for _ in 0..100 {
        let q = configuration_of(skeleton.model(), &mut random);
        assert_reached("default", &Solver::default(), &skeleton, last_tip(3, &q));
    }
}

#[test]
fn target_straight_behind_is_reached() {
    // Every gradient is zero: the arm is stretched away from the target.
    let links = [1.0, 0.9, 0.8];
    let model = planar_arm(&links, Some((-3.0, 3.0)));
    let tip = model.frame("tip").unwrap();
    for distance in [0.3, 1.0, 2.2] {
        let target = na::Vector3::new(-distance, 0.0, 0.0);
        let mut builder = Problem::builder(&model);
        builder.add(Point::new(tip, target));
        let problem = builder.build().unwrap();
        for solver in patient_solvers() {
            let solution = solver.solve_once(&problem, &[0.0; 3]).unwrap();
            let missed = (planar_tip(&links, &solution.q) - target).norm();
            assert!(
                missed < 1e-6,
                "{distance} by {}: {missed:e}",
                solver.method()
            );
            assert!(solution.attempts > 1, "the first attempt has no way out");
        }
    }
}

#[test]
fn nearer_target_on_the_chains_line_is_reached() {
    let hinge = [(0.0, 0.0), (0.0, 2.8), (0.0, 0.0)];
    let skeleton = straight(&[hinge, hinge, hinge]);
    // Two bends of 1.2 and 0.9 rad fold the chain off its line; limits allow one side only.
    let target = last_tip(3, &[0.0, 0.3, 0.0, 0.0, 1.2, 0.0, 0.0, 0.9, 0.0]);
    for solver in patient_solvers() {
        assert_reached(solver.method(), &solver, &skeleton, target);
    }
}
