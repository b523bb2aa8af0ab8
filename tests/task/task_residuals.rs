//! Promise: every task measures what it says, to 1e-12 of the numbers it is made of.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use kinopt::Problem;
use kinopt::problem::Evaluation;
use kinopt::solver::LeastSquares;
use kinopt::task::{LookAt, Quantity, Task};
use nalgebra as na;
use support::random::Random;
use support::tasks::{WEIGHT, tasks_of};
use support::trees::RandomTree;

#[test]
fn residuals_are_the_formulas() {
    for seed in 0..10 {
        let tree = RandomTree::new(seed, 12);
        let mut random = Random::new(seed);
        let q = tree.configuration(&mut random);
        for case in tasks_of(&tree, &q, &mut random) {
            let mut builder = Problem::builder(&tree.model);
            (case.add)(&mut builder);
            let problem = builder.build().unwrap();
            let mut scratch = problem.scratch();
            let mut evaluation = Evaluation::new(&problem, &mut scratch);
            let mut residual = vec![f64::NAN; problem.rows()];
            // Where the task was aimed, and elsewhere.
            for q in [q.clone(), tree.configuration(&mut random)] {
                evaluation.residual(&q, &mut residual);
                let expected = (case.expected)(&tree.frames_at(&q), &q);
                assert_eq!(residual.len(), expected.len(), "{}", case.name);
                let size = expected.iter().fold(1.0_f64, |m, v| m.max(v.abs()));
                for (ours, theirs) in residual.iter().zip(&expected) {
                    let error = (ours / WEIGHT - theirs).abs();
                    assert!(error <= 1e-12 * size, "{} {seed}: {error:e}", case.name);
                }
            }
        }
    }
}

#[test]
fn look_at_keeps_its_digits_when_looking_away() {
    // Half a turn less δ is missing: the answer must know δ. (Within 1.4e-6 of half a turn every
    // axis across is as good, and half a turn is what is reported.)
    let tree = RandomTree::new(5, 9);
    let q = tree.configuration(&mut Random::new(5));
    let here = tree.frames_at(&q)[7];
    let axis = na::Vector3::new(0.3, -0.5, 0.8).normalize();
    let across = axis.cross(&na::Vector3::x()).normalize();
    for delta in [0.1, 1e-3, 1e-5, 2e-6] {
        let away = -axis * f64::cos(delta) + across * f64::sin(delta);
        let watched = here.translation.vector + here.rotation * away * 2.0;
        let mut builder = Problem::builder(&tree.model);
        let look = LookAt::new(tree.frames[7], axis, watched);
        builder.add(Task::new(look).weight(Quantity::Radians, 1.0));
        let problem = builder.build().unwrap();
        let mut scratch = problem.scratch();
        let mut residual = [0.0; 3];
        Evaluation::new(&problem, &mut scratch).residual(&q, &mut residual);
        let missing = na::Vector3::from(residual).norm();
        let error = (missing - (std::f64::consts::PI - delta)).abs();
        assert!(error < 1e-12, "δ = {delta:e}: off by {error:e} rad");
    }
}
