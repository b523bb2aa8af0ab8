//! Whole solves of a figure of 22 bones with five tips: random targets from rest, and a drag whose
//! every frame starts from the last.
#![allow(missing_docs, clippy::expect_used)]

use criterion::{Criterion, criterion_group, criterion_main};
use kinopt::solver::{Damping, GaussNewton, LevenbergMarquardt};
use kinopt::spatial::Vector3;
use kinopt::task::{Point, Quantity};
use kinopt::{Problem, Solver, Workspace};
use kinopt_benches::{Sequence, figure, random_targets};

fn solves(criterion: &mut Criterion) {
    let (skeleton, tips) = figure(2, 4);
    let mut builder = Problem::builder(skeleton.model());
    let rest = skeleton.model().neutral();
    let at_rest = skeleton.pose(&rest);
    let tasks: Vec<_> = tips
        .iter()
        .map(|&tip| builder.add(Point::new(skeleton.tip(tip), at_rest.tip(&skeleton, tip))))
        .collect();
    builder.tolerance(Quantity::Metres, 1e-8 * skeleton.size());
    let mut problem = builder.build().expect("a valid problem");

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
                for (&task, &at) in tasks.iter().zip(&targets[next]) {
                    problem
                        .residual_mut(task)
                        .expect("it is there")
                        .set_target(at);
                }
                let solution = solver.solve(&problem, &rest, &mut workspace);
                solution.expect("a valid start").iterations
            });
        });
    }

    // A hand goes round a circle in 240 frames while the other tips hold.
    for (&task, &tip) in tasks.iter().zip(&tips) {
        let hold = at_rest.tip(&skeleton, tip);
        problem
            .residual_mut(task)
            .expect("it is there")
            .set_target(hold);
    }
    let hand = at_rest.tip(&skeleton, tips[1]);
    let solver = Solver::default();
    let mut workspace = Workspace::new();
    let mut q = rest.clone();
    let mut frame = 0;
    group.bench_function("drag frame from the last", |bencher| {
        bencher.iter(|| {
            frame += 1;
            let angle = f64::from(frame % 240) * std::f64::consts::TAU / 240.0;
            let at = Vector3::new(-0.25 + 0.1 * angle.cos(), 0.1 * angle.sin(), 0.15);
            problem
                .residual_mut(tasks[1])
                .expect("it is there")
                .set_target(hand + at);
            let solution = solver
                .solve(&problem, &q, &mut workspace)
                .expect("a valid start");
            q.copy_from_slice(&solution.q);
            solution.iterations
        });
    });
    group.finish();
}

criterion_group!(benches, solves);
criterion_main!(benches);
