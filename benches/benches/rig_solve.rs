//! Solves of a skeleton of 22 bones with five tips: random targets from rest, and a drag whose frames start from the
//! last one.
#![allow(missing_docs, clippy::expect_used)]

use criterion::{Criterion, criterion_group, criterion_main};
use kinopt::solver::{Damping, GaussNewton, LevenbergMarquardt};
use kinopt::task::{Point, Quantity};
use kinopt::{Problem, Solver, Workspace};
use kinopt_benches::{Sequence, at_ease, drag_targets, figure, random_targets};

fn solves(criterion: &mut Criterion) {
    let (skeleton, tips) = figure(2, 4);
    let mut builder = Problem::builder(skeleton.model());
    let rest = skeleton.model().neutral();
    let rest_pose = skeleton.pose(&rest).expect("a pose of its own bones");
    let tasks: Vec<_> = tips
        .iter()
        .map(|&tip| {
            builder.add(Point::new(
                skeleton.tip(tip),
                rest_pose
                    .tip(&skeleton, tip)
                    .expect("a pose of its own bones"),
            ))
        })
        .collect();
    builder.tolerance(Quantity::Metres, 1e-8 * skeleton.size());
    let problem = builder.build().expect("a valid problem");
    let mut targets_of_frame = problem.targets();

    let mut group = criterion.benchmark_group("22 bones, 5 tips, 1e-8 of the size");
    let targets = random_targets(&skeleton, &tips, 256, &mut Sequence::new(0.5));
    let solvers = [
        ("Levenberg-Marquardt", Solver::default()),
        (
            "Levenberg-Marquardt, error-proportional",
            Solver::new(LevenbergMarquardt::new(Damping::ErrorProportional)),
        ),
        ("Gauss-Newton", Solver::new(GaussNewton::default())),
    ];
    for (name, solver) in &solvers {
        let mut workspace = Workspace::new();
        let mut next = 0;
        group.bench_function(format!("random targets from rest, {name}"), |bencher| {
            bencher.iter(|| {
                next = (next + 1) % targets.len();
                for (&task, &position) in tasks.iter().zip(&targets[next]) {
                    let point = targets_of_frame.get_mut(task).expect("it is there");
                    point.set_target(position);
                }
                let instance = problem.with_targets(&targets_of_frame).expect("its own");
                let solution = solver.solve(instance, &rest, &mut workspace);
                solution.expect("a valid start").iterations
            });
        });
    }

    let poses = [("at ease", at_ease(&skeleton)), ("stretched out", rest)];
    for (pose, start) in poses {
        let frames: Vec<_> = (0..240)
            .map(|frame| drag_targets(&skeleton, &tips, &start, frame))
            .collect();
        let solver = Solver::default();
        let mut workspace = Workspace::new();
        let (mut q, mut frame) = (start, 0);
        group.bench_function(format!("drag frame from the last, {pose}"), |bencher| {
            bencher.iter(|| {
                frame = (frame + 1) % frames.len();
                for (&task, &position) in tasks.iter().zip(&frames[frame]) {
                    let point = targets_of_frame.get_mut(task).expect("it is there");
                    point.set_target(position);
                }
                let instance = problem.with_targets(&targets_of_frame).expect("its own");
                let solution = solver.solve(instance, &q, &mut workspace);
                q.copy_from_slice(&solution.expect("a valid start").q);
            });
        });
    }
    group.finish();
}

criterion_group!(benches, solves);
criterion_main!(benches);
