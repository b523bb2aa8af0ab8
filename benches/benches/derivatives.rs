//! One Jacobian of 60 bones and five tips by each derivative mode, and the gradient in reverse mode.
#![allow(missing_docs, clippy::expect_used)]

use criterion::{Criterion, criterion_group, criterion_main};
use kinopt::Problem;
use kinopt::problem::{Derivatives, Evaluation};
use kinopt::solver::LeastSquares;
use kinopt::task::Point;
use kinopt_benches::{Sequence, every_angle_free, figure};

fn derivatives(criterion: &mut Criterion) {
    let (skeleton, tips) = figure(10, 10);
    let skeleton = every_angle_free(&skeleton);
    let mut builder = Problem::builder(skeleton.model());
    for tip in tips {
        builder.add(Point::new(skeleton.tip(tip), [0.1, 0.2, 0.3]));
    }
    let problem = builder.build().expect("a valid problem");
    let (n, m) = (problem.variables(), problem.rows());
    let mut random = Sequence::new(0.5);
    let x: Vec<f64> = (0..n).map(|_| random.unit() - 0.5).collect();
    // Alternates between two configurations, so that no forward pass is reused.
    let y: Vec<f64> = x.iter().map(|v| v + 1e-3).collect();

    let name = format!("{} bones, {n} angles, 5 tips", skeleton.bones().len());
    let mut group = criterion.benchmark_group(name);
    let mut jacobian = nalgebra::DMatrix::zeros(m, n);
    for route in Derivatives::ALL {
        let problem = problem.clone().with_derivatives(route);
        let mut scratch = problem.scratch();
        group.bench_function(format!("Jacobian, {route:?}"), |bencher| {
            let mut alternate = false;
            bencher.iter(|| {
                alternate = !alternate;
                let configuration = if alternate { &x } else { &y };
                Evaluation::new(&problem, &mut scratch).jacobian(configuration, &mut jacobian);
            });
        });
    }
    let mut scratch = problem.scratch();
    let (residual, mut gradient) = (vec![0.1; m], vec![0.0; n]);
    group.bench_function("gradient, reverse mode", |bencher| {
        let mut alternate = false;
        bencher.iter(|| {
            alternate = !alternate;
            let configuration = if alternate { &x } else { &y };
            let mut evaluation = Evaluation::new(&problem, &mut scratch);
            evaluation.gradient(configuration, &residual, &mut gradient, &mut jacobian);
        });
    });
    let mut residual = vec![0.0; m];
    group.bench_function("residual", |bencher| {
        let mut alternate = false;
        bencher.iter(|| {
            alternate = !alternate;
            let configuration = if alternate { &x } else { &y };
            Evaluation::new(&problem, &mut scratch).residual(configuration, &mut residual);
        });
    });
    group.finish();
}

criterion_group!(benches, derivatives);
criterion_main!(benches);
